//! Signals that request a run to stop with a checkpoint.

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1, SIGUSR2, SIGXCPU, SIGXFSZ};
use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// A flag that is set by every signal with which a system or a person requests a program to end: SIGTERM, SIGINT,
/// SIGUSR1 and SIGUSR2 (warnings of batch systems), SIGHUP (a lost terminal), SIGXCPU (the limit of processor time) and
/// SIGXFSZ (the limit of the size of a file; the write then fails with a message). A second SIGINT ends the program at
/// once.
pub(super) fn stop_flag() -> io::Result<Arc<AtomicBool>> {
    let flag = Arc::new(AtomicBool::new(false));
    signal_hook::flag::register_conditional_shutdown(SIGINT, 130, Arc::clone(&flag))?;
    for signal in [SIGTERM, SIGINT, SIGUSR1, SIGUSR2, SIGHUP, SIGXCPU, SIGXFSZ] {
        signal_hook::flag::register(signal, Arc::clone(&flag))?;
    }
    Ok(flag)
}
