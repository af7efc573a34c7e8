//! Address at which the page is served, and the permitted hosts.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::str::FromStr;
use talcum_results::output::lock::host_name;

/// The default address of the page.
pub(in super::super) const DEFAULT: &str = "127.0.0.1:8017";

/// An address with a port, by default on this machine only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) struct Address(pub(super) SocketAddr);

impl FromStr for Address {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let here = |port: &str| Some(SocketAddr::from((Ipv4Addr::LOCALHOST, port.parse().ok()?)));
        let named = text.strip_prefix("localhost:").and_then(here);
        let address = text.parse().ok().or(named).or_else(|| here(text));
        address.map(Self).ok_or_else(|| {
            format!("must be a port (8017), or an address with a port ({DEFAULT}); the folder stands before --serve")
        })
    }
}

/// Whether a request was made to this server under one of its own names. A foreign page may make its own name resolve
/// to this machine and so read data that only this machine may read; but its requests then carry that name.
pub(super) fn is_own_host(host: &str) -> bool {
    let name = match host.rsplit_once(':') {
        Some((name, port)) if port.bytes().all(|digit| digit.is_ascii_digit()) => name,
        _ => host,
    };
    let address: Result<IpAddr, _> = name.trim_matches(['[', ']']).parse();
    let is_ours = |own: &str| !own.is_empty() && name.eq_ignore_ascii_case(own);
    address.is_ok() || is_ours("localhost") || is_ours(&host_name())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn address(text: &str) -> Result<String, String> {
        text.parse().map(|Address(address)| address.to_string())
    }

    #[test]
    fn a_port_means_this_machine_and_an_address_is_taken_as_it_is() {
        assert_eq!(address(DEFAULT).unwrap(), "127.0.0.1:8017");
        assert_eq!(address("9000").unwrap(), "127.0.0.1:9000");
        assert_eq!(address("localhost:9000").unwrap(), "127.0.0.1:9000");
        assert_eq!(address("0.0.0.0:80").unwrap(), "0.0.0.0:80");
        assert_eq!(address("[::1]:80").unwrap(), "[::1]:80");
        for wrong in ["results/bed", "127.0.0.1", "70000", "", "localhost:"] {
            assert!(address(wrong).unwrap_err().contains("must be a port"), "{wrong}");
        }
    }

    #[test]
    fn names_of_others_are_not_ours() {
        let own = format!("{}:8017", host_name());
        for host in [
            "127.0.0.1:8017",
            "localhost:8017",
            "LocalHost",
            "[::1]:8017",
            "[::1]",
            "10.0.0.7:80",
            &own,
        ] {
            assert!(is_own_host(host), "{host}");
        }
        for host in
            ["example.org:8017", "localhost.example.org:8017", "127.0.0.1.example.org", "", ":8017"]
        {
            assert!(!is_own_host(host), "{host}");
        }
    }
}
