//! Ranks as threads of one process, so that ordinary tests run on several ranks.

use std::any::Any;
use std::panic::resume_unwind;
use std::path::Path;
use std::sync::mpsc::{Receiver, Sender, channel};

use super::{AxisNeighbours, Communicator, FileAccess, Message, records_of_bytes};

/// Messages to the neighbour below.
const DOWNWARDS: usize = 0;
/// Messages to the neighbour above. Another channel, because both neighbours may be one rank.
const UPWARDS: usize = 1;
/// Messages of collective operations.
const COLLECTIVE: usize = 2;
const CHANNELS: usize = 3;

/// One of several threads that communicate through channels, one for each pair of ranks and each purpose.
struct ThreadRank {
    rank: usize,
    /// Channels to rank r, by r.
    senders: Vec<[Sender<Vec<u8>>; CHANNELS]>,
    /// Channels from rank r, by r.
    receivers: Vec<[Receiver<Vec<u8>>; CHANNELS]>,
}

/// The panic payload of a thread that waited for another rank when that ended.
struct RankLost;

/// Runs `work` on `n` ranks, each of which is a thread, and returns their results in the order of the ranks.
///
/// # Panics
/// If `work` panics on one rank: all ranks end, and the panic continues in the caller. Also if one rank returns while
/// others wait for it.
pub fn run_on_threads<T: Send>(n: usize, work: impl Fn(&dyn Communicator) -> T + Sync) -> Vec<T> {
    let work = &work;
    let results: Vec<Result<T, Box<dyn Any + Send>>> = std::thread::scope(|threads| {
        let ranks = connected(n);
        // The rank moves into its thread. When that ends, its channels close, and no other rank waits for it.
        let spawn = |rank: ThreadRank| threads.spawn(move || work(&rank));
        let handles: Vec<_> = ranks.into_iter().map(spawn).collect();
        handles.into_iter().map(|handle| handle.join()).collect()
    });
    let mut returned = Vec::with_capacity(n);
    let mut lost = false;
    for result in results {
        match result {
            Ok(value) => returned.push(value),
            Err(payload) if payload.is::<RankLost>() => lost = true,
            Err(payload) => resume_unwind(payload),
        }
    }
    assert!(!lost, "a rank returned while others waited for it");
    returned
}

/// `n` ranks with a channel of each kind from each rank to each.
fn connected(n: usize) -> Vec<ThreadRank> {
    let new = |rank| ThreadRank { rank, senders: Vec::new(), receivers: Vec::new() };
    let mut ranks: Vec<ThreadRank> = (0..n).map(new).collect();
    for from in 0..n {
        for to in 0..n {
            let pairs: [_; CHANNELS] = std::array::from_fn(|_| channel());
            let (senders, receivers): (Vec<_>, Vec<_>) = pairs.into_iter().unzip();
            ranks[from].senders.push(array_of(senders));
            ranks[to].receivers.push(array_of(receivers));
        }
    }
    ranks
}

fn array_of<T>(items: Vec<T>) -> [T; CHANNELS] {
    items.try_into().unwrap_or_else(|_| unreachable!("one item for each channel"))
}

impl ThreadRank {
    fn send(&self, to: usize, channel: usize, bytes: &[u8]) {
        if self.senders[to][channel].send(bytes.to_vec()).is_err() {
            resume_unwind(Box::new(RankLost));
        }
    }

    fn receive(&self, from: usize, channel: usize) -> Vec<u8> {
        self.receivers[from][channel].recv().unwrap_or_else(|_| resume_unwind(Box::new(RankLost)))
    }

    /// Sends `outgoing[r]` to rank r; returns what each rank sent to this one, by rank.
    fn all_to_all(&self, outgoing: &[Vec<u8>]) -> Vec<Vec<u8>> {
        outgoing.iter().enumerate().for_each(|(to, bytes)| self.send(to, COLLECTIVE, bytes));
        (0..self.size()).map(|from| self.receive(from, COLLECTIVE)).collect()
    }

    /// Combines the numbers of all ranks, in the order of the ranks.
    fn reduce<T: bytemuck::Pod>(&self, values: &mut [T], combine: impl Fn(T, T) -> T) {
        let outgoing = vec![bytemuck::cast_slice(values).to_vec(); self.size()];
        let incoming = self.all_to_all(&outgoing);
        for (rank, bytes) in incoming.iter().enumerate() {
            let theirs: Vec<T> = records_of_bytes(bytes).collect();
            assert_eq!(theirs.len(), values.len(), "all ranks pass equally many numbers");
            for (value, other) in values.iter_mut().zip(theirs) {
                *value = if rank == 0 { other } else { combine(*value, other) };
            }
        }
    }
}

