//! The start of a run: from a new bed, from the end of another run, or from its own checkpoint.

use super::cheapest_grid::cheapest_grid;
use super::layout::{divide, layout_of, named_grid};
use crate::case::{BedPart, BedStart, Case, Change, RankLayout, changes};
use crate::input::InputErrors;
use crate::setup::{DistributedState, LayoutError, Snapshot};
use std::path::Path;
use talcum_engine::domain::{RankGrid, Wall};
use talcum_engine::gas::GasState;
use talcum_engine::parallel::{
    CollectiveError, Communicator, ParticleRecord, WallContactRecord, agree,
};
use talcum_engine::particles::{ContactHistories, CustomFields};
use talcum_engine::state::{SizeRange, State, Workspace};
use talcum_results::analysis::Digest;
use talcum_results::instruments::InstrumentState;
use talcum_results::output::checkpoint::{self, Checkpoint};
use thiserror::Error;

/// Reason why a run cannot start; it is equal on all ranks.
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
    Checkpoint(#[from] talcum_results::output::OutputError),
    /// The case differs from the one with which the checkpoint was written, in a way that is not possible.
    #[error("{change}: {reason}")]
    Changed {
        /// The difference.
        change: Change,
        /// The reason why it is not possible.
        reason: &'static str,
    },
    /// A checkpoint with cells that the gas does not have.
    #[error("{0}")]
    Cells(CollectiveError),
    /// The particles of the checkpoint carry a custom field of another program.
    #[error(
        "the particles of the checkpoint carry the field \"{name}\" ({meaning}), which this program does not \
         know: restart it with the program that wrote it"
    )]
    UnknownField {
        /// Name of the field.
        name: &'static str,
        /// Its meaning.
        meaning: &'static str,
    },
    /// The case does not suit the sizes of the particles, or the number of ranks.
    #[error(transparent)]
    Case(#[from] InputErrors),
}

/// Origin of an initial state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// A new bed: forces are still to be computed, and results begin with it.
    NewBed,
    /// A checkpoint after which new results begin.
    Checkpoint,
    /// A checkpoint among results that are continued.
    ContinuedRun,
}

/// A state distributed over the ranks, and data for the preparation of its first step.
pub struct InitialState {
    /// The state, without ghosts and lists.
    pub state: State,
    /// An empty workspace.
    pub work: Workspace,
    /// Histories of its contacts.
    pub histories: ContactHistories,
    /// Stored data of instruments.
    pub instruments: Vec<InstrumentState>,
    /// Its origin.
    pub origin: Origin,
    /// Digest of the state of another run with which it begins, if the case requires this.
    pub begins_with: Option<Digest>,
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
    let new_bed = |particles: Vec<ParticleRecord>| {
        let sizes = case.size_range().unwrap_or_else(|| measured_sizes(&particles, ranks));
        Snapshot::new_bed(particles, sizes, case.stages[0].physics.time_step)
    };
    let mut begins_with = None;
    let bed = match &case.particles.start {
        BedStart::Run { path } => {
            let (end, _, digest) = checkpoint::read(path, ranks)?;
            require_same_parcels(&changes(&end.case_text, &case.text))?;
            require_known_fields(&end.custom)?;
            begins_with = Some(digest);
            // The gas starts from rest.
            let (pairs, walls, gas_report) = (end.contacts, end.wall_contacts, end.gas_report);
            Snapshot { pairs, walls, gas_report, ..new_bed(end.particles) }
        }
        _ => {
            let part = BedPart { number: ranks.rank(), of: ranks.size() };
            new_bed(agree(case.initial_bed(part), ranks).map_err(StartError::Bed)?.particles)
        }
    };
    let initial = distribute(case, bed, Origin::NewBed, grid, ranks)?;
    Ok(InitialState { begins_with, ..initial })
}

/// The state of a checkpoint; `continues` is set if the results in the output folder are continued. Collective.
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
    let ledger = checkpoint.energy.as_ref().map(|ledger| Box::new(ledger.restored()));
    require_known_fields(&checkpoint.custom)?;
    let Checkpoint {
        clock, departed, sizes, particles, custom, cells, gas_report, looked_at, ..
    } = checkpoint;
    let before =
        Case::of_earlier_run(&checkpoint.case_text, "", Path::new(&checkpoint.case_folder), &[]);
    let over = before.as_ref().map_or(0, |before| before.stage_number_at(clock.time()));
    require_changes_that_can_be(&changes(&checkpoint.case_text, &case.text), over)?;
    agree(GasState::require_cells(case.gas_on_cells(), &cells), ranks)
        .map_err(StartError::Cells)?;
    let (pairs, mut walls) = (checkpoint.contacts, checkpoint.wall_contacts);
    if let Ok(before) = &before {
        renumber_walls(&mut walls, &before.domain.walls, &case.domain.walls);
    }
    let origin = if continues { Origin::ContinuedRun } else { Origin::Checkpoint };
    let end = Snapshot {
        clock,
        departed,
        sizes,
        particles,
        custom,
        pairs,
        walls,
        cells,
        gas_report,
        looked_at,
    };
    let instruments = checkpoint.instruments;
    let mut initial = InitialState { instruments, ..distribute(case, end, origin, grid, ranks)? };
    initial.state.energy = ledger;
    Ok(initial)
}

