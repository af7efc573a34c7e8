//! A bed of fixed spheres, compared with Ergun's equation.

use super::gas_on_cells;
use crate::beds::{Bench, OPEN, PERIODIC, law};
use std::f64::consts::PI;
use talcum::gas::{DragLaw, DragShare, Ergun};

const DIAMETER: f64 = 1.0e-3;
const VISCOSITY: f64 = 1.8e-5;
const DENSITY: f64 = 1.2;

/// Pressure gradient in a bed of this voidage that fills the box, from fields.
fn gradient(voidage: f64, velocity: f64, law_of_drag: DragLaw) -> f64 {
    gradient_in(&[DIAMETER], voidage, velocity, (law_of_drag, DragShare::default()))
}

/// The same with spheres of these sizes in turn.
fn gradient_in(
    diameters: &[f64],
    voidage: f64,
    velocity: f64,
    law_of_drag: (DragLaw, DragShare),
) -> f64 {
    gradient_of(diameters, voidage, velocity, law_of_drag, false)
}

/// The same with the drag of the undisturbed gas, or not.
fn gradient_of(
    diameters: &[f64],
    voidage: f64,
    velocity: f64,
    (law_of_drag, share): (DragLaw, DragShare),
    undisturbed: bool,
) -> f64 {
    // A cubic lattice, spheres overlapping a little: so heavy that nothing moves.
    let cube = diameters.iter().map(|d| d.powi(3)).sum::<f64>() / diameters.len() as f64;
    let spacing = (PI / 6.0 * cube / (1.0 - voidage)).cbrt();
    let lengths = [8.0 * spacing, 8.0 * spacing, 32.0 * spacing];
    let mut bench = Bench::new(lengths, [PERIODIC, PERIODIC, OPEN]);
    bench.contact = law(1.0e9 * diameters[0] * diameters[0], 0.9, 0.1);
    bench.density = 1.0e9;
    bench.skin = Some(0.1 * diameters[0]);
    bench.time_step = 1.0e-5;
    bench.add_layers(2048, (spacing * (1.0 - 1.0e-9), 0.5 * spacing), diameters, (0.0, 0.0));
    let mut model = gas_on_cells(&bench, [2, 2, 8], (DENSITY, VISCOSITY), law_of_drag, velocity);
    model.coupling.drag.share = share;
    model.coupling.undisturbed = undisturbed;
    bench.volume_averaged = Some(model);
    let mut run = bench.alone();
    run.steps(100);
    let pressure = &run.state.gas.volume_averaged().unwrap().fields.pressure;
    (pressure.at([0, 0, 0]) - pressure.at([0, 0, 7])) / (28.0 * spacing)
}

#[test]
fn ergun_in_air() {
    let ergun = DragLaw::Ergun(Ergun);
    for [voidage, velocity, expected] in
        [[0.40, 0.1, 1715.625], [0.40, 0.5, 12515.625], [0.45, 0.5, 7650.206]]
    {
        let found = gradient(voidage, velocity, ergun.clone());
        println!("Ergun: {found:.3} Pa/m for {expected}");
        // Drag is that of the last step's slip, which no longer changes; the pressure is solved to 1e-8.
        assert!((found / expected - 1.0).abs() < 0.001, "{found} for {expected}");
    }
    // Negative control: Wen & Yu's law gives another one.
    assert!((gradient(0.40, 0.1, DragLaw::WEN_YU) / 1715.625 - 1.0).abs() > 0.01);
}

/// A powder of Geldart's group A, slowly: the inertial term is 1e-4 of the whole.
#[test]
fn ergun_in_a_fine_powder() {
    let drop = |diameter: f64| {
        gradient_in(&[diameter], 0.42, 0.01, (DragLaw::Ergun(Ergun), DragShare::default()))
    };
    let found = drop(4.0e-5);
    println!("Ergun, 40 um: {found:.1} Pa/m for 76662.8");
    // As above.
    assert!((found / 76_662.8 - 1.0).abs() < 0.001, "{found}");
    // Negative control: a diameter 1 % off.
    assert!((drop(4.04e-5) / 76_662.8 - 1.0).abs() > 0.01);
}

#[test]
fn a_packed_bed_of_two_sizes_has_the_drop_of_its_sauter_diameter() {
    let (a, b) = (1.2e-3_f64, 0.8e-3_f64);
    let mean = (a.powi(3) + b.powi(3)) / (a.powi(2) + b.powi(2));
    let (voidage, velocity) = (0.42_f64, 0.3);
    let phi = 1.0 - voidage;
    let expected = 150.0 * VISCOSITY * phi.powi(2) / voidage.powi(3) * velocity / mean.powi(2)
        + 1.75 * DENSITY * phi / voidage.powi(3) * velocity * velocity / mean;
    let found = |share| gradient_in(&[a, b], voidage, velocity, (DragLaw::Ergun(Ergun), share));
    let shared = found(DragShare::Surface);
    println!("Ergun, two sizes: {shared:.3} Pa/m for {expected:.3}");
    // As of one size: the pressure is solved to 1e-8, the slip no longer changes.
    assert!((shared / expected - 1.0).abs() < 0.001, "{shared} for {expected}");
    // The control: each with the drag of a bed of its own size.
    assert!((found(DragShare::Diameter) / expected - 1.0).abs() > 0.01);
}

/// What a particle does to its own gas is no error where all of them do it.
#[test]
fn the_undisturbed_velocity_changes_nothing_in_a_packed_bed() {
    let ergun = (DragLaw::Ergun(Ergun), DragShare::default());
    let [with, without] =
        [true, false].map(|own| gradient_of(&[DIAMETER], 0.45, 0.5, ergun.clone(), own));
    println!("Ergun: {with:.3} Pa/m undisturbed, {without:.3} Pa/m as seen");
    // S = 0.01 of a share of some per cent, and as much of the particle's own volume.
    assert!((with / without - 1.0).abs() < 0.005, "{with} for {without}");
    assert!(with != without); // a control: it acts
}
