//! `talcum check`: what would run, in numbers.

mod adhesion;
mod lines;
mod stage;

use super::Changes;
use super::memory;
use super::progress::readable;
use super::reading::read_case;
use super::report::six_digits;
use super::run::say;
use crate::case::Case;
use crate::domain::{Face, Wall, WallMotion, WallShape};
use crate::parallel::Communicator;
use crate::simulation::{InitialState, start_from_case};
use crate::state::{SizeRange, State};
use crate::time_step::{self, Staggered};
use std::fmt::Write;
use std::path::Path;
use std::time::{Duration, Instant};

/// How long the trial for the run's time may take.
const TRIAL: Duration = Duration::from_secs(1);

/// Reads, validates and describes a case. Collective.
pub(super) fn check(
    path: &Path,
    changes: &Changes,
    ranks: &dyn Communicator,
) -> anyhow::Result<()> {
    let case = read_case(path, &changes.set, ranks)?;
    memory::require(&case, changes.any_memory, ranks)?;
    let mut initial = start_from_case(&case, changes.ranks, ranks)?;
    let particles = ranks.total(initial.state.particles.owned_count());
    let sizes = initial.state.sizes;
    let mut message = super::report::head(&case, particles, ranks.size());
    describe_box(&mut message, &case, &sizes);
    for stage in &case.stages {
        stage::describe(&mut message, &case, stage, &sizes);
    }
    describe_ranks(&mut message, &initial, ranks);
    let megabytes = 1.0e-6 * memory::needed(&case, Some(particles as f64), ranks);
    let _ = writeln!(message, "memory: about {megabytes:.0} MB in all");
    // Before the trial: what stands here helps where the trial fails.
    say(ranks, message.trim_end());
    let seconds = trial(&case, &mut initial, ranks)?;
    let steps = case.end_time() / case.stages[0].physics.time_step;
    let total = readable(seconds * steps);
    let on_ranks = super::report::count_of(ranks.size(), "rank");
    say(
        ranks,
        &format!(
            "run's time: {steps:.0} steps, about {total} at the pace of the first steps here on {on_ranks}"
        ),
    );
    Ok(())
}

fn describe_box(message: &mut String, case: &Case, sizes: &SizeRange) {
    let bounds = &case.domain.bounds;
    let d = sizes.largest_diameter;
    let lengths = bounds.lengths();
    let in_diameters = lengths / d;
    let _ = writeln!(
        message,
        "box: {} x {} x {} ({:.3} x {:.3} x {:.3} of the largest diameter)",
        six_digits(lengths.x),
        six_digits(lengths.y),
        six_digits(lengths.z),
        in_diameters.x,
        in_diameters.y,
        in_diameters.z
    );
    for axis in 0..3 {
        let face = |kind| match kind {
            Face::Periodic => "periodic",
            Face::Wall => "wall",
            Face::Open => "open: particles leave and are counted",
            Face::Stop => "a particle that passes ends the run",
        };
        let [lower, upper] = bounds.faces(axis).map(face);
        let axis = ["x", "y", "z"][axis];
        let _ = writeln!(message, "  {axis}: lower {lower}, upper {upper}");
    }
    for wall in &case.domain.walls {
        let _ = writeln!(message, "  wall \"{}\" {}", wall.name, describe_wall(wall));
    }
}

/// Where a wall is, and how it moves.
fn describe_wall(wall: &Wall) -> String {
    let mut message = match wall.shape {
        WallShape::Plane { point: p, normal: n } => format!(
            "through ({}, {}, {}), normal ({:.4}, {:.4}, {:.4})",
            six_digits(p.x),
            six_digits(p.y),
            six_digits(p.z),
            n.x,
            n.y,
            n.z
        ),
        WallShape::Cylinder { centre, radius } => {
            format!("round about ({}, {}), radius {radius}, particles inside", centre.x, centre.y)
        }
    };
    let WallMotion { velocity: v, amplitude: a, frequency, start, end } = wall.motion;
    if !wall.motion.is_rest() {
        let _ = write!(message, ", velocity ({}, {}, {})", v.x, v.y, v.z);
        let _ = write!(message, ", amplitude ({}, {}, {}) at {frequency}", a.x, a.y, a.z);
        let _ = write!(message, ", from {start} to {end}");
    }
    message
}

fn describe_ranks(message: &mut String, initial: &InitialState, ranks: &dyn Communicator) {
    let here = initial.state.particles.owned_count() as u64;
    let counts = ranks.gather_to_root(&here.to_le_bytes()).unwrap_or_default();
    for (rank, bytes) in counts.iter().enumerate() {
        let corners =
            initial.work.decomposition.subdomain_corners(rank).map(|corner| corner.map(six_digits));
        let [lower, upper] = corners;
        let count = bytes.as_slice().try_into().map_or(0, u64::from_le_bytes);
        let _ = writeln!(
            message,
            "rank {rank}: x {} to {}, y {} to {}, z {} to {}, {count} particles",
            lower.x, upper.x, lower.y, upper.y, lower.z, upper.z
        );
    }
}

/// Seconds per step, from the first steps of the case.
fn trial(case: &Case, initial: &mut InitialState, ranks: &dyn Communicator) -> anyhow::Result<f64> {
    let InitialState { state, work, histories, .. } = initial;
    let State { sizes, .. } = *state;
    let models = case.stages[0].models(&sizes);
    work.prepare(&case.domain, &models, &sizes);
    let histories = std::mem::take(histories);
    time_step::begin(state, &case.domain, &models, work, histories, ranks)?;
    time_step::find_first_forces(state, &case.domain, &models, work, ranks);
    let mut state = Staggered::new(state);
    let start = Instant::now();
    let mut steps = 0;
    // The pace of rank 0 decides for all: a collective look every few steps.
    while !ranks.any(ranks.is_root() && start.elapsed() > TRIAL) {
        for _ in 0..10 {
            time_step::advance(&mut state, &case.domain, &models, work, ranks)?;
        }
        steps += 10;
    }
    Ok(start.elapsed().as_secs_f64() / f64::from(steps.max(1)))
}
