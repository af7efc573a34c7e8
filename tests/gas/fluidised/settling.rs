//! MFiX's DEM06: a sphere of 100 um and 2000 kg/m^3 in air that rises at 0.4 m/s.

use super::gas_on_cells;
use crate::beds::{Bench, OPEN, PERIODIC, law};
use talcum::gas::DragLaw;

const DIAMETER: f64 = 1.0e-4;
const DENSITY: f64 = 2000.0;
const VISCOSITY: f64 = 1.8e-5;
const GAS_DENSITY: f64 = 1.2;
const INFLOW: f64 = 0.4;

/// Velocities at each 0.05 s up to 0.35 s; the sphere begins with the gas.
fn velocities(drag: DragLaw) -> Vec<f64> {
    // Cells of 100 diameters: what the sphere does to the gas around it is spread over 1e6 of its volumes.
    let mut bench = Bench::new([0.04, 0.04, 0.12], [PERIODIC, PERIODIC, OPEN]);
    bench.contact = law(10.0, 0.9, 0.1);
    bench.gravity.magnitude = 9.81;
    bench.density = DENSITY;
    bench.skin = Some(0.15 * DIAMETER);
    bench.time_step = 1.0e-5;
    bench.add([0.02, 0.02, 0.06], [0.0, 0.0, INFLOW], 0.5 * DIAMETER);
    let mut model = gas_on_cells(&bench, [4, 4, 12], (GAS_DENSITY, VISCOSITY), drag, INFLOW);
    model.substeps = 40;
    bench.volume_averaged = Some(model);
    let mut run = bench.alone();
    (0..7).map(|_| run.steps(5000).particle(0).velocity[2]).collect()
}

/// The same from the equation of motion with Schiller & Naumann's drag, by the classical Runge-Kutta method.
fn reference() -> Vec<f64> {
    let rate = |v: f64| {
        let slip: f64 = INFLOW - v;
        let reynolds = GAS_DENSITY * DIAMETER * slip.abs() / VISCOSITY;
        let drag = 18.0 * VISCOSITY / (DENSITY * DIAMETER * DIAMETER);
        let buoyant = 9.81 * (1.0 - GAS_DENSITY / DENSITY);
        drag * (1.0 + 0.15 * reynolds.powf(0.687)) * slip - buoyant
    };
    let (mut v, dt) = (INFLOW, 1.0e-4);
    let mut found = Vec::new();
    for step in 1..=3500 {
        let first = rate(v);
        let second = rate(v + 0.5 * dt * first);
        let third = rate(v + 0.5 * dt * second);
        v += dt / 6.0 * (first + 2.0 * (second + third) + rate(v + dt * third));
        if step % 500 == 0 {
            found.push(v);
        }
    }
    found
}

#[test]
fn dem06_in_a_gas_of_three_dimensions() {
    let (found, expected) = (velocities(DragLaw::WEN_YU), reference());
    let slip = |velocity: &f64| INFLOW - velocity;
    let errors: Vec<f64> =
        found.iter().zip(&expected).map(|(v, w)| slip(v) / slip(w) - 1.0).collect();
    println!("DEM06: slip {:.5} (published 0.45754), errors {errors:.1?}", slip(&found[6]));
    // The force holds for a gas step, 0.8 % of the relaxation time, so that the slip is behind by half of that at most,
    // and less and less as it settles. The gas around the sphere sinks with it by the weight over the
    // momentum that passes its cells, 1e-8 N / (1.2 x 0.4 x 1e-4 N s/m) = 2e-4 m/s, 0.05 % of the slip.
    assert!((slip(&found[6]) / 0.45754 - 1.0).abs() < 0.005);
    assert!(errors.iter().all(|error| error.abs() < 0.005), "{errors:?}");
    // Negative control: Stokes' drag.
    assert!((slip(&velocities(DragLaw::WEN_YU_CREEPING)[6]) / 0.45754 - 1.0).abs() > 0.2);
}
