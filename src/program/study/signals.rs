//! Signals that request a study to stop.

use crate::study::scheduler::StopRequest;
use signal_hook::consts::{SIGINT, SIGTERM, SIGUSR1};
use signal_hook::iterator::Signals;
use std::cell::{Cell, RefCell};

/// SIGINT, SIGTERM and SIGUSR1 stop gently; a second SIGINT or SIGTERM stops at once.
pub(crate) struct StopSignals {
    signals: RefCell<Signals>,
    gentle: Cell<bool>,
    interrupts: Cell<usize>,
}

impl StopSignals {
    /// Catches the signals from now on.
    pub(crate) fn catch() -> std::io::Result<Self> {
        let signals = RefCell::new(Signals::new([SIGINT, SIGTERM, SIGUSR1])?);
        Ok(Self { signals, gentle: Cell::new(false), interrupts: Cell::new(0) })
    }

    /// Urgency of the stop requested by the signals so far.
    pub(crate) fn request(&self) -> StopRequest {
        for signal in self.signals.borrow_mut().pending() {
            self.gentle.set(true);
            if signal != SIGUSR1 {
                self.interrupts.set(self.interrupts.get() + 1);
            }
        }
        match (self.gentle.get(), self.interrupts.get()) {
            (false, _) => StopRequest::None,
            (true, 0 | 1) => StopRequest::Gentle,
            (true, _) => StopRequest::AtOnce,
        }
    }
}
