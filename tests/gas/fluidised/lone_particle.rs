//! A lone sphere in cells not much larger than it: its drag must not be affected by the gas that it drags along.

use super::gas_on_cells;
use crate::beds::{Bench, PERIODIC, law};
use talcum::domain::Face;
use talcum::gas::DragLaw;

const DENSITY: f64 = 2000.0;
const VISCOSITY: f64 = 1.8e-5;
const GAS_DENSITY: f64 = 1.2;
/// Reference velocities of spheres of 100 and 40 um in air by Schiller & Naumann's drag: 3 pi mu d (1 + 0.15 Re^0.687) U = weight less buoyancy.
const TERMINAL: [(f64, f64); 2] = [(1.0e-4, 0.457_536), (4.0e-5, 0.091_612)];

/// Velocity at which a sphere falls through air over that at which it should; in cells of so many diameters, with a filter of so many. The
/// air rises `rise` times as fast as it should fall, so that it stays where it is.
fn fall(
    (diameter, terminal): (f64, f64),
    [cell, filter]: [f64; 2],
    (undisturbed, rise): (bool, f64),
) -> f64 {
    let spacing = cell * diameter;
    let lengths = [12.0 * spacing, 12.0 * spacing, 28.0 * spacing];
    let mut bench = Bench::new(lengths, [PERIODIC, PERIODIC, [Face::Stop; 2]]);
    bench.contact = law(1.0, 0.9, 0.1);
    bench.gravity.magnitude = 9.81;
    bench.density = DENSITY;
    bench.skin = Some(0.15 * diameter);
    // Six gas steps while the gas passes a cell, and a quarter of the time of viscosity across it.
    let viscous = GAS_DENSITY * spacing * spacing / VISCOSITY / 32.0;
    bench.time_step = (spacing / terminal / 6.0).min(viscous) / 10.0;
    let place = |cells: f64| cells * spacing;
    bench.add([place(6.13), place(5.37), place(20.21)], [0.0; 3], 0.5 * diameter);
    let air = (GAS_DENSITY, VISCOSITY);
    let mut model = gas_on_cells(&bench, [12, 12, 28], air, DragLaw::WEN_YU, rise * terminal);
    model.substeps = 10;
    model.coupling.filter_width = filter * diameter;
    model.coupling.undisturbed = undisturbed;
    bench.volume_averaged = Some(model);
    let mut run = bench.alone();
    // Four relaxation times, of which the last count: it begins with nearly the right slip.
    let relaxation = DENSITY * diameter * diameter / (18.0 * VISCOSITY);
    let steps = (relaxation / bench.time_step) as u64 / 20;
    run.steps(50 * steps);
    let velocities: Vec<f64> = (0..30).map(|_| run.steps(steps).particle(0).velocity[2]).collect();
    rise - velocities.iter().sum::<f64>() / 30.0 / terminal
}

/// Compares the speeds in cells of so many diameters, with a filter of so many, with the law's.
fn compare(cases: &[((f64, f64), [f64; 2], f64)]) {
    for &(of, cells, rise) in cases {
        let with = fall(of, cells, (true, 1.0));
        let without = fall(of, cells, (false, rise));
        println!("{of:?} {cells:?}: {with:.4}, without the correction {without:.4}");
        // Oseen's flow is that of a slow disturbance, and the mobility a mean over places in a cell.
        assert!((with - 1.0).abs() < 0.02, "{with}");
        // Control.
        assert!(without > 1.015 && (without - 1.0).abs() > 3.0 * (with - 1.0).abs(), "{without}");
    }
}

#[test]
fn a_sphere_falls_as_fast_as_its_drag_law_says() {
    compare(&[(TERMINAL[0], [1.5, 4.0], 1.025), (TERMINAL[1], [1.5, 0.0], 1.27)]);
}

#[test]
#[ignore = "a minute; its rows are in docs/verification.md"]
fn a_sphere_falls_as_fast_as_its_drag_law_says_in_wider_cells() {
    compare(&[
        (TERMINAL[0], [6.0, 0.0], 1.02),
        (TERMINAL[0], [3.0, 0.0], 1.065),
        (TERMINAL[1], [3.0, 0.0], 1.15),
        (TERMINAL[1], [2.0, 0.0], 1.22),
    ]);
}
