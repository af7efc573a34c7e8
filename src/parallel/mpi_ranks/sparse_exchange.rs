//! Letters between processes none of which knows who writes to it: nonblocking consensus (NBX; T. Hoefler, C. Siebert,
//! A. Lumsdaine, Scalable communication protocols for dynamic sparse data exchange, PPoPP 2010).
//!
//! A rank sends synchronously, and so learns when a message has been taken; meanwhile it takes those that come. Once its
//! own have been taken it enters a barrier, but does not stand still there; when all ranks are in it, no message is left.

use mpi::Tag;
use mpi::request::{WaitGuard, scope};
use mpi::traits::{Communicator as _, CommunicatorCollectives, Destination, Source};

use super::{COLLECTIVE, Message, MpiRanks};

/// Tags of exchanges, which take turns: a rank that has seen the end of the barrier may write again while another still
/// looks for messages, and would take this one for one of the exchange before. It cannot be two exchanges ahead.
const TURNS: [Tag; 2] = [4, 5];

impl MpiRanks {
    /// See [`Communicator::sparse_exchange`](super::Communicator::sparse_exchange).
    pub(super) fn exchange_by_consensus(&self, outgoing: &[Message]) -> Vec<Message> {
        let tag = TURNS[self.turn.replace(1 - self.turn.get())];
        let written = outgoing.iter().filter(|message| !message.bytes.is_empty());
        let (own, others): (Vec<_>, Vec<_>) =
            written.partition(|message| message.rank == self.rank);
        let mut incoming: Vec<Message> = own.into_iter().cloned().collect();
        scope(|scope| {
            let (mut on_their_way, mut later_pieces) = (Vec::new(), Vec::<WaitGuard<_, _>>::new());
            for message in others {
                let process = self.world.process_at_rank(message.rank as i32);
                let mut pieces = self.pieces(&message.bytes);
                let first = pieces.next();
                let send = |piece| process.immediate_synchronous_send_with_tag(scope, piece, tag);
                on_their_way.extend(first.map(send));
                // Who has taken the first piece waits for these.
                let send = |piece| process.immediate_send_with_tag(scope, piece, COLLECTIVE).into();
                later_pieces.extend(pieces.map(send));
            }
            while let Some(first) = on_their_way.pop() {
                on_their_way.extend(first.test().err());
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

    /// A message whose first piece is here.
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
