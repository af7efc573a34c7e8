//! Ranks as processes of MPI. The only place that names the `mpi` crate.

mod sparse_exchange;

use std::cell::{Cell, RefCell};
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};

use mpi::Tag;
use mpi::collective::SystemOperation;
use mpi::datatype::Equivalence;
use mpi::environment::{Threading, Universe};
use mpi::point_to_point::{Message as MatchedMessage, Status};
use mpi::request::{WaitGuard, scope};
use mpi::topology::SimpleCommunicator;
use mpi::traits::{AsRaw, Communicator as _, CommunicatorCollectives, Destination, Root, Source};

use super::{AxisNeighbours, Communicator, FileAccess, Message};

/// The communicator as the HDF5 library takes it.
pub type RawCommunicator = mpi::ffi::MPI_Comm;

/// Messages to the neighbour below.
const DOWNWARDS: Tag = 1;
/// Messages to the neighbour above. Another tag, because both neighbours may be one rank.
const UPWARDS: Tag = 2;
/// Messages of collective operations.
const COLLECTIVE: Tag = 3;

/// Exit code of all ranks after a panic on one, the one of an ordinary Rust program.
const PANIC_CODE: i32 = 101;

/// Bytes that are sent at once: MPI counts in 32-bit integers.
const LONGEST_MESSAGE: usize = 1 << 30;

/// What Open MPI is told in its own way: to reach files through ROMIO, its other implementation of MPI-IO. Its first
/// one, OMPIO, guards each opening by a semaphore named after the file alone, for all jobs on the machine; a run that
/// is killed in that moment leaves it closed, and every later run that opens a file of this name waits for ever (seen
/// with 4.1; the name is still the file's in 2026, <https://github.com/open-mpi/ompi/pull/14058>).
const FILES_THROUGH_ROMIO: (&str, &str) = ("OMPI_MCA_io", "^ompio");

/// Whether MPI may be called: from the start to the beginning of the end.
static RUNNING: AtomicBool = AtomicBool::new(false);

/// The processes that `mpirun` (or `srun`) started together; one if the program was started alone.
///
/// MPI ends when this is dropped, so it must outlive every file that the ranks write together. While it
/// lives, a panic on one rank ends all ranks.
pub struct MpiRanks {
    // The order of the fields is the order in which they are dropped: MPI ends last.
    world: SimpleCommunicator,
    rank: usize,
    size: usize,
    longest_message: usize,
    /// Which of the tags of messages is next.
    turn: Cell<usize>,
    scratch: RefCell<Vec<f64>>,
    integer_scratch: RefCell<Vec<u64>>,
    universe: Universe,
}

/// MPI can be started only once in the life of a process.
#[derive(Debug, thiserror::Error)]
#[error("MPI was already started in this process, or has ended; it starts only once")]
pub struct AlreadyStarted;

impl MpiRanks {
    /// Starts MPI. Only this thread may speak to other ranks.
    ///
    /// # Errors
    /// If MPI was started before.
    pub fn start() -> Result<Self, AlreadyStarted> {
        choose_file_access();
        let (universe, _) =
            mpi::initialize_with_threading(Threading::Funneled).ok_or(AlreadyStarted)?;
        let world = universe.world().duplicate();
        RUNNING.store(true, Ordering::SeqCst);
        end_all_ranks_on_panic();
        Ok(Self {
            rank: world.rank() as usize,
            size: world.size() as usize,
            longest_message: LONGEST_MESSAGE,
            world,
            turn: Cell::default(),
            scratch: RefCell::default(),
            integer_scratch: RefCell::default(),
            universe,
        })
    }

    /// The same ranks with another largest number of bytes in a message of MPI (1 GiB by default), at
    /// least 1 and the same on all ranks; longer messages are sent in pieces.
    pub fn with_longest_message(mut self, longest_message: usize) -> Self {
        self.longest_message = longest_message.max(1);
        self
    }

    /// Ends all ranks at once with an exit code: for errors that one rank cannot share with the others.
    pub fn abort(&self, code: i32) -> ! {
        flush_standard_streams();
        self.universe.world().abort(code)
    }

    /// The pieces of a message: all are of the greatest length but the last, which is shorter and may be
    /// empty. MPI does not let one message overtake another between two ranks.
    fn pieces<'m>(&self, message: &'m [u8]) -> impl Iterator<Item = &'m [u8]> {
        let whole = message.chunks_exact(self.longest_message);
        let rest = whole.remainder();
        whole.chain(std::iter::once(rest))
    }

    /// Receives a message of any length, in its pieces, into a buffer that is kept between calls.
    fn receive(&self, source: usize, tag: Tag, incoming: &mut Vec<u8>) {
        incoming.clear();
        self.append_pieces(source, tag, incoming);
    }

    /// Receives all pieces of a message that are still to come.
    fn append_pieces(&self, source: usize, tag: Tag, incoming: &mut Vec<u8>) {
        let process = self.world.process_at_rank(source as i32);
        while self.append_piece(process.matched_probe_with_tag(tag), incoming) {}
    }

    /// Receives a piece behind those that are there; whether another follows.
    fn append_piece(
        &self,
        (message, status): (MatchedMessage, Status),
        incoming: &mut Vec<u8>,
    ) -> bool {
        let length = status.count(u8::equivalent_datatype()) as usize;
        let before = incoming.len();
        incoming.resize(before + length, 0);
        message.matched_receive_into(&mut incoming[before..]);
        length == self.longest_message
    }
}