impl Communicator for ThreadRank {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.senders.len()
    }

    fn exchange(
        &self,
        neighbours: AxisNeighbours,
        outgoing: [&[u8]; 2],
        incoming: &mut [Vec<u8>; 2],
    ) {
        for (side, neighbour) in neighbours.iter().enumerate() {
            if let Some(neighbour) = *neighbour {
                self.send(neighbour, [DOWNWARDS, UPWARDS][side], outgoing[side]);
            }
        }
        for (side, neighbour) in neighbours.iter().enumerate() {
            incoming[side].clear();
            if let Some(neighbour) = *neighbour {
                incoming[side] = self.receive(neighbour, [UPWARDS, DOWNWARDS][side]);
            }
        }
    }

    fn sparse_exchange(&self, outgoing: &[Message]) -> Vec<Message> {
        // There are few threads: each sends to each, and empty messages are dropped.
        let mut messages = vec![Vec::new(); self.size()];
        outgoing.iter().for_each(|message| messages[message.rank].clone_from(&message.bytes));
        let incoming = self.all_to_all(&messages).into_iter().enumerate();
        let messages = incoming.map(|(rank, bytes)| Message { rank, bytes });
        messages.filter(|message| !message.bytes.is_empty()).collect()
    }

    fn sum_exact(&self, values: &mut [f64]) {
        self.reduce(values, |a, b| a + b);
        // Whether a zero has a sign must not depend on the number of ranks.
        values.iter_mut().for_each(|value| *value += 0.0);
    }

    fn sum_integers(&self, values: &mut [i64]) {
        self.reduce(values, i64::wrapping_add);
    }

    fn maximum(&self, values: &mut [f64]) {
        values.iter_mut().for_each(|value| *value = super::comparable(*value));
        self.reduce(values, f64::max);
    }

    fn gather_to_root(&self, bytes: &[u8]) -> Option<Vec<Vec<u8>>> {
        self.send(0, COLLECTIVE, bytes);
        self.is_root()
            .then(|| (0..self.size()).map(|from| self.receive(from, COLLECTIVE)).collect())
    }

    fn broadcast_from_root(&self, bytes: &mut Vec<u8>) {
        if self.is_root() {
            (1..self.size()).for_each(|to| self.send(to, COLLECTIVE, bytes));
        } else {
            *bytes = self.receive(0, COLLECTIVE);
        }
    }

    fn file_access(&self, _path: &Path) -> FileAccess {
        FileAccess::Root
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::agree;

    fn message(from: usize, direction: &str) -> Vec<u8> {
        format!("{from} {direction}").into_bytes()
    }

    #[test]
    fn neighbours_exchange_messages_along_a_periodic_axis() {
        // With one rank both neighbours are the rank itself, with two both are the other.
        for n in 1..=4 {
            run_on_threads(n, |ranks| {
                let me = ranks.rank();
                let [below, above] = [(me + n - 1) % n, (me + 1) % n];
                let mut incoming = [b"old".to_vec(), b"old".to_vec()];
                let (down, up) = (message(me, "down"), message(me, "up"));
                ranks.exchange([Some(below), Some(above)], [&down, &up], &mut incoming);
                assert_eq!(incoming, [message(below, "up"), message(above, "down")]);
            });
        }
    }

    #[test]
    fn nothing_is_received_where_there_is_no_neighbour() {
        for n in 1..=3 {
            run_on_threads(n, |ranks| {
                let me = ranks.rank();
                let neighbours = [me.checked_sub(1), Some(me + 1).filter(|&above| above < n)];
                let mut incoming = [b"old".to_vec(), b"old".to_vec()];
                ranks.exchange(neighbours, [b"", &message(me, "up")], &mut incoming);
                assert_eq!(incoming[0], neighbours[0].map_or(vec![], |below| message(below, "up")));
                assert_eq!(incoming[1], b"");
            });
        }
    }

    #[test]
    fn sums_and_maxima_are_taken_over_all_ranks() {
        for n in 1..=4 {
            run_on_threads(n, |ranks| {
                let me = ranks.rank();
                let mut exact = [0.25 * (me + 1) as f64, -0.0];
                ranks.sum_exact(&mut exact);
                assert_eq!(exact[0], 0.125 * (n * (n + 1)) as f64);
                assert!(exact[1].is_sign_positive());
                let mut integers = [me as i64, i64::MAX, 1];
                ranks.sum_integers(&mut integers);
                let largest_times_n = i64::MAX.wrapping_mul(n as i64);
                assert_eq!(integers, [(n * (n - 1) / 2) as i64, largest_times_n, n as i64]);
                let mut values = [me as f64, -(me as f64)];
                ranks.maximum(&mut values);
                assert_eq!(values, [(n - 1) as f64, 0.0]);
                let mut undefined = [if me == 0 { f64::NAN } else { 1.0 }];
                ranks.maximum(&mut undefined);
                assert_eq!(undefined, [f64::INFINITY]);
            });
        }
    }

    #[test]
    fn rank_0_gathers_and_broadcasts() {
        for n in 1..=4 {
            run_on_threads(n, |ranks| {
                let gathered = ranks.gather_to_root(&vec![7; ranks.rank()]);
                let expected: Vec<Vec<u8>> = (0..n).map(|from| vec![7; from]).collect();
                assert_eq!(gathered, ranks.is_root().then_some(expected));
                let mut bytes = if ranks.is_root() { b"message".to_vec() } else { vec![] };
                ranks.broadcast_from_root(&mut bytes);
                assert_eq!(bytes, b"message");
            });
        }
    }

    #[test]
    fn an_error_on_one_rank_is_an_error_on_all() {
        for n in 1..=4 {
            run_on_threads(n, |ranks| {
                let fine: Result<usize, String> = Ok(ranks.rank());
                assert_eq!(agree(fine, ranks), Ok(ranks.rank()));
                let last = ranks.rank() == n - 1;
                let result = if last { Err(format!("rank {} failed", n - 1)) } else { Ok(()) };
                assert_eq!(agree(result, ranks).unwrap_err().0, format!("rank {} failed", n - 1));
            });
        }
    }

    #[test]
    #[should_panic(expected = "only here")]
    fn a_panic_on_one_rank_ends_all() {
        run_on_threads(3, |ranks| {
            assert!(ranks.rank() != 1, "only here");
            ranks.any(false)
        });
    }
}
