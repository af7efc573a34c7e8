//! Where a run starts: from a new bed, from the end of another run, or from its own checkpoint.

use super::layout::{LayoutError, aligned, lay_out};
use crate::case::{BedPart, BedStart, Case};
use crate::domain::{Decomposition, RankGrid};
use crate::gas::GasState;
use crate::output::checkpoint::{self, Checkpoint};
use crate::parallel::{
    CellRecord, CollectiveError, Communicator, ContactRecord, ParticleRecord, RankLoad,
    WallContactRecord, agree, send_histories_to_owners, send_to_owners,
};
use crate::particles::{ContactHistories, Contacts, Particles};
use crate::state::{Clock, Departed, GasReport, SizeRange, State, Workspace};
use nalgebra::Vector3;
use thiserror::Error;

/// Why a run cannot start. The same on all ranks.
#[derive(Debug, Error)]
pub enum StartError {
    /// The ranks cannot divide the box.
    #[error(transparent)]
    Layout(#[from] LayoutError),
    /// The bed cannot be made, or its file is wrong.
    #[error("{0}")]
    Bed(CollectiveError),
    /// A checkpoint cannot be read.
    #[error(transparent)]
    Checkpoint(#[from] crate::output::OutputError),
    /// The particles do not fit the case.
    #[error("{key}: {message}")]
    Sizes {
        /// Which key of the case.
        key: &'static str,
        /// What is wrong.
        message: String,
    },
}

/// Where an initial state comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// A new bed: forces are still to be found, and results begin with it.
    NewBed,
    /// A checkpoint, after which new results begin.
    Checkpoint,
    /// A checkpoint among results that are continued.
    ContinuedRun,
}

/// A state distributed over the ranks, and what is still to be done before its first step.
pub struct InitialState {
    /// The state, without ghosts and lists.
    pub state: State,
    /// An empty workspace.
    pub work: Workspace,
    /// Histories of its contacts.
    pub histories: ContactHistories,
    /// Where it comes from.
    pub origin: Origin,
}

/// What a state holds beside its records.
#[derive(Clone, Copy)]
struct StateHeader {
    clock: Clock,
    departed: Departed,
    sizes: SizeRange,
}

/// What this rank holds of a bed, before it is sent to its owners.
#[derive(Default)]
struct LocalRecords {
    particles: Vec<ParticleRecord>,
    contacts: Vec<ContactRecord>,
    wall_contacts: Vec<WallContactRecord>,
    cells: Vec<CellRecord>,
    report: GasReport,
}

/// The bed that the case describes, at time zero. Collective.
///
/// # Errors
/// If it cannot be made, or the ranks cannot divide it.
pub fn start_from_case(
    case: &Case,
    grid: Option<RankGrid>,
    ranks: &dyn Communicator,
) -> Result<InitialState, StartError> {
    let records = match &case.particles.start {
        BedStart::Run { path } => {
            let (end, _, _) = checkpoint::read(path, ranks)?;
            // The gas starts from rest.
            LocalRecords { cells: Vec::new(), ..LocalRecords::of(end) }
        }
        _ => {
            let part = BedPart { number: ranks.rank(), of: ranks.size() };
            let bed = agree(case.initial_bed(part), ranks).map_err(StartError::Bed)?;
            LocalRecords { particles: bed.particles, ..LocalRecords::default() }
        }
    };
    let sizes = match case.size_range() {
        Some(sizes) => sizes,
        None => measured_sizes(&records.particles, ranks),
    };
    let clock = Clock::new(case.stages[0].time_step);
    let header = StateHeader { clock, departed: Departed::default(), sizes };
    distribute(case, records, header, Origin::NewBed, grid, ranks)
}

/// The state of a checkpoint; `continues` says whether earlier results are in the output folder. Collective.
///
/// # Errors
/// If the ranks cannot divide it, or it does not fit the case.
pub fn start_from_checkpoint(
    case: &Case,
    checkpoint: Checkpoint,
    grid: Option<RankGrid>,
    continues: bool,
    ranks: &dyn Communicator,
) -> Result<InitialState, StartError> {
    let Checkpoint { clock, departed, sizes, .. } = checkpoint;
    let header = StateHeader { clock, departed, sizes };
    let origin = if continues { Origin::ContinuedRun } else { Origin::Checkpoint };
    distribute(case, LocalRecords::of(checkpoint), header, origin, grid, ranks)
}

impl LocalRecords {
    fn of(checkpoint: Checkpoint) -> Self {
        let Checkpoint { particles, contacts, wall_contacts, cells, gas_report: report, .. } =
            checkpoint;
        Self { particles, contacts, wall_contacts, cells, report }
    }
}

fn measured_sizes(particles: &[ParticleRecord], ranks: &dyn Communicator) -> SizeRange {
    let mut extremes = [f64::NEG_INFINITY, 0.0, 0.0];
    for particle in particles {
        extremes[0] = extremes[0].max(-2.0 * particle.radius);
        extremes[1] = extremes[1].max(2.0 * particle.radius);
        extremes[2] = extremes[2].max(particle.mass);
    }
    ranks.maximum(&mut extremes);
    let [smallest, largest_diameter, largest_mass] = extremes;
    SizeRange { smallest_diameter: -smallest, largest_diameter, largest_mass }
}

/// Sends the records to the ranks that own them. Collective.
fn distribute(
    case: &Case,
    records: LocalRecords,
    header: StateHeader,
    origin: Origin,
    grid: Option<RankGrid>,
    ranks: &dyn Communicator,
) -> Result<InitialState, StartError> {
    let StateHeader { clock, departed, sizes } = header;
    if let Some((key, message)) = case.check_sizes(&sizes).into_iter().next() {
        return Err(StartError::Sizes { key, message });
    }
    let mut decomposition = lay_out(case, &sizes, grid, ranks.size())?;
    if case.parallel.balance.is_some() {
        decomposition = balanced_at_start(case, &decomposition, &records.particles, &sizes, ranks);
        decomposition = aligned(case, decomposition, case.ghost_width(&sizes))?;
    }
    let LocalRecords { particles: records, contacts, wall_contacts, cells, report } = records;
    let records = send_to_owners(records, &decomposition, ranks);
    let mut particles = Particles::with_room_for(records.len());
    for record in records {
        record.push_to(&mut particles);
    }
    let histories = send_histories_to_owners(contacts, wall_contacts, &particles.id, ranks);
    let subdomain = decomposition.subdomain(&case.domain.bounds, ranks.rank());
    let gas = GasState::from_records(case.gas_on_cells(), &cells, report, subdomain, ranks);
    if gas == GasState::None {
        particles.gas_force.fill(Vector3::zeros());
    }
    let contacts = Contacts::default();
    let state = State { particles, contacts, clock, departed, sizes, gas };
    let skin = case.parallel.skin * sizes.largest_diameter;
    let work = Workspace::new(decomposition, skin, case.parallel.balance);
    Ok(InitialState { state, work, histories, origin })
}

fn balanced_at_start(
    case: &Case,
    decomposition: &Decomposition,
    particles: &[ParticleRecord],
    sizes: &SizeRange,
    ranks: &dyn Communicator,
) -> Decomposition {
    let positions: Vec<Vector3<f64>> =
        particles.iter().map(|record| Vector3::from(record.position)).collect();
    let width = case.ghost_width(sizes);
    RankLoad::UNKNOWN.balanced(
        decomposition,
        positions.iter().copied(),
        &case.domain.bounds,
        width,
        ranks,
    )
}
