//! Room for one message from one thread to another.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// One message at most. Only the sender fills it, only the receiver empties it, each after it has seen that it may.
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

    /// Takes the message of a full mailbox; the buffer that is given for it serves the next one.
    pub(super) fn take(&self, incoming: &mut Vec<u8>) {
        std::mem::swap(&mut *self.bytes(), incoming);
        self.full.store(false, Ordering::SeqCst);
    }

    fn bytes(&self) -> MutexGuard<'_, Vec<u8>> {
        self.bytes.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
