//! Ends the program if its terminal has gone or a signal requests it, whatever the drawing thread does.
//!
//! The library that reads keys may never return: from a terminal that has gone it reads nothing without end, and after
//! half of an escape sequence it waits for the rest.

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use std::io::{self, stdout};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// Time between checks of the flag of signals.
const PATIENCE: Timespec = Timespec { tv_sec: 0, tv_nsec: 100_000_000 };
/// Time for the drawing thread to leave by itself, which takes a tenth of a second if it can.
const GRACE: Duration = Duration::from_secs(1);

/// Watches the terminal and the flag in a thread of its own. When the terminal goes, the thread sets the flag. Once the
/// flag is set, the thread ends the program soon after if it is still running.
pub(super) fn guard(stop: Arc<AtomicBool>) -> io::Result<()> {
    thread::Builder::new().spawn(move || {
        while !stop.load(Ordering::Relaxed) && !has_gone() {}
        stop.store(true, Ordering::Relaxed);
        thread::sleep(GRACE);
        restore_within(GRACE);
        // Without the clean-up of a program's end, which would wait for that writer too.
        signal_hook::low_level::exit(0);
    })?;
    Ok(())
}

/// Restores the terminal, unless that takes too long: a terminal that takes no more, over a connection that hangs, blocks
/// whoever writes to it. Nothing is left to restore if the terminal has gone.
fn restore_within(time: Duration) {
    let begin = Instant::now();
    let restoring = thread::Builder::new().spawn(ratatui::try_restore);
    while restoring.as_ref().is_ok_and(|thread| !thread.is_finished()) && begin.elapsed() < time {
        thread::sleep(Duration::from_millis(10));
    }
}

/// Waits briefly, and returns whether the terminal has hung up.
pub(super) fn has_gone() -> bool {
    let output = stdout();
    let mut terminal = [PollFd::new(&output, PollFlags::empty())];
    // An interrupted call has found nothing; the flag is checked again.
    let found = poll(&mut terminal, Some(&PATIENCE)).unwrap_or(0);
    found > 0
}
