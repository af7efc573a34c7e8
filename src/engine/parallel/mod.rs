//! Communication between ranks; it contains no physics.
//!
//! One rank is not a special case: periodic images are ghosts that a rank sends to itself. A call is *collective* if
//! all ranks must make it, in the same order.
//!
//! # Messages between ranks
//!
//! At every step:
//!
//! | what | record | bytes | to whom | how |
//! | --- | --- | --- | --- | --- |
//! | velocities of ghosts ([`ParticleHalo::send_velocities`]) | `GhostVelocities` | 48 per particle | ranks with copies of it in a pair | [`start_exchange`] |
//! | forces on ghosts ([`ParticleHalo::return_forces`]) | `GhostForces` | 48 per particle | owners of the originals | [`start_exchange`] |
//! | what is done next (`time_step::decide`) | 8 numbers | 64 | all | [`maximum`] |
//! | column gas: volume, velocity and drag of the solids on the grid | numbers | 8 each | all | [`start_sum_exact`] |
//! | volume-averaged gas: halos of fields (`FieldHalo`) | numbers | 8 per cell | neighbours, axis by axis | [`start_exchange`] |
//! | volume-averaged gas: largest Courant and viscous numbers, voidage that is not valid | 3 numbers | 24 | all | [`maximum`] |
//! | volume-averaged gas: largest addends, flow through the bed, momentum lost and gained | numbers, integers of exact sums | some 100 | all | [`maximum`], [`sum_integers`] |
//! | pressure equation: each dot product | 5 integers | 40 | all | [`sum_integers`] |
//! | pressure equation: small levels | numbers | 8 per cell | all | [`sum_exact`] |
//!
//! Columns of particles that travel ([`Travel`](crate::fields::Travel)) follow the records of velocities, of forces and
//! of new ghosts in the same messages, 8 bytes for each number; custom fields follow the records of particles.
//!
//! When the neighbour list is rebuilt:
//!
//! | what | record | bytes | to whom | how |
//! | --- | --- | --- | --- | --- |
//! | load of each rank, costs along each divided axis ([`RankLoad`](crate::balance::RankLoad)) | integers | 8192 per axis | all | [`sum_integers`] |
//! | particles that change owner ([`migrate`]) | [`ParticleRecord`] | 200 per particle | new owner | [`sparse_exchange`] |
//! | their contact histories, and those of two ranks' particles, in the same message | [`ContactRecord`], [`WallContactRecord`] | 80 per contact, 88 at a wall | new owners of both particles | [`sparse_exchange`] |
//! | new ghosts ([`ParticleHalo::make_ghosts`]) | `NewGhost` | 112 per ghost | neighbours, axis by axis | [`exchange`] |
//! | which particles ghosts are copies of ([`ParticleHalo::follow`]) | indices | 4 per particle | their owner | [`sparse_exchange`] |
//! | ids of particles that have left the box, if any has, and their volume | ids, 5 integers | 8 per particle | all | [`share_with_all`], [`sum_integers`] |
//! | cells that change owner (`send_cells_to_owners`) | [`CellRecord`] | 72 per cell | new owner | [`sparse_exchange`] |
//!
//! When agglomerates are found (at steps of the gas whose drag depends on them, and for instruments), pairs and labels of connected
//! sets go to the owners of their particles and to the ranks that answer for an id, and back ([`sparse_exchange`]), as often as
//! the longest chain of ranks needs.
//!
//! At the start of a run, the same records go to their owners ([`send_to_owners`], `send_cells_to_owners`), those of
//! contacts by a distributed directory ([`send_histories_to_owners`]). For each file that all ranks write, records are
//! sorted by id over the ranks ([`sort_by_id`]).
//!
//! [`exchange`]: Communicator::exchange
//! [`start_exchange`]: Communicator::start_exchange
//! [`sparse_exchange`]: Communicator::sparse_exchange
//! [`maximum`]: Communicator::maximum
//! [`sum_exact`]: Communicator::sum_exact
//! [`start_sum_exact`]: Communicator::start_sum_exact
//! [`sum_integers`]: Communicator::sum_integers

use bytemuck::Pod;
use std::fmt;
use std::io::Write;
use std::path::Path;

