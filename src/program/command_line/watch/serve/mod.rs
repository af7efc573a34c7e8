//! The run as a page in the browser: a small server for one page and the documents that it requests.
//!
//! It only reads. Each connection has its own thread and carries one request, so that a slow visitor does not make the
//! others wait; the files are read for one request after another. The number of connections, their duration and the
//! size of requests are limited, so that the server outlives its visitors.

mod address;
mod answer;
mod documents;
mod exchange;

pub(super) use self::address::{Address, DEFAULT};

use self::answer::Site;
use self::exchange::{busy, exchange};
use super::run::WatchedRun;
use crate::command_line::signals::stop_flag;
use anyhow::{Context, anyhow};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use std::io::ErrorKind;
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;
use talcum_results::output::print;

/// Time between checks for signals.
const PATIENCE: Timespec = Timespec { tv_sec: 0, tv_nsec: 200_000_000 };
/// Pause before the next attempt if the system gives no connection, for example because there are no file descriptors
/// left.
const PAUSE: Duration = Duration::from_millis(200);
/// Largest number of simultaneous connections. A browser opens six; of 64 file descriptors, the smallest limit of any
/// system, half are left for files.
const MOST_CONNECTIONS: usize = 32;

/// Serves the page until Ctrl-C, or a signal to end.
pub(super) fn serve(run: WatchedRun, columns: Vec<String>, address: Address) -> anyhow::Result<()> {
    let stop = stop_flag()?;
    let listener = listen(address)?;
    announce(listener.local_addr().context("--serve")?)?;
    let site = Arc::new(Mutex::new(Site { run, columns }));
    while !stop.load(Ordering::Relaxed) {
        if let Some(visitor) = next_visitor(&listener) {
            welcome(visitor, &site);
        }
    }
    Ok(())
}

/// A listener whose connections are accepted without blocking.
fn listen(Address(address): Address) -> anyhow::Result<TcpListener> {
    let listener = TcpListener::bind(address).map_err(|error| match error.kind() {
        ErrorKind::AddrInUse => anyhow!(
            "--serve {address}: another program has this port; name another, or 0 for any that is free"
        ),
        _ => anyhow!("--serve {address}: {error}"),
    })?;
    listener.set_nonblocking(true).with_context(|| format!("--serve {address}"))?;
    Ok(listener)
}

/// Prints the address of the page, and who else can see it.
fn announce(bound: SocketAddr) -> anyhow::Result<()> {
    if !bound.ip().is_loopback() {
        log::warn!("anybody who can reach {bound} over the network can look at this run");
    }
    Ok(print(&format!("http://{bound}/  (Ctrl-C ends it)"))?)
}

/// The next connection, if one arrives soon.
fn next_visitor(listener: &TcpListener) -> Option<TcpStream> {
    let mut waited_for = [PollFd::new(listener, PollFlags::IN)];
    // A call interrupted by a signal has found nobody.
    if poll(&mut waited_for, Some(&PATIENCE)).unwrap_or(0) == 0 {
        return None;
    }
    match listener.accept() {
        Ok((stream, _)) => Some(stream),
        Err(error) => {
            // A visitor who has already gone is no reason to wait.
            if !matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::ConnectionAborted) {
                thread::sleep(PAUSE);
            }
            None
        }
    }
}

/// Has a visitor answered by a thread, or rejects the visitor if there are too many. The site is shared by all visitors
/// and the server.
fn welcome(visitor: TcpStream, site: &Arc<Mutex<Site>>) {
    if Arc::strong_count(site) > MOST_CONNECTIONS {
        return busy(&visitor);
    }
    let site = Arc::clone(site);
    // If the system refuses a thread, the connection is closed.
    let _ = thread::Builder::new().spawn(move || exchange(&visitor, &site));
}
