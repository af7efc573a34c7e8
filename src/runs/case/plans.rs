//! Results of a run, their times, and its division among ranks: settings that do not change its physics.

use super::context::require_a_step;
use crate::input::Section;
use std::time::Duration;
use talcum_engine::balance::Balance;
use talcum_engine::domain::RankGrid;

/// Intervals of results, in simulated time; `None` for results that are not written.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputPlan {
    /// Interval of rows of the series.
    pub series: f64,
    /// Interval of the forces on walls.
    pub walls: Option<f64>,
    /// Interval of the energy ledger, which is kept at every step.
    pub energy: Option<f64>,
    /// Interval of profiles.
    pub profiles: Option<f64>,
    /// Interval of snapshots of all particles.
    pub particles: Option<f64>,
    /// Additional columns for each particle in snapshots.
    pub particle_fields: Vec<ParticleField>,
    /// Interval of snapshots of a volume-averaged gas.
    pub gas: Option<f64>,
    /// Whether snapshots hold numbers of 4 bytes.
    pub single_precision: bool,
    /// Level of compression of snapshots: from 0, none, to 9.
    pub compression: u8,
    /// The instrument whose agglomerates are part of snapshots of the particles.
    pub agglomerates: Option<String>,
    /// Solids fraction at the bottom and top of the bed.
    pub bed_threshold: f64,
}

/// A quantity of a particle that a snapshot may contain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParticleField {
    /// Its mass.
    Mass,
    /// The number of its size class.
    Class,
    /// The number of its species.
    Species,
    /// The total force on it.
    Force,
    /// The force of the gas.
    GasForce,
    /// Number of particles that it touches.
    Coordination,
    /// Ratio of the drag to that of the law, if it depends on agglomerates.
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

/// Times of checkpoints, in addition to those at the end and on a signal.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckpointPlan {
    /// Interval in simulated time.
    pub every: Option<f64>,
    /// Interval in steps.
    pub every_steps: Option<u64>,
    /// Interval in wall-clock time.
    pub every_wall_clock: Option<Duration>,
    /// Whether the end of each stage is also kept.
    pub stage_ends: bool,
    /// Number of newest checkpoints that are kept.
    pub keep: usize,
}

/// Division of the box among ranks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RankLayout {
    /// Slabs along an axis, one for each rank.
    Slabs(usize),
    /// A rank grid; the number of ranks must fit.
    Grid(RankGrid),
    /// The rank grid with the best division of the work.
    Cheapest,
}

/// Distribution of a run over ranks; it never changes results.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParallelPlan {
    /// Division of the box.
    pub layout: RankLayout,
    /// Skin of the neighbour lists over the largest diameter, if it is given.
    pub skin: Option<f64>,
    /// Load balancing, unless it is switched off.
    pub balance: Option<Balance>,
}

/// Reads `[output]`, for a run with this time step.
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
        particle_fields: if section.has("particle_fields") {
            section.choices("particle_fields", &ParticleField::BY_WORD)?
        } else {
            Vec::new()
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

/// Reads `[parallel]`, for a run with or without a gas on cells.
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

/// Load balancing; `Some(None)` if it is switched off.
fn read_balance(section: &Section<'_>, on_cells: bool) -> Option<Option<Balance>> {
    if section.word("balance") == Some("off") {
        return Some(None);
    }
    let table = section.table_or_defaults("balance")?;
    let threshold = if table.has("threshold") {
        table.number("threshold")?
    } else {
        Balance::usual_threshold(on_cells)
    };
    Some(Some(Balance::new(table.count("every")?, threshold)))
}
