//! Ranks as threads of this process.
//!
//! Each pair of ranks has mailboxes, which lend the receiver the bytes without a copy; numbers to be reduced are
//! published by each rank, and read by all in the order of ranks.

mod mailbox;
mod waiting;

use std::any::Any;
use std::cell::Cell;
use std::io;
use std::panic::resume_unwind;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, PoisonError, RwLock};
use std::thread::{Builder, ScopedJoinHandle};

use self::mailbox::Mailbox;
use self::waiting::{RankLost, Waiters};
use super::{AxisNeighbours, Communicator, Exchange, FileAccess, Message, Pending};

/// Messages to the neighbour below.
const DOWNWARDS: usize = 0;
/// Messages to the neighbour above. They have another mailbox because both neighbours may be one rank.
const UPWARDS: usize = 1;
/// Messages of collective operations.
const COLLECTIVE: usize = 2;
/// Messages that travel while ranks compute.
const UNDER_WAY: usize = 3;
const MAILBOXES: usize = 4;

/// Bytes of a thread's stack; as large as that of a program's first thread.
const STACK: usize = 8 << 20;

thread_local! {
    static IS_ON_ROOT: Cell<bool> = const { Cell::new(true) };
}

/// Whether this thread may print messages that only one of the threads should print: any thread except those of ranks
/// other than 0.
pub fn is_on_root() -> bool {
    IS_ON_ROOT.get()
}

/// Data shared by all threads.
struct Shared {
    waiters: Waiters,
    /// Mailboxes from rank a to rank b, at place a * size + b.
    mail: Vec<[Mailbox; MAILBOXES]>,
    /// Numbers of each rank, for reductions that it waits for at once, and for reductions during which it computes.
    numbers: Vec<[Published; 2]>,
}

/// Reductions that a rank waits for at once.
const AT_ONCE: usize = 0;
/// Reductions during which it computes.
const MEANWHILE: usize = 1;

/// Numbers that a rank has published, for two reductions in turn: a rank that is in one reduction has finished the
/// previous one, but others may still read the numbers that it published there.
#[derive(Default)]
#[repr(align(128))]
struct Published {
    /// Number of reductions for which this rank has published its numbers.
    rounds: AtomicU64,
    bits: [RwLock<Vec<u64>>; 2],
}

/// One of several threads.
struct ThreadRank {
    rank: usize,
    size: usize,
    /// Reductions of both kinds so far.
    rounds: [Cell<u64>; 2],
    shared: Arc<Shared>,
}

/// Runs `work` on `n` ranks, each of which is a thread, and returns their results in the order of the ranks.
///
/// # Panics
/// If the threads cannot be started, and as [`start_on_threads`].
pub fn run_on_threads<T: Send>(n: usize, work: impl Fn(&dyn Communicator) -> T + Sync) -> Vec<T> {
    start_on_threads(n, work).unwrap_or_else(|error| panic!("{n} threads: {error}"))
}

/// Runs `work` on `n` ranks, each of which is a thread, and returns their results in the order of the ranks.
///
/// # Errors
/// If the system refuses a thread. No rank has then passed its first wait for the others.
///
/// # Panics
/// If `work` panics on one rank: all ranks end, and the panic continues in the caller. Also if one rank returns while
/// others wait for it.
pub fn start_on_threads<T: Send>(
    n: usize,
    work: impl Fn(&dyn Communicator) -> T + Sync,
) -> io::Result<Vec<T>> {
    let work = &work;
    let mut refused = None;
    let results: Vec<Result<T, Box<dyn Any + Send>>> = std::thread::scope(|threads| {
        let mut handles: Vec<ScopedJoinHandle<'_, T>> = Vec::with_capacity(n);
        // Ranks that are dropped before they start count as ended for those that have started.
        for rank in connected(n) {
            let thread = Builder::new().name(format!("rank {}", rank.rank)).stack_size(STACK);
            match thread.spawn_scoped(threads, move || work(rank.begin())) {
                Ok(handle) => handles.push(handle),
                Err(error) => {
                    refused = Some(error);
                    break;
                }
            }
        }
        handles.into_iter().map(ScopedJoinHandle::join).collect()
    });
    match refused {
        Some(error) => Err(error),
        None => Ok(values_of(results)),
    }
}

