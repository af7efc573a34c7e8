//! The models of a stage in familiar numbers.

use super::adhesion::describe_adhesion;
use super::gas::{describe_gas, inflow};
use super::lines::Lines;
use super::particle::ReferenceParticle;
use super::partners::Partners;
use std::f64::consts::PI;
use std::fmt::Write;
use talcum_engine::contact::{ContactForceLaw, ContactLaw, VanDerWaals};
use talcum_engine::domain::Vibration;
use talcum_engine::fields::Unit;
use talcum_engine::gas::volume_averaged::VolumeAveragedModel;
use talcum_engine::gas::{ColumnGas, Drive, GasModel};
use talcum_engine::rules::{
    ContactPartner, LARGEST_STEP_NUMBER, LEAST_STEPS_PER_CONTACT, ReducedBody, courant_rate,
    drag_response, hamaker_constant_per_bond_number, step_number, viscous_rate,
};
use talcum_engine::state::SizeRange;
use talcum_results::output::ColumnUnits;
use talcum_runs::case::{Case, Stage};

/// The jump of the effective gravity, over g, that is accepted without a warning: rounding of the stages' times.
const SMALL_JUMP: f64 = 1.0e-3;
/// Overlap over diameter at which stiffness is printed.
const SMALL_OVERLAP: f64 = 0.01;
/// Voidage of a loose bed for which the response of particles to the gas is printed.
const LOOSE: f64 = 0.45;
/// Size of cells, in diameters, above which they hide small bubbles and clusters, whose drag is not that of a uniform
/// bed.
const COARSE_CELL: f64 = 10.0;
/// Size of cells of `gas.local_voidage`, in diameters, below which a warning is printed; boxes of beds seldom fit 1.5
/// exactly.
const LEAST_LOCAL_CELL: f64 = 1.4;
/// Size of cells, in diameters, below which they need a filter; slightly less than 3 because of the rounding of
/// lengths.
const CELL_OVER_DIAMETER: f64 = 2.999;

/// Appends the description of a stage, by its number, for particles of these sizes.
pub(super) fn describe(message: &mut String, case: &Case, number: usize, sizes: &SizeRange) {
    let stage = &case.stages[number];
    let _ = writeln!(message, "stage \"{}\":", stage.name);
    let lines = &mut Lines(message);
    let particle = ReferenceParticle::of(case, stage);
    if particle.gravity > 0.0 {
        describe_forces_over_weight(lines, stage, &particle);
    }
    if let Some(vibration) = &stage.physics.gravity.vibration {
        describe_vibration(lines, case, number, vibration);
    }
    match &stage.physics.gas {
        GasModel::None => {}
        GasModel::Column(gas) => describe_column(lines, gas, &particle),
        GasModel::VolumeAveraged(model) => {
            describe_cells(lines, model, sizes);
            describe_volume_averaged(lines, model, &particle, stage.physics.time_step);
        }
    }
    describe_gas(lines, case, stage, &particle, sizes);
    describe_contacts(lines, case, stage, sizes);
    describe_adhesion(lines, case, stage);
}

/// Describes intensity and frequency; a vibration that is switched on in the middle of a cycle throws the bed.
fn describe_vibration(lines: &mut Lines, case: &Case, number: usize, vibration: &Vibration) {
    let Vibration { relative_acceleration: gamma, frequency, start } = *vibration;
    lines.add("Gamma, frequency", &format!("{gamma:.4}, {frequency:.4}"));
    let before = number.checked_sub(1).map(|before| &case.stages[before].physics.gravity);
    let was_on = before.is_some_and(|gravity| gravity.vibration.is_some());
    let cycles = (case.stages[number].start - start) * frequency;
    let phase = cycles - cycles.floor();
    let jump = gamma * (2.0 * PI * phase).sin();
    if !was_on && jump.abs() > SMALL_JUMP {
        lines.warn(&format!(
            "the vibration begins at phase {phase:.3} of a cycle, so that the effective gravity jumps to {:.3} g: let the stages \
             before it take whole cycles",
            1.0 + jump
        ));
    }
}

