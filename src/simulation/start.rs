//! Where a run begins: with a new bed, with the end of another run, or with its own checkpoint.

use super::layout::{LayoutError, aligned, lay_out};
use crate::case::{BedPart, Case, Start as BedStart};
use crate::domain::{Decomposition, RankGrid};
use crate::gas::GasState;
use crate::output::checkpoint::{self, Checkpoint};
use crate::parallel::{
    CellRecord, CollectiveError, Communicator, ContactRecord, ParticleRecord, RankLoad,
    WallContactRecord, agree, send_memories_to_owners, send_to_owners,
};
use crate::particles::{ContactHistories, Contacts, Particles};
use crate::state::{Clock, Departed, GasReport, SizeRange, State, Workspace};
use nalgebra::Vector3;
use thiserror::Error;

/// Why a run cannot begin. The same on all ranks.
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

/// A state spread over the ranks, and what is still to be done before its first step.
pub struct Beginning {
    /// The state, without ghosts and lists.
    pub state: State,
    /// An empty workspace.
    pub work: Workspace,
    /// How it starts.
    pub start: Start,
}

/// How the first step is prepared.
pub struct Start {
    /// The histories of all contacts of this rank's particles.
    pub histories: ContactHistories,
    /// Whether forces are still to be found.
    pub new_bed: bool,
    /// Whether results are continued from this time on.
    pub continues: bool,
}

/// What this rank holds of a bed, before it is sent to its owners.
#[derive(Default)]
struct Share {
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
pub fn begin_from_case(
    case: &Case,
    grid: Option<RankGrid>,
    ranks: &dyn Communicator,
) -> Result<Beginning, StartError> {
    let share = match &case.particles.start {
        BedStart::Run { path } => {
            let (end, _, _) = checkpoint::read(path, ranks)?;
            let mut share = share_of(end);
            share.cells.clear(); // the gas begins anew
            share
        }
        _ => {
            let part = BedPart { number: ranks.rank(), of: ranks.size() };
            let bed = agree(case.initial_bed(part), ranks).map_err(StartError::Bed)?;
            Share { particles: bed.particles, ..Share::default() }
        }
    };
    let sizes = match case.size_range() {
        Some(sizes) => sizes,
        None => measured_sizes(&share.particles, ranks),
    };
    let time_step = case.stages[0].time_step;
    let start = (Clock::new(time_step), Departed::default(), sizes);
    spread(case, share, start, grid, ranks).map(|(state, work, histories)| Beginning {
        state,
        work,
        start: Start { histories, new_bed: true, continues: false },
    })
}

/// The state of a checkpoint; `continues` says whether earlier results are in the output folder. Collective.
///
/// # Errors
/// If the ranks cannot divide it, or it does not fit the case.
pub fn begin_from_checkpoint(
    case: &Case,
    checkpoint: Checkpoint,
    grid: Option<RankGrid>,
    continues: bool,
    ranks: &dyn Communicator,
) -> Result<Beginning, StartError> {
    let start = (checkpoint.clock, checkpoint.departed, checkpoint.sizes);
    let share = share_of(checkpoint);
    spread(case, share, start, grid, ranks).map(|(state, work, histories)| Beginning {
        state,
        work,
        start: Start { histories, new_bed: false, continues },
    })
}

fn share_of(checkpoint: Checkpoint) -> Share {
    let Checkpoint { particles, contacts, wall_contacts, cells, gas_report: report, .. } =
        checkpoint;
    Share { particles, contacts, wall_contacts, cells, report }
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

type Spread = (State, Workspace, ContactHistories);

fn spread(
    case: &Case,
    share: Share,
    (clock, departed, sizes): (Clock, Departed, SizeRange),
    grid: Option<RankGrid>,
    ranks: &dyn Communicator,
) -> Result<Spread, StartError> {
    if let Some((key, message)) = case.check_sizes(&sizes).into_iter().next() {
        return Err(StartError::Sizes { key, message });
    }
    let mut decomposition = lay_out(case, &sizes, grid, ranks.size())?;
    let skin = case.parallel.skin * sizes.largest_diameter;
    if case.parallel.balance.is_some() {
        decomposition = balanced_at_start(case, &decomposition, &share.particles, &sizes, ranks);
        decomposition = aligned(case, decomposition, case.ghost_width(&sizes))?;
    }
    let Share { particles: records, contacts, wall_contacts, cells, report } = share;
    let records = send_to_owners(records, &decomposition, ranks);
    let mut particles = Particles::with_room_for(records.len());
    for record in records {
        record.push_to(&mut particles);
    }
    let histories = send_memories_to_owners(contacts, wall_contacts, &particles.id, ranks);
    let subdomain = decomposition.subdomain(&case.domain.bounds, ranks.rank());
    let gas = GasState::from_records(case.gas_on_cells(), &cells, report, subdomain, ranks);
    if gas == GasState::None {
        particles.gas_force.fill(Vector3::zeros());
    }
    let contacts = Contacts::default();
    let state = State { particles, contacts, clock, departed, sizes, gas, kick_due: None };
    Ok((state, Workspace::new(decomposition, skin, case.parallel.balance), histories))
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
