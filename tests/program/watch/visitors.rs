//! The server of the page tolerates visitors who are silent, many, or send without end. Loopback only.

use super::made;
use super::page::{Served, served_by};
use crate::launch::start_program;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::time::{Duration, Instant};

/// The least number of file descriptors that systems allow a program.
const DESCRIPTORS: usize = 64;
/// Five times what a silent visitor is waited for.
const PATIENCE: Duration = Duration::from_secs(10);

/// A server of a folder that may open few files.
fn serve(folder: &Path) -> Served {
    let (program, folder) = (env!("CARGO_BIN_EXE_talcum"), folder.display());
    let script = format!("ulimit -n {DESCRIPTORS}; exec {program} watch {folder} --serve 0");
    served_by(start_program(Path::new("/bin/sh"), 0, &["-c", &script]))
}

/// Waits until the state is served as to a visitor who is alone.
fn wait_for_state(served: &Served) {
    let begin = Instant::now();
    while status_after(served, "GET /state.json HTTP/1.1\r\nHost: localhost\r\n\r\n") != Some(200) {
        assert!(begin.elapsed() < PATIENCE, "nobody is served");
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// The status of the answer to what is sent, if there is one.
fn status_after(served: &Served, request: &str) -> Option<u16> {
    let mut stream = TcpStream::connect(&served.address).ok()?;
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    stream.write_all(request.as_bytes()).ok()?;
    let mut answer = String::new();
    // The end of the connection may come as an error behind the answer.
    let _ = stream.read_to_string(&mut answer);
    answer.split(' ').nth(1)?.parse().ok()
}

/// The most memory that the server has had, in MB.
fn most_memory(served: &Served) -> u64 {
    let status = format!("/proc/{}/status", served.program.process());
    let status = std::fs::read_to_string(status).unwrap();
    let line = status.lines().find(|line| line.starts_with("VmHWM:")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse::<u64>().unwrap() / 1024
}

#[test]
fn more_silent_visitors_than_descriptors_keep_nobody_away_for_long() {
    let made = made(3);
    let served = serve(made.path());
    let silent: Vec<_> =
        (0..200).filter_map(|_| TcpStream::connect(&served.address).ok()).collect();
    // The control: they are more than the server can have open.
    assert!(silent.len() > 2 * DESCRIPTORS, "{}", silent.len());
    wait_for_state(&served);
    drop(silent);
    wait_for_state(&served);
}

#[test]
fn a_body_of_any_announced_length_is_answered_without_room_for_it() {
    let made = made(3);
    let served = serve(made.path());
    let length = "Content-Length: 99999999999999";
    for (method, host, status) in
        [("GET", "localhost", 200), ("POST", "localhost", 405), ("GET", "page.example.org", 403)]
    {
        let request = format!("{method} /state.json HTTP/1.1\r\nHost: {host}\r\n{length}\r\n\r\nx");
        assert_eq!(status_after(&served, &request), Some(status), "{method} {host}");
    }
    wait_for_state(&served);
    assert!(most_memory(&served) < 100);
}

#[test]
fn a_head_without_end_is_refused_and_not_kept() {
    let made = made(3);
    let served = serve(made.path());
    let line = "x".repeat(1 << 20);
    let long = format!("GET / HTTP/1.1\r\nHost: localhost\r\nLong: {line}\r\n\r\n");
    assert_eq!(status_after(&served, &long), Some(431));
    let many = "a: b\r\n".repeat(1000);
    let many = format!("GET / HTTP/1.1\r\nHost: localhost\r\n{many}\r\n");
    assert_eq!(status_after(&served, &many), Some(431));
    assert_eq!(status_after(&served, "HELO localhost\r\n\r\n"), Some(400));
    let mut stream = TcpStream::connect(&served.address).unwrap();
    stream.set_write_timeout(Some(PATIENCE)).unwrap();
    stream.write_all(b"GET / HTTP/1.1\r\nLong: ").unwrap();
    // 400 MB, unless the server has closed the connection before.
    let _ = (0..400).try_for_each(|_| stream.write_all(line.as_bytes()));
    wait_for_state(&served);
    assert!(most_memory(&served) < 100, "{} MB", most_memory(&served));
}
