//! Messages between ranks that do not know from whom they will receive: nonblocking consensus (NBX; T. Hoefler,
//! C. Siebert, A. Lumsdaine, "Scalable communication protocols for dynamic sparse data exchange", PPoPP 2010).
//!
//! A rank sends synchronously, so that it learns when a message has been received; meanwhile it receives those that
//! arrive. Once its own messages have been received it enters a nonblocking barrier and continues to receive. When all
//! ranks have entered the barrier, no message is left.

use mpi::Tag;
use mpi::request::{WaitGuard, scope};
use mpi::traits::{Communicator as _, CommunicatorCollectives, Destination, Source};

use super::{COLLECTIVE, Message, MpiRanks};

/// Two tags, which exchanges use in turn. A rank that has left the barrier may send the messages of the next exchange
/// while another is still receiving those of the last one; it cannot be two exchanges ahead.
const TAGS: [Tag; 2] = [4, 5];

impl MpiRanks {
    /// See [`Communicator::sparse_exchange`](super::Communicator::sparse_exchange).
    pub(super) fn exchange_by_consensus(&self, outgoing: &[Message]) -> Vec<Message> {
        let tag = TAGS[self.next_tag.replace(1 - self.next_tag.get())];
        let to_send = outgoing.iter().filter(|message| !message.bytes.is_empty());
        let (own, others): (Vec<_>, Vec<_>) =
            to_send.partition(|message| message.rank == self.rank);
        let mut incoming: Vec<Message> = own.into_iter().cloned().collect();
        scope(|scope| {
            let (mut unconfirmed, mut later_pieces) = (Vec::new(), Vec::<WaitGuard<_, _>>::new());
            for message in others {
                let process = self.world.process_at_rank(message.rank as i32);
                let mut pieces = self.pieces(&message.bytes);
                let first = pieces.next();
                let send = |piece| process.immediate_synchronous_send_with_tag(scope, piece, tag);
                unconfirmed.extend(first.map(send));
                // The rank that has received the first piece waits for the others.
                let send = |piece| process.immediate_send_with_tag(scope, piece, COLLECTIVE).into();
                later_pieces.extend(pieces.map(send));
            }
            while let Some(first) = unconfirmed.pop() {
                unconfirmed.extend(first.test().err());
                incoming.extend(self.received_message(tag));
            }
            let mut barrier = self.world.immediate_barrier();
            while let Err(open) = barrier.test() {
                barrier = open;
                incoming.extend(self.received_message(tag));
            }
        });
        incoming.sort_unstable_by_key(|message| message.rank);
        incoming
    }

    /// Receives a message whose first piece has arrived.
    fn received_message(&self, tag: Tag) -> Option<Message> {
        let first = self.world.any_process().immediate_matched_probe_with_tag(tag)?;
        let rank = first.1.source_rank() as usize;
        let mut bytes = Vec::new();
        if self.append_piece(first, &mut bytes) {
            self.append_pieces(rank, COLLECTIVE, &mut bytes);
        }
        Some(Message { rank, bytes })
    }
}