mod allocator;
mod cell_migration;
mod directory;
mod field_halo;
mod migrate;
mod migration_message;
#[cfg(feature = "mpi")]
mod mpi_ranks;
mod one_rank;
mod particle_halo;
mod pending;
mod records;
mod sort_by_id;
mod thread_ranks;

pub use crate::particles::{ContactRecord, ParticleRecord, WallContactRecord};
pub use allocator::AllocatorOfRanks;
pub(crate) use cell_migration::send_cells_to_owners;
pub use directory::send_histories_to_owners;
pub(crate) use field_halo::FieldHalo;
pub use migrate::{migrate, send_to_owners, share_with_all};
#[cfg(feature = "mpi")]
pub use mpi_ranks::{AlreadyStarted, MpiRanks, RawCommunicator, mpi_library};
pub use one_rank::OneRank;
pub use particle_halo::ParticleHalo;
pub use pending::{Exchange, Pending};
pub use records::{CellRecord, CellSample, ComputedRecords, Records, records_of_bytes};
pub use sort_by_id::{SortedRows, sort_by_id, sort_by_id_in_chunks, sort_numbers_by_id};
pub use thread_ranks::{is_on_root, run_on_threads, start_on_threads};

/// Without MPI this communicator has no values.
#[cfg(not(feature = "mpi"))]
#[derive(Clone, Copy)]
pub enum RawCommunicator {}

/// Name and version of the MPI library with which the program was built; `None` without MPI.
#[cfg(not(feature = "mpi"))]
pub fn mpi_library() -> Option<String> {
    None
}

/// The way in which all ranks write a file together.
#[derive(Clone, Copy)]
pub enum FileAccess {
    /// Every rank writes its own rows, through MPI-IO.
    Collective(RawCommunicator),
    /// Rank 0 writes the rows of all ranks, which send them to it.
    Root,
}

/// The two neighbours of a rank along one axis of the rank grid: below, above.
pub type AxisNeighbours = [Option<usize>; 2];

/// Bytes sent to a rank or received from one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// The other rank: the receiver of an outgoing message, the sender of an incoming one.
    pub rank: usize,
    /// The contents.
    pub bytes: Vec<u8>,
}

impl Message {
    /// A message of records, one after another.
    pub fn of<T: Pod>(rank: usize, records: &[T]) -> Self {
        Self { rank, bytes: bytemuck::cast_slice(records).to_vec() }
    }

    /// The record at a given place.
    #[inline(always)]
    fn record<T: Pod>(&self, place: usize) -> T {
        bytemuck::pod_read_unaligned(&self.bytes[place * size_of::<T>()..][..size_of::<T>()])
    }

    /// Overwrites the records of the message, which has as many. Appending each to a growing message would take twice
    /// as long.
    #[inline(always)]
    fn overwrite<T: Pod>(&mut self, records: impl Iterator<Item = T>) {
        for (room, record) in self.bytes.chunks_exact_mut(size_of::<T>()).zip(records) {
            room.copy_from_slice(bytemuck::bytes_of(&record));
        }
    }
}

/// Ranks that exchange bytes and add numbers. Every method except `rank`, `size`, `file_access`, `kind` and `is_root`
/// is collective: all ranks must call it in the same order. None can fail: a broken connection ends the program on all
/// ranks.
pub trait Communicator {
    /// The number of this rank, from 0.
    fn rank(&self) -> usize;

    /// Number of ranks.
    fn size(&self) -> usize;

    /// Sends `outgoing[0]` to the neighbour below and `outgoing[1]` to the one above. After: `incoming[0]` is the
    /// message that the neighbour below sent up, `incoming[1]` the one that the neighbour above sent down. If there is
    /// no neighbour, nothing is sent and `incoming` is empty. A rank may be its own neighbour (one rank along a
    /// periodic axis), and both neighbours may be the same rank (two ranks).
    fn exchange(
        &self,
        neighbours: AxisNeighbours,
        outgoing: [&[u8]; 2],
        incoming: &mut [Vec<u8>; 2],
    );

    /// Begins to send messages to other ranks, and to receive messages from them. Until this exchange is finished,
    /// ranks may call all other methods, but must not begin a second exchange.
    fn start_exchange(&self, exchange: Exchange) -> Pending<'_, Exchange>;

