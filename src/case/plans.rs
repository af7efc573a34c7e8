//! What a run writes and when, and how it is spread over ranks: nothing that changes its physics.

use super::context::require_a_step;
use crate::domain::RankGrid;
use crate::input::Section;
use crate::state::Balance;
use std::time::Duration;

/// Intervals of results, in simulated time; `None`: not written.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputPlan {
    /// Interval of rows of the series.
    pub series: f64,
    /// Interval of the forces on walls.
    pub walls: Option<f64>,
    /// Interval of the ledger of energies, which is kept at every step.
    pub energy: Option<f64>,
    /// Interval of profiles.
    pub profiles: Option<f64>,
    /// Interval of snapshots of all particles.
    pub particles: Option<f64>,
    /// What snapshots show of each particle, beside what they always show.
    pub particle_fields: Vec<ParticleField>,
    /// Interval of snapshots of a volume-averaged gas.
    pub gas: Option<f64>,
    /// Whether snapshots hold numbers of 4 bytes.
    pub single_precision: bool,
    /// How hard snapshots are compressed: from 0, not at all, to 9.
    pub compression: u8,
    /// The measure whose agglomerates snapshots of the particles show.
    pub agglomerates: Option<String>,
    /// Solids fraction that bounds the bed's bottom and top.
    pub bed_threshold: f64,
}

/// What a snapshot may show of a particle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParticleField {
    /// Its mass.
    Mass,
    /// The number of its size class.
    Class,
    /// The number of its species.
    Species,
    /// All that acts on it.
    Force,
    /// The part of the gas.
    GasForce,
    /// How many particles it touches.
    Coordination,
    /// Drag over that of the law, where it follows from agglomerates.
    DragFactor,
}

impl ParticleField {
    const BY_WORD: [(&str, Self); 7] = [
        ("mass", Self::Mass),
        ("class", Self::Class),
        ("species", Self::Species),
        ("force", Self::Force),
        ("gas_force", Self::GasForce),
        ("coordination", Self::Coordination),
        ("drag_factor", Self::DragFactor),
    ];
}

/// When checkpoints are written, besides at the end and on a signal.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckpointPlan {
    /// Interval in simulated time.
    pub every: Option<f64>,
    /// Interval in steps.
    pub every_steps: Option<u64>,
    /// Interval in wall-clock time.
    pub every_wall_clock: Option<Duration>,
    /// Whether the end of each stage is kept beside them.
    pub stage_ends: bool,
    /// How many of the newest are kept.
    pub keep: usize,
}

/// How the box is divided among ranks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RankLayout {
    /// Slabs along an axis, as many as there are ranks.
    Slabs(usize),
    /// A rank grid; the number of ranks must fit.
    Grid(RankGrid),
    /// The rank grid that shares the work best.
    Cheapest,
}

/// How a run is spread over ranks; never changes results.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParallelPlan {
    /// How the box is divided.
    pub layout: RankLayout,
    /// Skin of the neighbour lists over the largest diameter, if it is given.
    pub skin: Option<f64>,
    /// Load balancing, unless it is switched off.
    pub balance: Option<Balance>,
}

/// `[output]`, for a run of this time step.
pub(super) fn read_output(section: &Section<'_>, step: Option<f64>) -> Option<OutputPlan> {
    let interval = |key| {
        let interval = section.number(key);
        require_a_step(section, key, interval, step);
        interval
    };
    let [series, walls, energy, profiles, particles, gas] =
        ["series", "walls", "energy", "profiles", "particles", "gas"].map(interval);
    let bed_threshold = section.number("bed_threshold")?;
    let agglomerates = section.text("agglomerates");
    Some(OutputPlan {
        series: series?,
        walls,
        energy,
        profiles,
        particles,
        particle_fields: match section.has("particle_fields") {
            true => section.choices("particle_fields", &ParticleField::BY_WORD)?,
            false => Vec::new(),
        },
        gas,
        single_precision: section.word("precision")? == "single",
        compression: section.count("compression")? as u8,
        agglomerates,
        bed_threshold,
    })
}

/// `[checkpoint]`.
pub(super) fn read_checkpoint(section: &Section<'_>) -> Option<CheckpointPlan> {
    Some(CheckpointPlan {
        every: section.number("every"),
        every_steps: section.count("every_steps"),
        every_wall_clock: section.wall_time("every_wall_clock"),
        stage_ends: section.boolean("stage_ends")?,
        keep: section.count("keep")? as usize,
    })
}

/// `[parallel]`, of a run with or without a gas on cells.
pub(super) fn read_parallel(section: &Section<'_>, on_cells: bool) -> Option<ParallelPlan> {
    let axes = [("x", 0), ("y", 1), ("z", 2)];
    let layout = if section.has("ranks") {
        RankLayout::Grid(RankGrid(section.counts("ranks")?))
    } else if section.has("axis") {
        RankLayout::Slabs(section.choice("axis", &axes)?)
    } else {
        RankLayout::Cheapest
    };
    let balance = read_balance(section, on_cells)?;
    Some(ParallelPlan { layout, skin: section.number("skin"), balance })
}

/// Load balancing; `Some(None)`: none.
fn read_balance(section: &Section<'_>, on_cells: bool) -> Option<Option<Balance>> {
    if section.word("balance") == Some("off") {
        return Some(None);
    }
    let table = section.table_or_defaults("balance")?;
    let threshold = match table.has("threshold") {
        true => table.number("threshold")?,
        false => Balance::usual_threshold(on_cells),
    };
    Some(Some(Balance::new(table.count("every")?, threshold)))
}
