//! Ranks: what they say to each other, and what travels between them. Knows no physics.
//!
//! One rank is not a special case: periodic images are ghosts that a rank sends to itself.

use bytemuck::Pod;
use std::fmt;

mod balance;
mod cells;
mod field_halo;
mod migrate;
mod migration_message;
mod mpi_ranks;
mod one_rank;
mod owners;
mod particle_halo;
mod records;
mod sort_by_id;
mod thread_ranks;

pub use balance::RankLoad;
pub use cells::send_cells_to_owners;
pub use field_halo::FieldHalo;
pub use migrate::{migrate, send_to_owners, share_with_all};
pub use mpi_ranks::{AlreadyStarted, MpiRanks, RawCommunicator};
pub use one_rank::OneRank;
pub use owners::send_memories_to_owners;
pub use particle_halo::ParticleHalo;
pub use records::{
    CellRecord, ContactRecord, MadeRecords, ParticleRecord, Records, WallContactRecord,
    records_of_bytes,
};
pub use sort_by_id::{SortedBlock, in_bands, sort_by_id};
pub use thread_ranks::run_on_threads;

/// How files that all ranks write together are opened.
#[derive(Clone, Copy)]
pub enum FileAccess {
    /// Every rank writes its rows itself, collectively, through MPI-IO.
    Collective(RawCommunicator),
    /// Rank 0 writes the rows that the others send it.
    Root,
}

/// The two neighbours of a rank along one axis of the rank grid: below, above.
pub type AxisNeighbours = [Option<usize>; 2];

/// Bytes to a rank, or from one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// The other rank: the one that gets it or, of a message that has come, the one that sent it.
    pub rank: usize,
    /// What it says.
    pub bytes: Vec<u8>,
}

impl Message {
    /// Of records, one after another.
    pub fn of<T: Pod>(rank: usize, records: &[T]) -> Self {
        Self { rank, bytes: bytemuck::cast_slice(records).to_vec() }
    }
}

/// Ranks that exchange bytes and add numbers. Every method is collective: all ranks call it in the same
/// order. None can fail: a broken connection ends the program on all ranks.
pub trait Communicator {
    /// This rank's number, from 0.
    fn rank(&self) -> usize;

    /// Number of ranks.
    fn size(&self) -> usize;

    /// Sends `outgoing[0]` to the neighbour below and `outgoing[1]` to the one above; on return
    /// `incoming[0]` is what the neighbour below sent up, `incoming[1]` what the one above sent down.
    /// Where there is no neighbour nothing is sent and `incoming` is cleared. A rank may be its own
    /// neighbour (a periodic axis with one rank) and both neighbours may be one rank (with two).
    fn exchange(
        &self,
        neighbours: AxisNeighbours,
        outgoing: [&[u8]; 2],
        incoming: &mut [Vec<u8>; 2],
    );

    /// Sends messages to any ranks, at most one to each, also to this one; returns those to this rank by the rank that
    /// sent them, from the lowest. An empty message is not sent. Ranks need not know who writes to them, and what it
    /// costs follows the number of messages and the logarithm of the number of ranks.
    fn sparse_exchange(&self, outgoing: &[Message]) -> Vec<Message>;

    /// Replaces each number by its sum over ranks. The numbers must be multiples of one [lattice] and
    /// their sums within its range: then the result is exact, and so the same for any number of ranks.
    ///
    /// [lattice]: crate::numbers::Quantum
    fn sum_exact(&self, values: &mut [f64]);

    /// Replaces each integer by its sum over ranks, modulo 2^64.
    fn sum_integers(&self, values: &mut [i64]);

    /// Replaces each number by its largest over ranks. An undefined number (NaN) counts as infinity, so
    /// that it is not lost.
    fn maximum(&self, values: &mut [f64]);

    /// All ranks' bytes on rank 0, by rank; nothing on the others.
    fn gather_to_root(&self, bytes: &[u8]) -> Option<Vec<Vec<u8>>>;

    /// Rank 0's bytes on all ranks.
    fn broadcast_from_root(&self, bytes: &mut Vec<u8>);

    /// How files are written together.
    fn file_access(&self) -> FileAccess;

    /// Whether this rank speaks for all: prints, and writes the files that are not written together.
    fn is_root(&self) -> bool {
        self.rank() == 0
    }

    /// Whether a statement holds on any rank.
    fn any(&self, here: bool) -> bool {
        let mut flags = [i64::from(here)];
        self.sum_integers(&mut flags);
        flags[0] != 0
    }

    /// The sum over ranks of one count.
    fn total(&self, count: usize) -> usize {
        let mut counts = [count as i64];
        self.sum_integers(&mut counts);
        counts[0] as usize
    }
}

/// An error found on one rank or several, in the words of the lowest rank that found one: the same on
/// all ranks, so that all take the same way out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CollectiveError(pub String);

impl fmt::Display for CollectiveError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

impl std::error::Error for CollectiveError {}

/// Turns results that may differ between ranks into one that does not: an error anywhere is an error
/// everywhere. Collective.
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

/// What is compared in a maximum: comparisons with undefined numbers depend on their order.
fn comparable(value: f64) -> f64 {
    if value.is_nan() { f64::INFINITY } else { value }
}