    /// Sends at most one message to each rank, this one included, and returns the messages to this rank in the order of
    /// their senders. An empty message is not sent. Ranks need not know which ranks send to them. The cost grows with
    /// the number of messages and the logarithm of the number of ranks.
    fn sparse_exchange(&self, outgoing: &[Message]) -> Vec<Message>;

    /// Replaces each number by its sum over ranks. The numbers must be multiples of one [quantum], and their sums must
    /// lie within its range. The result is then exact, and therefore does not depend on the number of ranks.
    ///
    /// [quantum]: crate::numbers::Quantum
    fn sum_exact(&self, values: &mut [f64]);

    /// Begins the sum of [`Communicator::sum_exact`]. Until it is finished, ranks may call all other methods, but must
    /// not begin a second sum.
    fn start_sum_exact(&self, values: Vec<f64>) -> Pending<'_, Vec<f64>>;

    /// Replaces each integer by its sum over ranks, modulo 2^64.
    fn sum_integers(&self, values: &mut [i64]);

    /// Replaces each number by its maximum over ranks. An undefined number (NaN) counts as infinity, so that it is not
    /// lost.
    fn maximum(&self, values: &mut [f64]);

    /// Returns the bytes of all ranks, in their order, on rank 0; `None` on the others.
    fn gather_to_root(&self, bytes: &[u8]) -> Option<Vec<Vec<u8>>>;

    /// Replaces the bytes on all ranks by those of rank 0.
    fn broadcast_from_root(&self, bytes: &mut Vec<u8>);

    /// The way in which all ranks open this file together.
    fn file_access(&self, path: &Path) -> FileAccess;

    /// The kind of ranks, as results give it: `MPI processes`, `threads`.
    fn kind(&self) -> &'static str;

    /// Number of processes that contain the ranks; smaller than the number of ranks if these are threads.
    fn processes(&self) -> usize {
        self.size()
    }

    /// Whether this is rank 0, which prints, and writes the files that are not written by all ranks together.
    fn is_root(&self) -> bool {
        self.rank() == 0
    }

    /// Whether a condition holds on any rank.
    fn any(&self, here: bool) -> bool {
        let mut flags = [i64::from(here)];
        self.sum_integers(&mut flags);
        flags[0] != 0
    }

    /// The sum of a count over ranks.
    fn total(&self, count: usize) -> usize {
        let mut counts = [count as i64];
        self.sum_integers(&mut counts);
        counts[0] as usize
    }
}

/// An error on one or several ranks, with the message of the lowest of them. It is equal on all ranks, so that all
/// react in the same way.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CollectiveError(pub String);

impl fmt::Display for CollectiveError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

impl std::error::Error for CollectiveError {}

/// Turns results that may differ between ranks into one on which all agree: an error on any rank becomes an error on
/// all. This call is collective.
///
/// # Errors
/// The error of the lowest rank that has one.
pub fn agree<T, E: fmt::Display>(
    result: Result<T, E>,
    ranks: &dyn Communicator,
) -> Result<T, CollectiveError> {
    if !ranks.any(result.is_err()) {
        return result.map_err(|error| CollectiveError(error.to_string()));
    }
    let message = result.err().map(|error| format!("{error}")).unwrap_or_default();
    let gathered = ranks.gather_to_root(message.as_bytes());
    let mut first = gathered
        .and_then(|all| all.into_iter().find(|bytes| !bytes.is_empty()))
        .unwrap_or_default();
    ranks.broadcast_from_root(&mut first);
    Err(CollectiveError(String::from_utf8_lossy(&first).into_owned()))
}

/// Ends this process at once, after an error that leaves its state undefined: the clean-up that other threads and
/// libraries would do at the end of a program is skipped.
pub fn end_at_once(code: i32) -> ! {
    flush_standard_streams();
    signal_hook::low_level::exit(code)
}

/// Flushes printed output before all ranks end. Errors no longer matter.
fn flush_standard_streams() {
    let _ = std::io::stdout().flush();
    let _ = std::io::stderr().flush();
}

/// The number that a maximum compares. NaN becomes infinity, since the result of comparisons with NaN depends on their
/// order.
fn comparable(value: f64) -> f64 {
    if value.is_nan() { f64::INFINITY } else { value }
}
