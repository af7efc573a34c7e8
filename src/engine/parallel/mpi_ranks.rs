//! Ranks as MPI processes. Only this module uses the `mpi` crate.

mod file_errors;
mod sparse_exchange;
mod travelling;

use std::cell::{Cell, RefCell};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use mpi::Tag;
use mpi::collective::SystemOperation;
use mpi::datatype::Equivalence;
use mpi::environment::{Threading, Universe};
use mpi::point_to_point::{Message as MatchedMessage, Status};
use mpi::request::{StaticScope, WaitGuard, scope};
use mpi::topology::SimpleCommunicator;
use mpi::traits::{AsRaw, Communicator as _, CommunicatorCollectives, Destination, Root, Source};

use self::travelling::Travelling;
use super::{
    AxisNeighbours, Communicator, Exchange, FileAccess, Message, Pending, allocator,
    flush_standard_streams,
};

/// The communicator in the form required by the HDF5 library.
pub type RawCommunicator = mpi::ffi::MPI_Comm;

/// Messages to the neighbour below.
const DOWNWARDS: Tag = 1;
/// Messages to the neighbour above. They have another tag because both neighbours may be one rank.
const UPWARDS: Tag = 2;
/// Messages of collective operations.
const COLLECTIVE: Tag = 3;
/// Messages that travel while ranks compute.
const UNDER_WAY: Tag = 6;

/// Exit code of all ranks after a panic on one; the same as for an ordinary Rust program.
const PANIC_CODE: i32 = 101;

/// Largest number of bytes in one message of MPI, which counts with 32-bit integers.
const LONGEST_MESSAGE: usize = 1 << 30;

/// Settings of Open MPI for writing files, used unless the user has set them; other implementations of MPI ignore these
/// variables.
///
/// Open MPI's own MPI-IO, OMPIO, keeps a position in the file that all ranks share, although Talcum does not use it. By
/// default OMPIO guards this position by a semaphore that is named after the file alone and shared by all jobs on the
/// machine. A run that is killed while it opens a file leaves the semaphore locked, and every later run that opens a
/// file of this name hangs (seen with 4.1.4, 5.0.7 and 6.0.0rc2; <https://github.com/open-mpi/ompi/pull/14058>). OMPIO
/// may therefore keep that position only in other ways, and ROMIO is preferred where it exists: up to version 5, since
/// 6.0 has only OMPIO.
const FILE_ACCESS: [(&str, &str); 2] =
    [("OMPI_MCA_io_ompio_priority", "1"), ("OMPI_MCA_sharedfp", "^sm,lockedfile")];

/// Settings for messages to another process of the same node, used unless the user has set them: Open MPI sends
/// messages of up to this many bytes at once, 32 KiB, the most that it takes into one piece, instead of 4. Longer
/// messages are announced first and wait for the answer: 3.5 us for 6 kB instead of 1 us, 4.7 us for 12 kB instead of
/// 2.3 (4.1.4 on an AMD EPYC). A rank with a thousand particles or a hundred cells along an edge has halos of such
/// lengths. Shared memory is called "vader" in version 4 and "sm" in 5.
const SENT_AT_ONCE: [(&str, &str); 2] =
    [("OMPI_MCA_btl_vader_eager_limit", "32768"), ("OMPI_MCA_btl_sm_eager_limit", "32768")];

/// Largest number of bytes, header included, in one message that travels while ranks compute, so that Open MPI sends it
/// at once. An announced message would wait until the other rank calls MPI again, after its computation.
const LONGEST_UNDER_WAY: usize = 32_000;

/// Whether MPI may be called: it was initialised and is not being finalised.
static RUNNING: AtomicBool = AtomicBool::new(false);