fn describe_forces_over_weight(lines: &mut Lines, stage: &Stage, particle: &ReferenceParticle) {
    let (diameter, radius) = (particle.diameter, 0.5 * particle.diameter);
    let pair = ReducedBody::of_equal_spheres(particle.mass, radius);
    let stiffness =
        stage.physics.contact.first().law.stiffness(SMALL_OVERLAP * diameter, pair.radius);
    let scaled = stiffness / (particle.density * particle.gravity * diameter * diameter);
    lines.add("k_n / (rho_s g d^2)", &format!("{scaled:.4e}"));
    let attractions = stage.physics.attractions();
    if let [cohesion, others @ ..] = attractions {
        let [pair, wall] = bond_numbers(cohesion, particle);
        lines.add("Bond number, particles and walls", &format!("{pair:.4}, {wall:.4}"));
        let numbers = others.iter().map(|cohesion| bond_numbers(cohesion, particle));
        let [pair, wall] = numbers.fold([pair, wall], |[pair, wall], [other, at_wall]| {
            [pair.max(other), wall.max(at_wall)]
        });
        if !others.is_empty() {
            lines.add("largest of all species", &format!("{pair:.4}, {wall:.4}"));
        }
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

/// Describes the duration of contacts of the lightest particles of each species: with each other, and with walls that
/// have another law.
fn describe_contacts(lines: &mut Lines, case: &Case, stage: &Stage, sizes: &SizeRange) {
    let unit = ColumnUnits::of_system(case.units.name()).of(Unit::Time);
    let mut describe = |name: &str, law: &ContactLaw, bodies: ReducedBody| {
        let duration = law.contact_duration(bodies.mass, bodies.radius);
        let steps = duration / stage.physics.time_step;
        lines.add(name, &format!("{duration:.4e} {unit}, {steps:.1} time steps ({})", law.name()));
    };
    for Partners { name, contact, wall, species, .. } in Partners::of_stage(case, stage) {
        match wall {
            None => {
                let bodies = case.lightest_pair(species, sizes);
                describe(&format!("duration of a contact{name}"), &contact.law, bodies);
            }
            Some(_) if stage.physics.contact.values().contains(contact) => {}
            Some(_) => {
                let bodies = case.lightest_at_wall(species[0], sizes);
                describe(&format!("duration{name}"), &contact.law, bodies);
            }
        }
    }
    if case.shortest_contact(stage, sizes) / stage.physics.time_step < LEAST_STEPS_PER_CONTACT {
        lines.warn(&format!(
            "fewer than {LEAST_STEPS_PER_CONTACT} steps per contact: shorten time.step"
        ));
    }
}

fn describe_column(lines: &mut Lines, gas: &ColumnGas, particle: &ReferenceParticle) {
    match &gas.drive {
        Drive::Velocity(_) => {}
        Drive::Plenum(_) => lines.add("gas", "out of a plenum"),
        Drive::Weight(_) => lines.add("gas", "carries the weight of the bed"),
    }
    if let Some(pressure) = gas.ambient_pressure {
        let speed = (pressure / (particle.density * (1.0 - LOOSE) * LOOSE)).sqrt();
        lines.add("speed of sound in the bed", &format!("{speed:.4e} at a voidage of {LOOSE}"));
    }
    lines.add("grid spacing over diameter", &format!("{:.4}", gas.spacing / particle.diameter));
}

/// Describes the size of cells relative to the largest particles.
fn describe_cells(lines: &mut Lines, model: &VolumeAveragedModel, sizes: &SizeRange) {
    let [nx, ny, nz] = model.grid.counts();
    let in_diameters = model.grid.spacing() / sizes.largest_diameter;
    let [x, y, z]: [f64; 3] = in_diameters.into();
    lines.add(
        "gas, cells",
        &format!("{nx} x {ny} x {nz} of {x:.3} x {y:.3} x {z:.3} of the largest diameter"),
    );
    if let Some(column) = &model.column {
        let across = 2.0 * column.radius() / sizes.largest_diameter;
        lines.add(
            "gas, round column",
            &format!(
                "{across:.3} of the largest diameter wide, {:.1} of {} cells across",
                column.cross_section_in_cells(),
                nx * ny
            ),
        );
    }
    let unfiltered = model.coupling.filter_width < 3.0 * sizes.largest_diameter;
    if in_diameters.min() < CELL_OVER_DIAMETER && unfiltered {
        lines.warn(
            "cells are below 3 diameters: gas.filter_width of 3 to 6 diameters is advised (without it the gas in a suspension that \
             drifts through cells of 1.5 diameters swings by some 10 to 20 % of its slip, with 6 diameters by 2 %), except in a dense \
             bed whose bubbles are a few diameters wide",
        );
        if model.coupling.undisturbed {
            lines.warn("gas.undisturbed_velocity: on such cells without a filter a lone particle falls up to 10 % too fast");
        }
    }
    let finest = (model.finest_cells().spacing() / sizes.largest_diameter).min();
    if model.coupling.local_voidage.is_some() && finest < LEAST_LOCAL_CELL {
        lines.warn(&format!(
            "the cells of gas.local_voidage are {finest:.2} of the largest diameter wide: below 1.5 they see single layers, which \
             raises the drag of a packed bed (by 4 % at 1)"
        ));
    }
    if in_diameters.max() > COARSE_CELL {
        lines.warn(&format!(
            "cells are wider than {COARSE_CELL} diameters: the drag laws assume a bed that is uniform within a cell, \
             and small bubbles and clusters are not"
        ));
    }
}

/// Compares the gas step with its limits.
fn describe_volume_averaged(
    lines: &mut Lines,
    model: &VolumeAveragedModel,
    particle: &ReferenceParticle,
    time_step: f64,
) {
    let step = time_step * model.substeps as f64;
    let substeps = super::super::report::count_of(model.substeps as usize, "time step");
    lines.add("gas step", &format!("{step:.4e}, {substeps}"));
    describe_gas_step(lines, model, step);
    let speed = inflow(model).map(|[_, velocity]| velocity).fold(0.0, f64::max) / LOOSE;
    let drag = model.coupling.drag.per_velocity(particle.diameter, 1.0 - LOOSE, speed * LOOSE);
    let response = drag_response(drag, step, particle.mass, LOOSE);
    let response = format!("{response:.4} at a voidage of {LOOSE}; may not exceed 1");
    lines.add("b dt / (m eps^2)", &response);
}

/// Describes Courant and viscous number of a gas step, as defined in the gas solver.
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
        lines.warn(
            "the gas step is too long, the run would stop: use fewer gas.substeps or a shorter time.step",
        );
    }
}
