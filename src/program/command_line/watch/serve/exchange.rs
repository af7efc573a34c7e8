//! One request and its answer over a connection, within limits of time and size.

use super::answer::{Answer, Site};
use std::io::{self, ErrorKind, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Time limit for a request: browsers send it at once.
const TIME_TO_ASK: Duration = Duration::from_secs(2);
/// Time limit for sending an answer, some megabytes at most.
const TIME_TO_READ: Duration = Duration::from_secs(30);
/// Longest time for which the rest of a request, its body, is read and discarded.
const TIME_TO_LEAVE: Duration = Duration::from_secs(1);
/// Largest number of bytes of a request without its body, ten times what browsers send, and largest number of its
/// lines.
const MOST_BYTES: usize = 16 << 10;
const MOST_LINES: usize = 100;
/// Headers: the page takes scripts and data only from here, and must not be embedded in a frame.
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

/// Reads a request and answers it. Visitors who have gone are ignored.
pub(super) fn exchange(visitor: &TcpStream, site: &Mutex<Site>) {
    let answer = match read_head(visitor) {
        Ok(head) => answer_to(&head, site),
        Err(Refusal::Answer(status, reason)) => Answer::text(status, reason),
        Err(Refusal::Silence) => return,
    };
    if send(visitor, &answer).is_ok() {
        leave(visitor);
    }
}

/// Rejects a visitor immediately.
pub(super) fn busy(visitor: &TcpStream) {
    // Data that fit into the buffers of a new connection do not wait.
    let answer = Answer::text(503, "too many connections: try again");
    let _ = visitor.set_nonblocking(true).and_then(|()| send(visitor, &answer));
}

/// Reason why a request is not answered.
enum Refusal {
    /// An answer with this status and reason.
    Answer(u16, &'static str),
    /// The visitor has sent nothing, or has gone.
    Silence,
}

/// A request up to its body.
fn read_head(mut visitor: &TcpStream) -> Result<Vec<u8>, Refusal> {
    let end = Instant::now() + TIME_TO_ASK;
    let mut head = Vec::new();
    let mut piece = [0; 4096];
    while !is_whole(&head)? {
        if head.len() > MOST_BYTES {
            return Err(Refusal::Answer(431, "the request is too long"));
        }
        let left = time_left(end).map_err(|_| Refusal::Silence)?;
        let read = visitor.set_read_timeout(Some(left)).and_then(|()| visitor.read(&mut piece));
        match read {
            Ok(0) => return Err(Refusal::Silence),
            Ok(bytes) => head.extend_from_slice(&piece[..bytes]),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(_) => return Err(Refusal::Silence),
        }
    }
    Ok(head)
}

fn is_whole(head: &[u8]) -> Result<bool, Refusal> {
    let mut lines = [httparse::EMPTY_HEADER; MOST_LINES];
    match httparse::Request::new(&mut lines).parse(head) {
        Ok(status) => Ok(status.is_complete()),
        Err(httparse::Error::TooManyHeaders) => {
            Err(Refusal::Answer(431, "the request has too many lines"))
        }
        Err(_) => Err(Refusal::Answer(400, "this is no request of HTTP")),
    }
}

fn answer_to(head: &[u8], site: &Mutex<Site>) -> Answer {
    let mut lines = [httparse::EMPTY_HEADER; MOST_LINES];
    let mut request = httparse::Request::new(&mut lines);
    // It has already been parsed.
    let _ = request.parse(head);
    let host = request.headers.iter().find(|line| line.name.eq_ignore_ascii_case("Host"));
    let host = host.and_then(|line| std::str::from_utf8(line.value).ok());
    let (method, path) = (request.method.unwrap_or_default(), request.path.unwrap_or_default());
    // Data read by a thread that panicked are read again if the file has changed.
    site.lock().unwrap_or_else(PoisonError::into_inner).answer(method, path, host)
}

fn send(mut visitor: &TcpStream, answer: &Answer) -> io::Result<()> {
    let end = Instant::now() + TIME_TO_READ;
    let text = text_of(answer);
    let mut rest = text.as_bytes();
    while !rest.is_empty() {
        visitor.set_write_timeout(Some(time_left(end)?))?;
        match visitor.write(rest) {
            Ok(0) => return Err(ErrorKind::WriteZero.into()),
            Ok(written) => rest = &rest[written..],
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

/// An answer in the form of HTTP.
fn text_of(answer: &Answer) -> String {
    let Answer { status, kind, body } = answer;
    let mut text = format!("HTTP/1.1 {status} {}\r\n", reason_of(*status));
    let length = body.len().to_string();
    let own = [("Content-Type", *kind), ("Content-Length", &length), ("Connection", "close")];
    let allow = (*status == 405).then_some(("Allow", "GET"));
    for (name, value) in HEADERS.into_iter().chain(own).chain(allow) {
        text += &format!("{name}: {value}\r\n");
    }
    text + "\r\n" + body
}

fn reason_of(status: u16) -> &'static str {
    match status {
        200 => "OK",
        400 => "Bad Request",
        403 => "Forbidden",
        404 => "Not Found",
        405 => "Method Not Allowed",
        431 => "Request Header Fields Too Large",
        _ => "Service Unavailable",
    }
}

/// Ends a connection. If a request has not been read to its end when the connection is closed, the visitor loses the
/// answer, so the rest is read and discarded.
fn leave(mut visitor: &TcpStream) {
    let end = Instant::now() + TIME_TO_LEAVE;
    let mut piece = [0; 4096];
    let _ = visitor.shutdown(Shutdown::Write);
    while let Ok(left) = time_left(end) {
        let read = visitor.set_read_timeout(Some(left)).and_then(|()| visitor.read(&mut piece));
        if !read.is_ok_and(|bytes| bytes > 0) {
            return;
        }
    }
}

fn time_left(end: Instant) -> io::Result<Duration> {
    let left = end.saturating_duration_since(Instant::now());
    if left.is_zero() { Err(ErrorKind::TimedOut.into()) } else { Ok(left) }
}
