//! What acts in a stage, in numbers that a user knows.

use super::adhesion::describe_adhesion;
use super::lines::Lines;
use crate::case::{Case, Stage};
use crate::contact::{ContactForceLaw, ContactLaw, VanDerWaals};
use crate::gas::volume_averaged::VolumeAveragedModel;
use crate::gas::{ColumnGas, Drive, GasModel};
use crate::rules::{
    ContactPartner, LARGEST_STEP_NUMBER, LEAST_STEPS_PER_CONTACT, ReducedBody, courant_rate,
    drag_response, hamaker_constant_per_bond_number, step_number, stokes_number, viscous_rate,
};
use crate::state::SizeRange;
use std::fmt::Write;

/// Overlap over diameter at which stiffness is told.
const SMALL_OVERLAP: f64 = 0.01;
/// Voidage of a loose bed, at which the response of particles to the gas is told.
const LOOSE: f64 = 0.45;
/// Solids fractions of settled beds, at which the minimum fluidisation velocity is told.
const SETTLED: [f64; 3] = [0.60, 0.62, 0.64];
/// Cells of fewer diameters need a filter; a little less than 3 for the rounding of lengths.
const CELL_OVER_DIAMETER: f64 = 2.999;

/// The particle that dimensionless numbers refer to.
struct ReferenceParticle {
    diameter: f64,
    density: f64,
    mass: f64,
    gravity: f64,
}

impl ReferenceParticle {
    fn of(case: &Case, stage: &Stage) -> Self {
        let diameter = case.particles.reference_diameter;
        let mass = case.particles.mass_of(diameter);
        let gravity = stage.physics.gravity.magnitude;
        Self { diameter, density: case.particles.density, mass, gravity }
    }

    fn weight(&self) -> f64 {
        self.mass * self.gravity
    }
}

/// Appends what is to be known of a stage for particles of these sizes.
pub(super) fn describe(message: &mut String, case: &Case, stage: &Stage, sizes: &SizeRange) {
    let _ = writeln!(message, "stage \"{}\":", stage.name);
    let lines = &mut Lines(message);
    let particle = ReferenceParticle::of(case, stage);
    if particle.gravity > 0.0 {
        describe_forces_over_weight(lines, stage, &particle);
    }
    if let Some(vibration) = &stage.physics.gravity.vibration {
        let gamma = vibration.relative_acceleration;
        lines.add("Gamma, frequency", &format!("{gamma:.4}, {:.4}", vibration.frequency));
    }
    match &stage.physics.gas {
        GasModel::None => {}
        GasModel::Column(gas) => describe_column(lines, gas, &particle),
        GasModel::VolumeAveraged(model) => {
            describe_volume_averaged(lines, model, &particle, stage.physics.time_step);
        }
    }
    describe_fluidisation(lines, case, stage);
    describe_contacts(lines, case, stage, sizes);
    describe_adhesion(lines, case, stage);
}

fn describe_forces_over_weight(lines: &mut Lines, stage: &Stage, particle: &ReferenceParticle) {
    let (diameter, radius) = (particle.diameter, 0.5 * particle.diameter);
    let pair = ReducedBody::of_equal_spheres(particle.mass, radius);
    let stiffness = stage.physics.contact.law.stiffness(SMALL_OVERLAP * diameter, pair.radius);
    let scaled = stiffness / (particle.density * particle.gravity * diameter * diameter);
    lines.add("k_n / (rho_s g d^2)", &format!("{scaled:.4e}"));
    if let Some(cohesion) = &stage.physics.cohesion {
        let [pair, wall] = bond_numbers(cohesion, particle);
        lines.add("Bond number, particles and walls", &format!("{pair:.4}, {wall:.4}"));
    }
}

/// The largest Bond numbers of a stage: of two particles, and of a particle and a wall.
fn bond_numbers(cohesion: &VanDerWaals, particle: &ReferenceParticle) -> [f64; 2] {
    let (diameter, weight) = (particle.diameter, particle.weight());
    [
        (ContactPartner::Particle, &cohesion.hamaker_constant),
        (ContactPartner::Wall, &cohesion.wall_hamaker_constant),
    ]
    .map(|(partner, constant)| {
        let unit = hamaker_constant_per_bond_number(partner, cohesion.cut_off, diameter, weight);
        let roughness = cohesion.expression.roughness_factor(0.5 * diameter, cohesion.cut_off);
        constant.largest() * roughness / unit
    })
}

/// How long contacts of the smallest particles last: with each other, and with walls that are otherwise.
fn describe_contacts(lines: &mut Lines, case: &Case, stage: &Stage, sizes: &SizeRange) {
    let mass = case.particles.mass_of(sizes.smallest_diameter);
    let radius = 0.5 * sizes.smallest_diameter;
    let mut tell = |name: &str, law: &ContactLaw, bodies: ReducedBody| {
        let duration = law.contact_duration(bodies.mass, bodies.radius);
        let steps = duration / stage.physics.time_step;
        lines.add(name, &format!("{duration:.4e}, {steps:.1} time steps ({})", law.name()));
    };
    let pair = ReducedBody::of_equal_spheres(mass, radius);
    tell("duration of a contact", &stage.physics.contact.law, pair);
    for (wall, contact) in case.domain.walls.iter().zip(&stage.physics.at_walls) {
        if *contact != stage.physics.contact {
            let bodies = ReducedBody::of_sphere_and_wall(mass, radius);
            tell(&format!("with wall \"{}\"", wall.name), &contact.law, bodies);
        }
    }
    if case.shortest_contact(stage, sizes) / stage.physics.time_step < LEAST_STEPS_PER_CONTACT {
        lines.add(
            "warning",
            &format!("fewer than {LEAST_STEPS_PER_CONTACT} steps per contact: shorten time.step"),
        );
    }
}