/// The processes that `mpirun` (or `srun`) started together; one if the program was started alone.
///
/// MPI is finalised when this is dropped, so it must outlive every file that the ranks write together. Until then a
/// panic on one rank ends all ranks.
pub struct MpiRanks {
    // Fields are dropped in this order: MPI is finalised last.
    world: SimpleCommunicator,
    rank: usize,
    size: usize,
    longest_message: usize,
    /// Index of the tag for the next sparse exchange, one of two.
    next_tag: Cell<usize>,
    scratch: RefCell<Vec<f64>>,
    integer_scratch: RefCell<Vec<u64>>,
    universe: Universe,
}

/// The error that MPI was initialised before; a process can do so only once.
#[derive(Debug, thiserror::Error)]
#[error("MPI was already started in this process; it can be started only once")]
pub struct AlreadyStarted;

impl MpiRanks {
    /// Initialises MPI. Only this thread may communicate with other ranks.
    ///
    /// # Errors
    /// If MPI was initialised before.
    pub fn start() -> Result<Self, AlreadyStarted> {
        choose_options();
        let (universe, _) =
            mpi::initialize_with_threading(Threading::Funneled).ok_or(AlreadyStarted)?;
        let world = universe.world().duplicate();
        allocator::set_process(world.rank() as usize, end_all_ranks);
        RUNNING.store(true, Ordering::SeqCst);
        end_all_ranks_on_panic();
        file_errors::end_all_ranks_on_file_errors();
        Ok(Self {
            rank: world.rank() as usize,
            size: world.size() as usize,
            longest_message: LONGEST_MESSAGE,
            world,
            next_tag: Cell::default(),
            scratch: RefCell::default(),
            integer_scratch: RefCell::default(),
            universe,
        })
    }

    /// Sets the largest number of bytes in one message of MPI (1 GiB by default). It must be at least 1 and the same on
    /// all ranks. Longer messages are sent in pieces.
    pub fn with_longest_message(mut self, longest_message: usize) -> Self {
        self.longest_message = longest_message.max(1);
        self
    }

    /// Ends all ranks immediately with an exit code, after an error that one rank cannot communicate to the others.
    pub fn abort(&self, code: i32) -> ! {
        flush_standard_streams();
        self.universe.world().abort(code)
    }

