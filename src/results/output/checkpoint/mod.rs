//! Checkpoints: one HDF5 file with all data on which the future of a run depends, written by all ranks, and read by any
//! number of ranks.
//!
//! It never contains ghosts, neighbour lists, the decomposition of the box, or any derived data. Rows are sorted by id,
//! so that the file does not depend on the number of ranks.

use crate::analysis::{Digest, Pair, StateRecords};
use crate::instruments::InstrumentState;
use talcum_engine::parallel::{
    CellRecord, ContactRecord, ParticleRecord, Records, WallContactRecord,
};
use talcum_engine::particles::CustomFields;
use talcum_engine::state::{Clock, Departed, EnergyLedger, GasReport, SizeRange, StoredEnergy};

mod folder;
mod instruments;
mod read;
mod schema;
mod write;

pub use folder::{
    Search, file_name, files_in, keep_as, newest_good, prune, stage_file_name, supersede,
};
pub use folder::{is_checkpoint, is_stage_end};
pub use read::read;
pub use write::write;

/// One rank's part of a state, and the case with which the run was started. Particles are records that are stored, or
/// made while they are written.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint<P = Vec<ParticleRecord>> {
    /// Time.
    pub clock: Clock,
    /// Particles that have left the box.
    pub departed: Departed,
    /// Sizes of the particles at the start.
    pub sizes: SizeRange,
    /// Text of the case in effect.
    pub case_text: String,
    /// Folder for relative paths in the case.
    pub case_folder: String,
    /// This rank's particles, in any order; positions wrapped into the box.
    pub particles: P,
    /// Custom fields of these particles, in the same order.
    pub custom: CustomFields,
    /// Histories of touching pairs, each on one rank, in any order.
    pub contacts: Vec<ContactRecord>,
    /// Histories of contacts with walls, each on one rank, in any order.
    pub wall_contacts: Vec<WallContactRecord>,
    /// Cells of a volume-averaged gas, each on one rank, in any order; empty without such a gas.
    pub cells: Vec<CellRecord>,
    /// Report on the last step of that gas.
    pub gas_report: GasReport,
    /// Pairs that touched at the last search for agglomerates, if drag depends on them: each on one rank, in any order.
    pub looked_at: Option<Vec<Pair>>,
    /// The energy ledger, if one is kept. It is not part of the state or of its digest.
    pub energy: Option<StoredLedger>,
    /// Data of instruments; the digest does not include them.
    pub instruments: Vec<InstrumentState>,
}

/// An energy ledger in its stored form.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredLedger {
    /// The integers of its exact sums: those of this rank, or those of all ranks on rank 0 and none elsewhere.
    pub sums: Vec<i64>,
    /// Energy stored by the particles when it was opened.
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
    pub fn digest(&self, ranks: &dyn talcum_engine::parallel::Communicator) -> Digest {
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
