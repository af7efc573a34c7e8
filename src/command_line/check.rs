//! `talcum check`: what would run, in numbers.

use super::Changes;
use super::progress::in_words;
use super::reading::read_case;
use super::report::six_digits;
use super::run::say;
use crate::case::{Case, Stage};
use crate::contact::{ContactForceLaw, ContactModel};
use crate::coupling::FlowModel;
use crate::domain::{Face, Wall, WallMotion, WallShape};
use crate::gas::volume_averaged::Boundary;
use crate::gas::{ColumnGas, Drive, ParticleDrag};
use crate::parallel::Communicator;
use crate::simulation::{Beginning, begin_from_case};
use crate::state::{GasModel, SizeRange, State};
use crate::time_step;
use std::fmt::Write;
use std::path::Path;
use std::time::{Duration, Instant};

/// Steps per contact below which collisions are no longer resolved.
const LEAST_STEPS_PER_CONTACT: f64 = 12.0;
/// Bytes per particle in all: columns, ghosts, lists and contacts of a settled bed.
const BYTES_PER_PARTICLE: f64 = 600.0;
/// Overlap over diameter at which stiffness is told.
const SMALL_OVERLAP: f64 = 0.01;
/// How long the trial for the run's time may take.
const TRIAL: Duration = Duration::from_secs(1);

/// Reads, validates and describes a case. Collective.
pub(super) fn check(
    path: &Path,
    changes: &Changes,
    ranks: &dyn Communicator,
) -> anyhow::Result<()> {
    let case = read_case(path, &changes.set, ranks)?;
    let mut beginning = begin_from_case(&case, changes.ranks, ranks)?;
    let particles = ranks.total(beginning.state.particles.owned_count());
    let sizes = beginning.state.sizes;
    let mut message = super::report::head(&case, particles, ranks.size());
    describe_box(&mut message, &case, &sizes);
    for stage in &case.stages {
        describe_stage(&mut message, &case, stage, &sizes);
    }
    describe_ranks(&mut message, &beginning, ranks);
    let megabytes = particles as f64 * BYTES_PER_PARTICLE * 1.0e-6;
    let _ = writeln!(message, "memory: about {megabytes:.0} MB in all, and 50 MB per rank");
    let seconds = trial(&case, &mut beginning, ranks)?;
    let steps = case.end_time() / case.stages[0].time_step;
    let total = in_words(Duration::from_secs_f64(seconds * steps));
    let _ = writeln!(
        message,
        "run's time: {steps:.0} steps, about {total} at the pace of the first steps here on {}",
        super::report::count_of(ranks.size(), "rank")
    );
    say(ranks, message.trim_end());
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

fn describe_stage(message: &mut String, case: &Case, stage: &Stage, sizes: &SizeRange) {
    let _ = writeln!(message, "stage \"{}\":", stage.name);
    let diameter = case.particles.reference_diameter;
    let density = case.particles.density;
    let mass = case.particles.mass_of(diameter);
    let g = stage.gravity.magnitude;
    let mut line = |name: &str, value: String| {
        let _ = writeln!(message, "  {name:<34}{value}");
    };
    if g > 0.0 {
        let stiffness = stage.contact.law.stiffness(SMALL_OVERLAP * diameter, 0.25 * diameter);
        let scaled = stiffness / (density * g * diameter * diameter);
        line("k_n / (rho_s g d^2)", format!("{scaled:.4e}"));
    }
    if let (Some(cohesion), true) = (&stage.cohesion, g > 0.0) {
        let weight = mass * g;
        let pair = cohesion.hamaker_constant.largest() * 0.5 * diameter
            / (12.0 * cohesion.cut_off.powi(2));
        let wall = cohesion.wall_hamaker_constant.largest() * 0.5 * diameter
            / (6.0 * cohesion.cut_off.powi(2));
        line(
            "Bond number, particles and walls",
            format!("{:.4}, {:.4}", pair / weight, wall / weight),
        );
    }
    if let Some(vibration) = &stage.gravity.vibration {
        let gamma = vibration.relative_acceleration;
        line("Gamma, frequency", format!("{gamma:.4}, {:.4}", vibration.frequency));
    }
    match &stage.gas {
        None => {}
        Some(GasModel::Column(gas)) => describe_column(&mut line, gas, diameter, density, g),
        Some(GasModel::VolumeAveraged(model)) => {
            let particle = (diameter, mass, mass * g);
            describe_flow(&mut line, model, particle, stage.time_step);
        }
    }
    describe_contacts(&mut line, case, stage, sizes);
}

/// How long contacts of the smallest particles last: with each other, and with walls that are otherwise.
fn describe_contacts(
    line: &mut impl FnMut(&str, String),
    case: &Case,
    stage: &Stage,
    sizes: &SizeRange,
) {
    let mass = case.particles.mass_of(sizes.smallest_diameter);
    let radius = 0.5 * sizes.smallest_diameter;
    let mut tell = |name: &str, interface: &ContactModel, mass: f64, radius: f64| {
        let duration = interface.law.contact_duration(mass, radius);
        let steps = duration / stage.time_step;
        let law = interface.law.name();
        line(name, format!("{duration:.4e}, {steps:.1} time steps ({law})"));
    };
    tell("duration of a contact", &stage.contact, 0.5 * mass, 0.5 * radius);
    for (wall, interface) in case.domain.walls.iter().zip(&stage.at_walls) {
        if *interface != stage.contact {
            tell(&format!("with wall \"{}\"", wall.name), interface, mass, radius);
        }
    }
    if case.shortest_contact(stage, sizes) / stage.time_step < LEAST_STEPS_PER_CONTACT {
        line(
            "warning",
            format!("fewer than {LEAST_STEPS_PER_CONTACT} steps per contact: shorten time.step"),
        );
    }
}

/// Voidage of a loose bed, at which the response of particles to the gas is told.
const LOOSE: f64 = 0.45;

/// Cells, and how the gas step compares with what limits it.
fn describe_flow(
    line: &mut impl FnMut(&str, String),
    model: &FlowModel,
    (diameter, mass, weight): (f64, f64, f64),
    time_step: f64,
) {
    let (gas, spacing) = (&model.gas, model.grid.spacing());
    let [nx, ny, nz] = model.grid.counts();
    let in_diameters = spacing / diameter;
    line(
        "gas, cells",
        format!(
            "{nx} x {ny} x {nz} of {:.3} x {:.3} x {:.3} of the diameter",
            in_diameters.x, in_diameters.y, in_diameters.z
        ),
    );
    if in_diameters.min() < 2.999 && model.coupling.filter_width < 3.0 * diameter {
        let message =
            "cells are below 3 diameters: gas.filter_width of 3 to 6 diameters is advised";
        line("warning", message.to_owned());
    }
    let step = time_step * model.substeps as f64;
    line("gas step", format!("{step:.4e}, {} time steps", model.substeps));
    let inflow = gas.boundaries.iter().flatten().filter_map(|boundary| match boundary {
        Boundary::Inlet(inlet) => Some(inlet.velocity.largest().abs()),
        _ => None,
    });
    let speed = inflow.fold(0.0, f64::max) / LOOSE;
    let courant = step * speed / spacing.min();
    line("Courant number of the inflow", format!("{courant:.4} (gas in a bed of voidage {LOOSE})"));
    let rates = spacing.map(|dx| 1.0 / (dx * dx));
    let viscous = 4.0 * step * gas.viscosity / gas.density * rates.sum();
    line("viscous number", format!("{viscous:.4}; 2 Courant + viscous / 2 may not exceed 1"));
    let drag = model.coupling.drag.per_velocity(diameter, 1.0 - LOOSE, speed * LOOSE);
    let response = drag * step / (mass * LOOSE * LOOSE);
    line("b dt / (m eps^2)", format!("{response:.4} at a voidage of {LOOSE}; may not exceed 1"));
    if weight > 0.0 {
        expect_fluidisation(line, &model.coupling.drag, diameter, weight);
    }
}

fn describe_column(
    line: &mut impl FnMut(&str, String),
    gas: &ColumnGas,
    diameter: f64,
    density: f64,
    g: f64,
) {
    let drive = match &gas.drive {
        Drive::Velocity(schedule) => {
            format!("superficial velocity up to {:.6e}", schedule.largest())
        }
        Drive::Weight(_) => "carries the weight of the bed".to_owned(),
    };
    line("gas", drive);
    line("grid spacing over diameter", format!("{:.4}", gas.spacing / diameter));
    if g == 0.0 {
        return;
    }
    let stokes = density * g.sqrt() * diameter.powf(1.5) / gas.viscosity;
    line("Stokes number", format!("{stokes:.4}"));
    let weight = density * std::f64::consts::PI / 6.0 * diameter.powi(3) * g;
    expect_fluidisation(line, &gas.particle_drag(), diameter, weight);
}

fn expect_fluidisation(
    line: &mut impl FnMut(&str, String),
    drag: &ParticleDrag,
    diameter: f64,
    weight: f64,
) {
    let expected: Vec<String> = [0.60, 0.62, 0.64]
        .map(|phi| {
            format!("{:.4e} at phi {phi:.2}", minimum_fluidisation(drag, diameter, weight, phi))
        })
        .to_vec();
    line("U_mf of the force balance", expected.join(", "));
}

/// The superficial velocity at which the gas carries particles at rest: (V / phi) beta U / (1 - phi)^2 = m g.
fn minimum_fluidisation(drag: &ParticleDrag, diameter: f64, weight: f64, phi: f64) -> f64 {
    let force = |u: f64| drag.per_velocity(diameter, phi, u) * u / (1.0 - phi).powi(2);
    let (mut low, mut high) = (0.0, 1.0e-12);
    while force(high) < weight {
        high *= 2.0;
    }
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if force(middle) < weight { low = middle } else { high = middle }
    }
    high
}