    /// The pieces of a message. All have the largest length, except for the last, which is shorter and may be empty.
    /// MPI guarantees that one message does not overtake another between two ranks.
    fn pieces<'m>(&self, message: &'m [u8]) -> impl Iterator<Item = &'m [u8]> {
        let whole = message.chunks_exact(self.longest_message);
        let rest = whole.remainder();
        whole.chain(std::iter::once(rest))
    }

    /// Begins to receive and to send the messages of an exchange.
    fn requests_of(&self, exchange: &'static mut Exchange) -> Vec<WaitGuard<'static, [u8]>> {
        let Exchange { outgoing, incoming } = exchange;
        let longest = self.longest_message.min(LONGEST_UNDER_WAY);
        let mut requests = Vec::with_capacity(incoming.len() + outgoing.len());
        for Message { rank, bytes } in incoming {
            let process = self.world.process_at_rank(*rank as i32);
            let receive =
                |piece| process.immediate_receive_into_with_tag(StaticScope, piece, UNDER_WAY);
            requests.extend(bytes.chunks_mut(longest).map(receive).map(WaitGuard::from));
        }
        for Message { rank, bytes } in outgoing {
            let process = self.world.process_at_rank(*rank as i32);
            let send = |piece| process.immediate_send_with_tag(StaticScope, piece, UNDER_WAY);
            requests.extend(bytes.chunks(longest).map(send).map(WaitGuard::from));
        }
        requests
    }

    /// Receives all pieces of a message into a buffer.
    fn receive(&self, source: usize, tag: Tag, incoming: &mut Vec<u8>) {
        incoming.clear();
        self.append_pieces(source, tag, incoming);
    }

    /// Receives the remaining pieces of a message.
    fn append_pieces(&self, source: usize, tag: Tag, incoming: &mut Vec<u8>) {
        let process = self.world.process_at_rank(source as i32);
        while self.append_piece(process.matched_probe_with_tag(tag), incoming) {}
    }

    /// Appends a piece of a message; returns whether another follows.
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

/// Name and version of the MPI library with which the program was built.
pub fn mpi_library() -> Option<String> {
    let text = mpi::environment::library_version().unwrap_or_default();
    // Implementations end the text with a zero, continue with their build options, or have several lines.
    let whole = |sign: char| sign == '\0' || sign == '\n' || sign == ',';
    Some(text.split(whole).next().unwrap_or_default().trim().to_owned())
}

/// Sets the options of Open MPI for files and messages, unless the user has set them.
fn choose_options() {
    if RUNNING.load(Ordering::SeqCst) {
        return;
    }
    for (variable, value) in FILE_ACCESS.into_iter().chain(SENT_AT_ONCE) {
        if std::env::var_os(variable).is_none() {
            #[expect(unsafe_code, reason = "Open MPI reads its options from the environment")]
            // SAFETY: MPI is initialised at the start of the program, before there are other threads, which could read
            // the environment at the same time.
            unsafe {
                std::env::set_var(variable, value);
            }
        }
    }
}

impl Drop for MpiRanks {
    fn drop(&mut self) {
        // Unwinding would lead to MPI_Finalize, which waits for the other ranks, while they may wait for this one.
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

    fn start_exchange(&self, exchange: Exchange) -> Pending<'_, Exchange> {
        let travelling = Travelling::begin(exchange, |exchange| self.requests_of(exchange));
        Pending::new(move || travelling.finish())
    }

    fn sparse_exchange(&self, outgoing: &[Message]) -> Vec<Message> {
        self.exchange_by_consensus(outgoing)
    }

    fn sum_exact(&self, values: &mut [f64]) {
        let mut summed = self.scratch.borrow_mut();
        summed.resize(values.len(), 0.0);
        self.world.all_reduce_into(&*values, &mut summed[..], SystemOperation::sum());
        // The sign of a zero must not depend on the number of ranks.
        values.iter_mut().zip(&*summed).for_each(|(value, sum)| *value = sum + 0.0);
    }

    fn start_sum_exact(&self, values: Vec<f64>) -> Pending<'_, Vec<f64>> {
        let summed = vec![0.0; values.len()];
        let travelling = Travelling::begin([values, summed], |[values, summed]| {
            let sum = SystemOperation::sum();
            let request = self.world.immediate_all_reduce_into(
                StaticScope,
                &values[..],
                &mut summed[..],
                sum,
            );
            vec![WaitGuard::from(request)]
        });
        Pending::new(move || {
            let [_, mut summed] = travelling.finish();
            summed.iter_mut().for_each(|sum| *sum += 0.0);
            summed
        })
    }

    fn sum_integers(&self, values: &mut [i64]) {
        // The sum of unsigned integers is defined modulo 2^64, even if it overflows.
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

    fn file_access(&self, path: &Path) -> FileAccess {
        file_errors::set_file(path);
        FileAccess::Collective(self.world.as_raw())
    }

    fn kind(&self) -> &'static str {
        "MPI processes"
    }
}

/// Sends in progress, which are waited for when they are dropped. Nearly every message is a single piece, for which no
/// memory is allocated.
type Sent<G> = (Option<G>, Vec<G>);

/// Sends the pieces of a message.
fn send_all<'m, G>(
    mut pieces: impl Iterator<Item = &'m [u8]>,
    send: impl Fn(&'m [u8]) -> G,
) -> Sent<G> {
    let first = pieces.next().map(&send);
    (first, pieces.map(send).collect())
}

/// Extends the panic hook so that a panic in any thread of one rank ends all ranks.
fn end_all_ranks_on_panic() {
    let print = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |information| {
        print(information);
        end_all_ranks(PANIC_CODE);
    }));
}

/// Ends all ranks, if there are others.
fn end_all_ranks(code: i32) {
    if RUNNING.load(Ordering::SeqCst) {
        flush_standard_streams();
        SimpleCommunicator::world().abort(code);
    }
}
