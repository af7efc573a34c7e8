//! What a run writes and when, and how it is spread over ranks: nothing that changes its physics.

use super::allowed::Allowed;
use super::section::Section;
use super::wall_time;
use crate::domain::RankGrid;
use crate::state::Balance;
use serde::Deserialize;
use std::time::Duration;

/// Intervals of results, in simulated time; `None`: not written.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputPlan {
    /// Interval of rows of the series.
    pub series: f64,
    /// Interval of profiles.
    pub profiles: Option<f64>,
    /// Interval of snapshots of all particles.
    pub particles: Option<f64>,
    /// Interval of snapshots of a gas in three dimensions.
    pub gas: Option<f64>,
    /// Solids fraction that bounds the bed's bottom and top.
    pub bed_threshold: f64,
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
    /// How many of the newest are kept.
    pub keep: usize,
}

/// How the box is cut across ranks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RankLayout {
    /// Slabs along an axis, as many as there are ranks.
    Slabs(usize),
    /// A rank grid; the number of ranks must fit.
    Grid(RankGrid),
}

/// How a run is spread over ranks; never changes results.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParallelPlan {
    /// How the box is cut.
    pub layout: RankLayout,
    /// Skin of the neighbour list over the largest diameter.
    pub skin: f64,
    /// ForceTorque balancing, unless it is switched off.
    pub balance: Option<Balance>,
}

impl Default for ParallelPlan {
    fn default() -> Self {
        let balance = Some(Balance::new(100, 1.05));
        Self { layout: RankLayout::Slabs(2), skin: 0.08, balance }
    }
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Axis {
    X,
    Y,
    Z,
}

/// `[output]`, for a run of this time step.
pub(super) fn read_output(section: Section<'_>, step: Option<f64>) -> Option<OutputPlan> {
    let interval = |key| {
        let interval = section.optional_number(key, Allowed::POSITIVE)?;
        match step {
            Some(step) if interval < step => {
                section.fail(key, format!("must be at least time.step, {step}"));
                None
            }
            _ => Some(interval),
        }
    };
    if !section.has("series") {
        section.number("series", Allowed::POSITIVE);
    }
    let series = interval("series");
    let profiles = interval("profiles");
    let particles = interval("particles");
    let gas = interval("gas");
    let fraction = Allowed::positive_up_to(0.74);
    let bed_threshold = section.number_or("bed_threshold", fraction, 0.3);
    section.note_default("bed_threshold", "0.3, the solids fraction that bounds the bed");
    section.finish();
    Some(OutputPlan { series: series?, profiles, particles, gas, bed_threshold })
}

/// `[checkpoint]`.
pub(super) fn read_checkpoint(section: Option<Section<'_>>) -> CheckpointPlan {
    const KEEP: u64 = 3;
    let Some(section) = section else {
        let keep = KEEP as usize;
        return CheckpointPlan { every: None, every_steps: None, every_wall_clock: None, keep };
    };
    section.at_most_one(&["every", "every_steps"]);
    let every = section.optional_number("every", Allowed::POSITIVE);
    let every_steps = section.optional_count("every_steps", 1..1_000_000_000_001);
    let every_wall_clock = read_wall_time(&section, "every_wall_clock");
    let keep = section.optional_count("keep", 1..1001).unwrap_or(KEEP) as usize;
    section.finish();
    CheckpointPlan { every, every_steps, every_wall_clock, keep }
}

/// `[run]`: the wall-clock time after which a run ends itself.
pub(super) fn read_run(section: Option<Section<'_>>) -> Option<Duration> {
    let section = section?;
    let wall_clock = read_wall_time(&section, "wall_clock");
    section.finish();
    wall_clock
}

/// `[parallel]`.
pub(super) fn read_parallel(section: Option<Section<'_>>) -> ParallelPlan {
    let mut plan = ParallelPlan::default();
    let Some(section) = section else { return plan };
    section.at_most_one(&["axis", "ranks"]);
    if let Some(axis) = section.optional::<Axis>("axis") {
        plan.layout = RankLayout::Slabs(axis as usize);
    }
    if let Some(ranks) = section.optional::<[usize; 3]>("ranks") {
        if ranks.iter().all(|&count| (1..=65_536).contains(&count)) {
            plan.layout = RankLayout::Grid(RankGrid(ranks));
        } else {
            section.fail("ranks", "each must be between 1 and 65536");
        }
    }
    plan.skin = section.number_or("skin", Allowed::between(0.001, 2.0), plan.skin);
    plan.balance = read_balance(&section, plan.balance);
    section.finish();
    plan
}

fn read_balance(section: &Section<'_>, default: Option<Balance>) -> Option<Balance> {
    let Some(node) = section.get("balance") else { return default };
    if let Some(text) = node.as_text() {
        if text != "off" {
            section.fail("balance", "must be \"off\" or { every = STEPS, threshold = RATIO }");
        }
        return None;
    }
    let inner = Section::of(node, section.problems)?;
    if !inner.has("every") {
        inner.fail("every", "missing: must be a number of steps");
    }
    let every = inner.optional_count("every", 1..1_000_000_001);
    let threshold = inner.number("threshold", Allowed::at_least(1.0));
    inner.finish();
    Some(Balance::new(every?, threshold?))
}

fn read_wall_time(section: &Section<'_>, key: &'static str) -> Option<Duration> {
    let text: String = section.optional(key)?;
    let span = wall_time::parse(&text);
    if span.is_none() {
        section.fail(key, format!("must be {}", wall_time::ALLOWED));
    }
    span
}
