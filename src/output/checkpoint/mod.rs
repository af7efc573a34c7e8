//! Checkpoints: one HDF5 file with all that the future of a run depends on, written by all ranks, read
//! by any number of ranks.
//!
//! Never in it: ghosts, neighbour lists, the decomposition of the box, or anything that follows from the rest. Rows
//! are sorted by id, so that the file does not depend on the number of ranks.

use crate::analysis::{Digest, Pair, StateRecords};
use crate::measures::MeasureState;
use crate::parallel::{CellRecord, ContactRecord, ParticleRecord, Records, WallContactRecord};
use crate::particles::CustomFields;
use crate::state::{Clock, Departed, EnergyLedger, GasReport, SizeRange, StoredEnergy};

mod folder;
mod measures;
mod read;
mod schema;
mod write;

pub use folder::{
    Search, file_name, files_in, keep_as, newest_good, prune, stage_file_name, supersede,
};
pub(crate) use folder::{is_checkpoint, is_stage_end};
pub use read::read;
pub use write::write;

/// One rank's part of a state, and what the run was started with. Particles are records that are there, or that are
/// made while they are written.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint<P = Vec<ParticleRecord>> {
    /// Time.
    pub clock: Clock,
    /// What has left the box.
    pub departed: Departed,
    /// Sizes of the particles at the start.
    pub sizes: SizeRange,
    /// Text of the case in effect.
    pub case_text: String,
    /// Folder that relative paths in the case refer to.
    pub case_folder: String,
    /// This rank's particles, in any order; positions wrapped into the box.
    pub particles: P,
    /// Custom fields of these particles, in the same order.
    pub custom: CustomFields,
    /// Histories of touching pairs, each on one rank, in any order.
    pub contacts: Vec<ContactRecord>,
    /// Histories of contacts with walls, each on one rank, in any order.
    pub wall_contacts: Vec<WallContactRecord>,
    /// Cells of a volume-averaged gas, each on one rank, in any order; none without such a gas.
    pub cells: Vec<CellRecord>,
    /// How the last step of that gas went.
    pub gas_report: GasReport,
    /// Pairs that touched at the last search for agglomerates, if drag follows from them: each on one rank, in any order.
    pub looked_at: Option<Vec<Pair>>,
    /// The ledger of energies, if one is kept. It is no part of the state, nor of its digest.
    pub energy: Option<StoredLedger>,
    /// What measures keep; the digest does not see it.
    pub measures: Vec<MeasureState>,
}

/// A ledger of energies as it is stored.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredLedger {
    /// The integers of its exact sums: those of this rank, or of all ranks on rank 0 and none elsewhere.
    pub sums: Vec<i64>,
    /// What was stored when it was opened.
    pub start: StoredEnergy,
}

impl StoredLedger {
    /// This rank's part of a ledger.
    pub fn of(ledger: &EnergyLedger) -> Self {
        Self { sums: ledger.stored(), start: ledger.start() }
    }

    /// The ledger.
    pub fn restored(&self) -> EnergyLedger {
        EnergyLedger::restore(&self.sums, self.start)
    }
}

impl<P: Records<ParticleRecord>> Checkpoint<P> {
    /// Hash of the state over all ranks. Collective.
    pub fn digest(&self, ranks: &dyn crate::parallel::Communicator) -> Digest {
        let records = StateRecords {
            particles: &self.particles,
            custom: &self.custom,
            contacts: &self.contacts,
            wall_contacts: &self.wall_contacts,
            cells: &self.cells,
            looked_at: self.looked_at.as_deref().unwrap_or_default(),
        };
        Digest::of(&self.clock, &records, ranks)
    }
}
