//! Signals: those that request a run to stop with a checkpoint, and that of the limit of the size of a file.

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1, SIGUSR2, SIGXCPU, SIGXFSZ};
use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// A flag that is set by every signal with which a system or a person requests a program to end: SIGTERM, SIGINT,
/// SIGUSR1 and SIGUSR2 (warnings of batch systems), SIGHUP (a lost terminal) and SIGXCPU (the limit of processor time).
/// A second SIGINT ends the program at once.
pub(super) fn stop_flag() -> io::Result<Arc<AtomicBool>> {
    let flag = Arc::new(AtomicBool::new(false));
    signal_hook::flag::register_conditional_shutdown(SIGINT, 130, Arc::clone(&flag))?;
    for signal in [SIGTERM, SIGINT, SIGUSR1, SIGUSR2, SIGHUP, SIGXCPU] {
        signal_hook::flag::register(signal, Arc::clone(&flag))?;
    }
    Ok(flag)
}

/// Catches SIGXFSZ, with which the system otherwise ends a program without a message: a write beyond the limit of the
/// size of a file then fails with an error. Ranks of MPI call it once MPI has started, which would wait without end for
/// a helper process that was ended by this signal.
pub(super) fn catch_limit_of_files() {
    if let Err(error) = signal_hook::flag::register(SIGXFSZ, Arc::default()) {
        log::warn!("SIGXFSZ cannot be caught: {error}");
    }
}