/// What a program has added to the particles, only that program can advance.
fn require_known_fields(custom: &CustomFields) -> Result<(), StartError> {
    match custom.fields.first() {
        Some(field) => Err(StartError::UnknownField { name: field.name, meaning: field.meaning }),
        None => Ok(()),
    }
}

/// Rejects a change of the number of particles in a parcel.
fn require_same_parcels(changes: &[Change]) -> Result<(), StartError> {
    match changes.iter().find(|change| change.key == PARCEL_SIZE) {
        Some(change) => Err(StartError::Changed {
            change: change.clone(),
            reason: "must be the same as in the run that this one starts from",
        }),
        None => Ok(()),
    }
}

/// The key for the size of parcels.
const PARCEL_SIZE: &str = "coarse_graining.factor";

/// Sections that describe a new bed; a checkpoint has its own bed.
const OF_A_NEW_BED: [&str; 4] = ["units", "box.lengths", "particles", PARCEL_SIZE];

/// Rejects changes that are not possible when a run is continued; `over` is the number of stages that are over.
fn require_changes_that_can_be(changes: &[Change], over: usize) -> Result<(), StartError> {
    for change in changes {
        let is_below = |section: &&str| {
            change
                .key
                .strip_prefix(section)
                .is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        let refused = |reason| Err(StartError::Changed { change: change.clone(), reason });
        let of_species = is_below(&"species")
            && ["name", "density"].iter().any(|key| change.key.rsplit('.').next() == Some(key));
        if OF_A_NEW_BED.iter().any(is_below) || of_species {
            return refused(
                "cannot change when a run is continued: the bed is that of the checkpoint",
            );
        }
        if change.key.ends_with("gas.cells") && change.before.is_some() && change.after.is_some() {
            return refused(
                "cannot change when a run is continued: the gas is that of the checkpoint",
            );
        }
        let stage =
            change.key.strip_prefix("stage.").and_then(|rest| rest.split('.').next()?.parse().ok());
        if stage.is_some_and(|number: usize| number <= over) {
            return refused("this stage is over at the time of the checkpoint");
        }
    }
    Ok(())
}

/// Renumbers contacts with walls. These refer to the numbers of the walls, which depend on the order in the case; the
/// walls are found by their names. A contact with a wall that no longer exists ends.
fn renumber_walls(contacts: &mut Vec<WallContactRecord>, before: &[Wall], now: &[Wall]) {
    let new_number = |old: u64| {
        let name = &before.get(old as usize)?.name;
        now.iter().position(|wall| wall.name == *name).map(|number| number as u64)
    };
    contacts.retain_mut(|contact| match new_number(contact.wall) {
        Some(number) => {
            contact.wall = number;
            true
        }
        None => false,
    });
}

/// Requires that the case defines the species of each particle of another run. Collective.
fn require_species(
    case: &Case,
    particles: &[ParticleRecord],
    ranks: &dyn Communicator,
) -> Result<(), StartError> {
    let mut last = [particles.iter().map(|particle| particle.species).fold(0.0, f64::max)];
    ranks.maximum(&mut last);
    let (needed, known) = (last[0] as usize + 1, case.particles.species_count());
    if needed <= known {
        return Ok(());
    }
    let message = format!("the bed at the start has {needed} species: the case has {known}");
    Err(StartError::Case(case.places.errors([("species", message)])))
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
    snapshot: Snapshot,
    origin: Origin,
    grid: Option<RankGrid>,
    ranks: &dyn Communicator,
) -> Result<InitialState, StartError> {
    let sizes = snapshot.sizes;
    case.require_sizes(&sizes)?;
    require_species(case, &snapshot.particles, ranks)?;
    let layout = layout_of(case, &sizes);
    let cheapest = || cheapest_grid(case, &sizes, &snapshot.particles, ranks);
    let rank_grid = grid.or_else(cheapest).unwrap_or_else(|| named_grid(case, ranks.size()));
    let divided = divide(case, &layout, rank_grid, &snapshot.particles, ranks);
    let decomposition = divided.map_err(|error| match (grid, case.parallel.layout) {
        // The case names the grid that does not fit.
        (None, RankLayout::Grid(_)) => {
            StartError::Case(case.places.errors([("parallel.ranks", error.to_string())]))
        }
        _ => error.into(),
    })?;
    let gas = case.gas_on_cells();
    let DistributedState { state, histories } =
        snapshot.distribute(&case.domain.bounds, gas, &decomposition, ranks);
    let (skin, least_width) = (case.skin(&sizes), case.ghost_width(&sizes));
    let work = Workspace::new(decomposition, skin, least_width, case.parallel.balance);
    let instruments = Vec::new();
    Ok(InitialState { state, work, histories, instruments, origin, begins_with: None })
}