/// Tells Open MPI how to reach files, unless the user has chosen; other MPIs do not read it.
fn choose_file_access() {
    let (variable, value) = FILES_THROUGH_ROMIO;
    if !RUNNING.load(Ordering::SeqCst) && std::env::var_os(variable).is_none() {
        #[expect(unsafe_code, reason = "MPI is told its options by the environment")]
        // SAFETY: MPI starts at the begin of a program, before any thread reads the environment.
        unsafe {
            std::env::set_var(variable, value);
        }
    }
}

impl Drop for MpiRanks {
    fn drop(&mut self) {
        // Unwinding would end in MPI_Finalize, which waits for the other ranks; they may wait for this one.
        if std::thread::panicking() {
            self.abort(PANIC_CODE);
        }
        RUNNING.store(false, Ordering::SeqCst);
    }
}

impl Communicator for MpiRanks {
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
        scope(|scope| {
            let _sent: [Option<Sent<WaitGuard<_, _>>>; 2] = std::array::from_fn(|side: usize| {
                let process = self.world.process_at_rank(others[side]? as i32);
                let tag = [DOWNWARDS, UPWARDS][side];
                let send = |piece| process.immediate_send_with_tag(scope, piece, tag).into();
                Some(send_all(self.pieces(outgoing[side]), send))
            });
            for side in 0..2 {
                incoming[side].clear();
                if let Some(other) = others[side] {
                    self.receive(other, [UPWARDS, DOWNWARDS][side], &mut incoming[side]);
                } else if neighbours[side].is_some() {
                    incoming[side].extend_from_slice(outgoing[1 - side]);
                }
            }
        });
    }

    fn sparse_exchange(&self, outgoing: &[Message]) -> Vec<Message> {
        self.exchange_by_consensus(outgoing)
    }

    fn sum_exact(&self, values: &mut [f64]) {
        let mut summed = self.scratch.borrow_mut();
        summed.resize(values.len(), 0.0);
        self.world.all_reduce_into(&*values, &mut summed[..], SystemOperation::sum());
        // Whether a zero has a sign must not depend on the number of ranks.
        values.iter_mut().zip(&*summed).for_each(|(value, sum)| *value = sum + 0.0);
    }

    fn sum_integers(&self, values: &mut [i64]) {
        // As unsigned integers: their overflow is defined, and the same modulo 2^64.
        let mut summed = self.integer_scratch.borrow_mut();
        summed.resize(values.len(), 0);
        let unsigned: &[u64] = bytemuck::cast_slice(values);
        self.world.all_reduce_into(unsigned, &mut summed[..], SystemOperation::sum());
        values.iter_mut().zip(&*summed).for_each(|(value, sum)| *value = *sum as i64);
    }

    fn maximum(&self, values: &mut [f64]) {
        let mut largest = self.scratch.borrow_mut();
        largest.resize(values.len(), 0.0);
        values.iter_mut().for_each(|value| *value = super::comparable(*value));
        self.world.all_reduce_into(&*values, &mut largest[..], SystemOperation::max());
        values.copy_from_slice(&largest);
    }

    fn gather_to_root(&self, bytes: &[u8]) -> Option<Vec<Vec<u8>>> {
        if !self.is_root() {
            let root = self.world.process_at_rank(0);
            self.pieces(bytes).for_each(|piece| root.send_with_tag(piece, COLLECTIVE));
            return None;
        }
        let mut gathered = vec![Vec::new(); self.size];
        gathered[0].extend_from_slice(bytes);
        for (rank, incoming) in gathered.iter_mut().enumerate().skip(1) {
            self.receive(rank, COLLECTIVE, incoming);
        }
        Some(gathered)
    }

    fn broadcast_from_root(&self, bytes: &mut Vec<u8>) {
        let root = self.world.process_at_rank(0);
        let mut length = bytes.len() as u64;
        root.broadcast_into(&mut length);
        bytes.resize(length as usize, 0);
        bytes.chunks_mut(self.longest_message).for_each(|piece| root.broadcast_into(piece));
    }

    fn file_access(&self) -> FileAccess {
        FileAccess::Collective(self.world.as_raw())
    }
}

/// Sendings that end when they are dropped. Nearly every message is one piece, for which no memory is taken.
type Sent<G> = (Option<G>, Vec<G>);

/// Sends the pieces of a message.
fn send_all<'m, G>(
    mut pieces: impl Iterator<Item = &'m [u8]>,
    send: impl Fn(&'m [u8]) -> G,
) -> Sent<G> {
    let first = pieces.next().map(&send);
    (first, pieces.map(send).collect())
}

/// Adds to the panic hook that a panic on one rank, in any of its threads, ends all ranks.
fn end_all_ranks_on_panic() {
    let print = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |information| {
        print(information);
        if RUNNING.load(Ordering::SeqCst) {
            flush_standard_streams();
            SimpleCommunicator::world().abort(PANIC_CODE);
        }
    }));
}

/// What was printed must be seen before all ranks end. Failures are of no interest any more.
fn flush_standard_streams() {
    let _ = std::io::stdout().flush();
    let _ = std::io::stderr().flush();
}