fn describe_ranks(message: &mut String, beginning: &Beginning, ranks: &dyn Communicator) {
    let here = beginning.state.particles.owned_count() as u64;
    let counts = ranks.gather_to_root(&here.to_le_bytes()).unwrap_or_default();
    for (rank, bytes) in counts.iter().enumerate() {
        let corners =
            beginning.work.decomposition.block_bounds(rank).map(|corner| corner.map(six_digits));
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
fn trial(case: &Case, beginning: &mut Beginning, ranks: &dyn Communicator) -> anyhow::Result<f64> {
    let Beginning { state, work, start } = beginning;
    let State { sizes, .. } = *state;
    let models = case.stages[0].models(&sizes);
    work.prepare(&case.domain, &models, &sizes);
    let histories = std::mem::take(&mut start.histories);
    time_step::begin(state, &case.domain, &models, work, histories, true, ranks)?;
    let begin = Instant::now();
    let mut steps = 0;
    // The pace of rank 0 decides for all: a collective look every few steps.
    while !ranks.any(ranks.is_root() && begin.elapsed() > TRIAL) {
        for _ in 0..10 {
            time_step::advance(state, &case.domain, &models, work, ranks)?;
        }
        steps += 10;
    }
    Ok(begin.elapsed().as_secs_f64() / f64::from(steps.max(1)))
}
