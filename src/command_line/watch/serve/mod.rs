//! The run as a page in the browser: a small server of one page and the documents that it asks for.
//!
//! It reads only, and answers one request after another, so that the files are read by one thread; the answer itself is
//! sent by another, lest somebody who reads slowly keep the others waiting.

mod address;
mod answer;
mod documents;

pub(super) use self::address::{Address, DEFAULT};

use self::answer::{Answer, Site};
use super::run::WatchedRun;
use crate::command_line::signals::stop_flag;
use anyhow::{Context, anyhow};
use std::io::{ErrorKind, Write, stdout};
use std::net::{SocketAddr, TcpListener};
use std::sync::atomic::Ordering;
use std::time::Duration;
use tiny_http::{Header, Request, Response, Server};

/// Between looks at signals.
const PATIENCE: Duration = Duration::from_millis(200);
/// The page takes scripts and data from here alone, and belongs into nobody's frame.
const HEADERS: [(&str, &str); 5] = [
    (
        "Content-Security-Policy",
        "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; \
         connect-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'",
    ),
    ("Cross-Origin-Resource-Policy", "same-origin"),
    ("X-Content-Type-Options", "nosniff"),
    ("Referrer-Policy", "no-referrer"),
    ("Cache-Control", "no-store"),
];

/// Serves the page until Ctrl-C, or a signal to end.
pub(super) fn serve(run: WatchedRun, columns: Vec<String>, address: Address) -> anyhow::Result<()> {
    let stop = stop_flag()?;
    let (server, bound) = listen(address)?;
    announce(bound)?;
    let mut site = Site { run, columns };
    while !stop.load(Ordering::Relaxed) {
        if let Some(request) = server.recv_timeout(PATIENCE)? {
            let answer = site.answer(request.method().as_str(), request.url(), host_of(&request));
            std::thread::spawn(move || send(request, answer));
        }
    }
    Ok(())
}

fn listen(Address(address): Address) -> anyhow::Result<(Server, SocketAddr)> {
    let listener = TcpListener::bind(address).map_err(|error| match error.kind() {
        ErrorKind::AddrInUse => anyhow!(
            "--serve {address}: another program has this port; name another, or 0 for any that is free"
        ),
        _ => anyhow!("--serve {address}: {error}"),
    })?;
    let bound = listener.local_addr().context("--serve")?;
    let server = Server::from_listener(listener, None)
        .map_err(|error| anyhow!("--serve {address}: {error}"))?;
    Ok((server, bound))
}

/// Says where the page is, and who else can see it.
fn announce(bound: SocketAddr) -> anyhow::Result<()> {
    if !bound.ip().is_loopback() {
        log::warn!("anybody who can reach {bound} over the network can look at this run");
    }
    writeln!(stdout(), "http://{bound}/  (Ctrl-C ends it)")?;
    stdout().flush()?;
    Ok(())
}

fn host_of(request: &Request) -> Option<&str> {
    let mut headers = request.headers().iter();
    headers.find(|header| header.field.equiv("Host")).map(|header| header.value.as_str())
}

fn send(request: Request, answer: Answer) {
    let kind = ("Content-Type", answer.kind);
    let allow = (answer.status == 405).then_some(("Allow", "GET"));
    let mut response = Response::from_data(answer.body).with_status_code(answer.status);
    for (name, value) in HEADERS.into_iter().chain([kind]).chain(allow) {
        if let Ok(header) = Header::from_bytes(name, value) {
            response.add_header(header);
        }
    }
    // Who has gone misses nothing.
    let _ = request.respond(response);
}
