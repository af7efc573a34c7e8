//! `talcum watch` in a terminal ends when the terminal goes away, and at every signal that requests it.

use super::made;
use crate::analyse::made::Made;
use crate::launch::signal;
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use std::fs::File;
use std::io::{Read, Write};
use std::process::{Child, Command, ExitStatus};
use std::time::{Duration, Instant};

/// Ten times what the program leaves itself.
const PATIENCE: Duration = Duration::from_secs(10);

/// The program in a terminal of its own.
struct Shown {
    program: Child,
    /// The other side of the terminal: what is written here is typed.
    keyboard: File,
    _results: Made,
}

impl Drop for Shown {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

impl Shown {
    /// Starts it, and waits until it draws.
    fn start() -> Self {
        let results = made(3);
        let keyboard = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC);
        let keyboard = keyboard.unwrap();
        grantpt(&keyboard).unwrap();
        unlockpt(&keyboard).unwrap();
        let name = ptsname(&keyboard, Vec::new()).unwrap().into_string().unwrap();
        let side = || File::options().read(true).write(true).open(&name).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_talcum"));
        command.arg("watch").arg(results.path());
        let program = command.stdin(side()).stdout(side()).stderr(side()).spawn().unwrap();
        let mut shown = Self { program, keyboard: File::from(keyboard), _results: results };
        let mut first = [0];
        shown.keyboard.read_exact(&mut first).unwrap();
        shown
    }

    /// How it ends; fails if it does not.
    fn end(mut self) -> ExitStatus {
        wait_for_end(&mut self.program)
    }
}

fn wait_for_end(program: &mut Child) -> ExitStatus {
    let begin = Instant::now();
    loop {
        if let Some(status) = program.try_wait().unwrap() {
            return status;
        }
        assert!(begin.elapsed() < PATIENCE, "it stays");
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_terminal_that_goes_away_ends_it() {
    let mut shown = Shown::start();
    let nowhere = File::open("/dev/null").unwrap();
    drop(std::mem::replace(&mut shown.keyboard, nowhere));
    assert_eq!(shown.end().code(), Some(0));
}

#[test]
fn a_terminal_that_goes_away_while_it_is_drawn_on_ends_it_too() {
    for milliseconds in 0..20 {
        let mut shown = Shown::start();
        // Each of these keys draws the curves anew.
        shown.keyboard.write_all(&[b'l'; 200]).unwrap();
        std::thread::sleep(Duration::from_millis(milliseconds));
        drop(std::mem::replace(&mut shown.keyboard, File::open("/dev/null").unwrap()));
        assert_eq!(shown.end().code(), Some(0), "{milliseconds}");
    }
}

#[test]
fn a_signal_ends_it_also_in_a_terminal_that_takes_no_more() {
    let mut shown = Shown::start();
    // What is drawn for each of these keys is not read: the terminal's buffer fills up.
    shown.keyboard.write_all(&[b'l'; 3000]).unwrap();
    std::thread::sleep(Duration::from_secs(1));
    signal("TERM", shown.program.id());
    assert_eq!(shown.end().code(), Some(0));
}

#[test]
fn a_signal_ends_it_also_behind_half_of_an_escape_sequence() {
    for name in ["TERM", "HUP", "INT"] {
        for typed in ["", "\x1b["] {
            let mut shown = Shown::start();
            shown.keyboard.write_all(typed.as_bytes()).unwrap();
            std::thread::sleep(Duration::from_millis(300));
            signal(name, shown.program.id());
            assert_eq!(shown.end().code(), Some(0), "{name}, {typed:?}");
        }
    }
}

#[test]
fn a_key_ends_it() {
    let mut shown = Shown::start();
    shown.keyboard.write_all(b"q").unwrap();
    assert_eq!(shown.end().code(), Some(0));
}
