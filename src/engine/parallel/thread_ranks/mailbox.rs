//! A buffer for one message from one thread to another.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A buffer for at most one message. Only the sender fills the mailbox and only the receiver empties it, each
/// after it has checked that it may.
#[derive(Default)]
#[repr(align(64))]
pub(super) struct Mailbox {
    full: AtomicBool,
    bytes: Mutex<Vec<u8>>,
}

impl Mailbox {
    pub(super) fn is_empty(&self) -> bool {
        !self.full.load(Ordering::SeqCst)
    }

    /// Puts a message into an empty mailbox.
    pub(super) fn put(&self, message: &[u8]) {
        {
            let mut bytes = self.bytes();
            bytes.clear();
            bytes.extend_from_slice(message);
        }
        self.full.store(true, Ordering::SeqCst);
    }

    /// Takes the message of a full mailbox; the given buffer serves the next message.
    pub(super) fn take(&self, incoming: &mut Vec<u8>) {
        std::mem::swap(&mut *self.bytes(), incoming);
        self.full.store(false, Ordering::SeqCst);
    }

    fn bytes(&self) -> MutexGuard<'_, Vec<u8>> {
        self.bytes.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