fn describe_column(lines: &mut Lines, gas: &ColumnGas, particle: &ReferenceParticle) {
    let drive = match &gas.drive {
        Drive::Velocity(schedule) => {
            format!("superficial velocity up to {:.6e}", schedule.largest())
        }
        Drive::Plenum(plenum) => {
            format!("flow into the plenum up to {:.6e}", plenum.supply.largest())
        }
        Drive::Weight(_) => "carries the weight of the bed".to_owned(),
    };
    lines.add("gas", &drive);
    if let Some(pressure) = gas.ambient_pressure {
        let speed = (pressure / (particle.density * (1.0 - LOOSE) * LOOSE)).sqrt();
        lines.add("speed of sound in the bed", &format!("{speed:.4e} at a voidage of {LOOSE}"));
    }
    lines.add("grid spacing over diameter", &format!("{:.4}", gas.spacing / particle.diameter));
    if particle.gravity > 0.0 {
        let ReferenceParticle { density, gravity, diameter, .. } = *particle;
        let stokes = stokes_number(gas.viscosity, density, gravity, diameter);
        lines.add("Stokes number", &format!("{stokes:.4}"));
    }
}

/// Cells, and how the gas step compares with what limits it.
fn describe_volume_averaged(
    lines: &mut Lines,
    model: &VolumeAveragedModel,
    particle: &ReferenceParticle,
    time_step: f64,
) {
    let [nx, ny, nz] = model.grid.counts();
    let in_diameters = model.grid.spacing() / particle.diameter;
    let [x, y, z]: [f64; 3] = in_diameters.into();
    let cells = format!("{nx} x {ny} x {nz} of {x:.3} x {y:.3} x {z:.3} of the diameter");
    lines.add("gas, cells", &cells);
    let unfiltered = model.coupling.filter_width < 3.0 * particle.diameter;
    if in_diameters.min() < CELL_OVER_DIAMETER && unfiltered {
        let advice = "cells are below 3 diameters: gas.filter_width of 3 to 6 diameters is advised";
        lines.add("warning", advice);
    }
    let step = time_step * model.substeps as f64;
    lines.add("gas step", &format!("{step:.4e}, {} time steps", model.substeps));
    describe_gas_step(lines, model, step);
    let speed = inflow(model).map(|[_, velocity]| velocity).fold(0.0, f64::max) / LOOSE;
    let drag = model.coupling.drag.per_velocity(particle.diameter, 1.0 - LOOSE, speed * LOOSE);
    let response = drag_response(drag, step, particle.mass, LOOSE);
    let response = format!("{response:.4} at a voidage of {LOOSE}; may not exceed 1");
    lines.add("b dt / (m eps^2)", &response);
}

/// Cell size along the axis of each inlet, and the largest superficial velocity there.
fn inflow(model: &VolumeAveragedModel) -> impl Iterator<Item = [f64; 2]> {
    let spacing = model.grid.spacing();
    let inlets = model.gas.inlets();
    inlets.map(move |(face, inlet)| [spacing[face.axis], inlet.velocity.largest().abs()])
}

/// Courant and viscous number of a gas step, as the gas solver takes them.
fn describe_gas_step(lines: &mut Lines, model: &VolumeAveragedModel, step: f64) {
    let rate = |[size, velocity]: [f64; 2]| courant_rate([velocity / LOOSE, 0.0, 0.0], [size; 3]);
    let courant = step * inflow(model).map(rate).fold(0.0, f64::max);
    let courant_line = format!("{courant:.4} (gas in a bed of voidage {LOOSE})");
    lines.add("Courant number of the inflow", &courant_line);
    let viscous = |voidage_ratio: f64| {
        let varies = [0, 1, 2].map(|a| !model.grid.is_periodic(a) || model.grid.counts()[a] > 1);
        let (gas, cell_size) = (&model.gas, model.grid.spacing().into());
        step * viscous_rate(gas.viscosity, gas.density, voidage_ratio, cell_size, varies)
    };
    let (uniform, largest) = (viscous(1.0), viscous(1.0 / model.coupling.least_voidage));
    let viscous_line = format!(
        "{uniform:.4} in a uniform bed, up to {largest:.4} beside empty cells; 2 Courant + viscous / 2 may not exceed 1"
    );
    lines.add("viscous number", &viscous_line);
    if step_number(courant, uniform) > LARGEST_STEP_NUMBER {
        let advice = "the gas step is too long, the run would stop: use fewer gas.substeps or a shorter time.step";
        lines.add("warning", advice);
    }
}

fn describe_fluidisation(lines: &mut Lines, case: &Case, stage: &Stage) {
    let velocity = |phi: f64| {
        let velocity = case.minimum_fluidisation(stage, phi)?;
        Some(format!("{velocity:.4e} at phi {phi:.2}"))
    };
    let velocities: Vec<String> = SETTLED.into_iter().filter_map(velocity).collect();
    if !velocities.is_empty() {
        lines.add("U_mf of the force balance", &velocities.join(", "));
    }
}
