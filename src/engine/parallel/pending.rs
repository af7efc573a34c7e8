//! Communication that has begun and not ended: ranks compute while it travels.

use super::{Communicator, Message};

/// Communication that is under way. It owns the travelling buffers until [`Pending::finish`] has waited for the other
/// ranks and returns the received data. A value that is dropped also waits, so that an error between begin and end
/// leaves no message behind.
#[must_use = "what is not finished is waited for at once"]
pub struct Pending<'a, T>(Option<Box<dyn FnOnce() -> T + 'a>>);

/// The messages of one exchange: at most one to each rank and one from each. Sender and length of incoming messages are
/// known in advance: the bytes of `incoming` have that length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Exchange {
    /// Messages to other ranks.
    pub outgoing: Vec<Message>,
    /// Messages from other ranks.
    pub incoming: Vec<Message>,
}

impl Exchange {
    /// Buffers for messages to and from these ranks, of these lengths in bytes.
    pub(super) fn with_lengths(
        outgoing: impl IntoIterator<Item = (usize, usize)>,
        incoming: impl IntoIterator<Item = (usize, usize)>,
    ) -> Self {
        let buffer = |(rank, length)| Message { rank, bytes: vec![0; length] };
        Self {
            outgoing: outgoing.into_iter().map(buffer).collect(),
            incoming: incoming.into_iter().map(buffer).collect(),
        }
    }

    /// Begins the exchange; the buffers are returned with the messages.
    pub(super) fn start<'r>(&mut self, ranks: &'r dyn Communicator) -> Pending<'r, Self> {
        ranks.start_exchange(std::mem::take(self))
    }

    /// Exchanges the messages at once. Collective.
    pub(super) fn complete(&mut self, ranks: &dyn Communicator) {
        *self = self.start(ranks).finish();
    }
}

impl<'a, T> Pending<'a, T> {
    /// Communication that ends when `wait` returns; `wait` is called once.
    pub fn new(wait: impl FnOnce() -> T + 'a) -> Self {
        Self(Some(Box::new(wait)))
    }

    /// Waits for the other ranks.
    pub fn finish(mut self) -> T {
        let wait =
            self.0.take().expect("only this method and drop take it, and both end the value");
        wait()
    }
}

impl<T> Drop for Pending<'_, T> {
    fn drop(&mut self) {
        // After a panic the others might never answer.
        if let Some(wait) = self.0.take()
            && !std::thread::panicking()
        {
            wait();
        }
    }
}