/// The values returned by the ranks, or the panic that ended them.
fn values_of<T>(results: Vec<Result<T, Box<dyn Any + Send>>>) -> Vec<T> {
    let mut returned = Vec::with_capacity(results.len());
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

/// `n` ranks that share their mailboxes.
fn connected(n: usize) -> Vec<ThreadRank> {
    let shared = Arc::new(Shared {
        waiters: Waiters::new(n),
        mail: (0..n * n).map(|_| Default::default()).collect(),
        numbers: (0..n).map(|_| Default::default()).collect(),
    });
    let rank = |rank| ThreadRank {
        rank,
        size: n,
        rounds: Default::default(),
        shared: Arc::clone(&shared),
    };
    (0..n).map(rank).collect()
}

/// Whatever ends this rank, a return or a panic, no other rank waits for it any longer.
impl Drop for ThreadRank {
    fn drop(&mut self) {
        self.shared.waiters.leave(self.rank);
    }
}

impl ThreadRank {
    /// Called by the rank's own thread, before anything else.
    fn begin(&self) -> &Self {
        IS_ON_ROOT.set(self.is_root());
        self.shared.waiters.enter(self.rank);
        self
    }

    fn mailbox(&self, from: usize, to: usize, purpose: usize) -> &Mailbox {
        &self.shared.mail[from * self.size + to][purpose]
    }

    fn send(&self, to: usize, purpose: usize, bytes: &[u8]) {
        let mailbox = self.mailbox(self.rank, to, purpose);
        self.wait_for(to, || mailbox.is_empty());
        mailbox.put(bytes);
        self.shared.waiters.wake(to);
    }

    /// Receives a message, which replaces the contents of the buffer.
    fn receive(&self, from: usize, purpose: usize, incoming: &mut Vec<u8>) {
        let mailbox = self.mailbox(from, self.rank, purpose);
        self.wait_for(from, || !mailbox.is_empty());
        mailbox.take(incoming);
        self.shared.waiters.wake(from);
    }

    fn received(&self, from: usize, purpose: usize) -> Vec<u8> {
        let mut incoming = Vec::new();
        self.receive(from, purpose, &mut incoming);
        incoming
    }

    /// Waits until another rank has made a condition true; ends this rank if that one has ended before.
    fn wait_for(&self, other: usize, is_so: impl Fn() -> bool) {
        self.shared.waiters.wait(self.rank, other, is_so);
    }

    fn others(&self) -> impl Iterator<Item = usize> {
        let me = self.rank;
        (0..self.size).filter(move |&rank| rank != me)
    }

    /// Combines the numbers of all ranks, in the order of the ranks.
    fn reduce<T: bytemuck::Pod>(&self, values: &mut [T], combine: impl Fn(T, T) -> T) {
        self.publish(AT_ONCE, values);
        self.combine(AT_ONCE, values, combine);
    }

    /// Lets the others read this rank's numbers in the next reduction of a kind.
    fn publish<T: bytemuck::Pod>(&self, kind: usize, values: &[T]) {
        let round = self.rounds[kind].get() + 1;
        self.rounds[kind].set(round);
        let mine = &self.shared.numbers[self.rank][kind];
        {
            let place = (round % 2) as usize;
            let mut bits = mine.bits[place].write().unwrap_or_else(PoisonError::into_inner);
            bits.clear();
            bits.extend_from_slice(bytemuck::cast_slice(values));
        }
        mine.rounds.store(round, Ordering::SeqCst);
        self.others().for_each(|other| self.shared.waiters.wake(other));
    }

    /// Combines the numbers that all ranks have published in the present reduction of a kind, in the order of the
    /// ranks.
    fn combine<T: bytemuck::Pod>(
        &self,
        kind: usize,
        values: &mut [T],
        combine: impl Fn(T, T) -> T,
    ) {
        let round = self.rounds[kind].get();
        let place = (round % 2) as usize;
        for (rank, numbers) in self.shared.numbers.iter().enumerate() {
            let published = &numbers[kind];
            if rank != self.rank {
                self.wait_for(rank, || published.rounds.load(Ordering::SeqCst) >= round);
            }
            let bits = published.bits[place].read().unwrap_or_else(PoisonError::into_inner);
            let theirs: &[T] = bytemuck::cast_slice(&bits);
            assert_eq!(theirs.len(), values.len(), "all ranks pass equally many numbers");
            for (value, &other) in values.iter_mut().zip(theirs) {
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
        self.size
    }

    fn exchange(
        &self,
        neighbours: AxisNeighbours,
        outgoing: [&[u8]; 2],
        incoming: &mut [Vec<u8>; 2],
    ) {
        let others = neighbours.map(|neighbour| neighbour.filter(|&rank| rank != self.rank));
        for (side, other) in others.iter().enumerate() {
            if let Some(other) = *other {
                self.send(other, [DOWNWARDS, UPWARDS][side], outgoing[side]);
            }
        }
        for side in 0..2 {
            if let Some(other) = others[side] {
                self.receive(other, [UPWARDS, DOWNWARDS][side], &mut incoming[side]);
                continue;
            }
            incoming[side].clear();
            if neighbours[side].is_some() {
                incoming[side].extend_from_slice(outgoing[1 - side]);
            }
        }
    }

    fn start_exchange(&self, mut exchange: Exchange) -> Pending<'_, Exchange> {
        let Exchange { outgoing, .. } = &exchange;
        outgoing.iter().for_each(|message| self.send(message.rank, UNDER_WAY, &message.bytes));
        Pending::new(move || {
            for message in &mut exchange.incoming {
                self.receive(message.rank, UNDER_WAY, &mut message.bytes);
            }
            exchange
        })
    }

    fn sparse_exchange(&self, outgoing: &[Message]) -> Vec<Message> {
        // There are few threads: each sends to each, and empty messages are dropped.
        let mut messages = vec![&[][..]; self.size];
        outgoing.iter().for_each(|message| messages[message.rank] = &message.bytes);
        self.others().for_each(|to| self.send(to, COLLECTIVE, messages[to]));
        let received = |rank: usize| {
            if rank == self.rank {
                messages[rank].to_vec()
            } else {
                self.received(rank, COLLECTIVE)
            }
        };
        let incoming = (0..self.size).map(|rank| Message { rank, bytes: received(rank) });
        incoming.filter(|message| !message.bytes.is_empty()).collect()
    }

    fn sum_exact(&self, values: &mut [f64]) {
        self.reduce(values, |a, b| a + b);
        // The sign of a zero must not depend on the number of ranks.
        values.iter_mut().for_each(|value| *value += 0.0);
    }

    fn start_sum_exact(&self, mut values: Vec<f64>) -> Pending<'_, Vec<f64>> {
        self.publish(MEANWHILE, &values);
        Pending::new(move || {
            self.combine(MEANWHILE, &mut values, |a, b| a + b);
            values.iter_mut().for_each(|value| *value += 0.0);
            values
        })
    }

    fn sum_integers(&self, values: &mut [i64]) {
        self.reduce(values, i64::wrapping_add);
    }

    fn maximum(&self, values: &mut [f64]) {
        values.iter_mut().for_each(|value| *value = super::comparable(*value));
        self.reduce(values, f64::max);
    }

    fn gather_to_root(&self, bytes: &[u8]) -> Option<Vec<Vec<u8>>> {
        if !self.is_root() {
            self.send(0, COLLECTIVE, bytes);
            return None;
        }
        let others = self.others().map(|from| self.received(from, COLLECTIVE));
        Some(std::iter::once(bytes.to_vec()).chain(others).collect())
    }

    fn broadcast_from_root(&self, bytes: &mut Vec<u8>) {
        if self.is_root() {
            self.others().for_each(|to| self.send(to, COLLECTIVE, bytes));
        } else {
            self.receive(0, COLLECTIVE, bytes);
        }
    }

    fn file_access(&self, _path: &Path) -> FileAccess {
        FileAccess::Root
    }

    fn kind(&self) -> &'static str {
        "threads"
    }

    fn processes(&self) -> usize {
        1
    }
}

#[cfg(test)]
mod tests;
