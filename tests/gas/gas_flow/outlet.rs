//! Gas that comes back through an outlet: it was at rest outside.

use super::driver::{FREE_SLIP, OUTLET, PERIODIC, Problem, inlet, no_slip};
use nalgebra::Vector3;
use talcum::gas::volume_averaged::{Boundary, Profile};

/// Pressure in the lower of two outlets; that in the upper is 0.
const HIGH: f64 = 0.5;
const STEP: f64 = 5.0e-3;

/// Largest deviation until the time 6 from u = U tanh(U t / (2 L)), U^2 = 2 p / rho = 1, in a duct of length L = 1
/// between outlets, without viscosity: gas is drawn in from rest, so that rho L du/dt = p - rho u^2 / 2 (Bernoulli's
/// law with the inertia of the duct). `planted` is the part of its momentum with which it is let in none the less.
fn deviation_from_bernoulli(planted: f64) -> f64 {
    let cells = 20;
    let ends = [Boundary::Outlet { pressure: HIGH }, OUTLET];
    let mut problem = Problem::new([0.3, 0.1, 1.0], [3, 1, cells], [FREE_SLIP, PERIODIC, ends]);
    problem.gas.viscosity = 0.0;
    let mut flow = problem.start();
    flow.complete();
    let mut largest = 0.0_f64;
    for _ in 0..(6.0 / STEP) as usize {
        let u = flow.state.velocity[2].at([1, 0, 0]);
        let given = planted * u * u * cells as f64;
        let entrance = |[_, _, z]: [f64; 3]| if z == 0.0 { given } else { 0.0 };
        let source = [0, 1, 2]
            .map(|axis| flow.field(Some(axis), |x| if axis == 2 { entrance(x) } else { 0.0 }));
        flow.driven_step(STEP, Vector3::zeros(), Some(&source)).unwrap();
        let found = flow.state.velocity[2].at([1, 0, 10]);
        largest = largest.max((found - (0.5 * flow.time).tanh()).abs());
    }
    largest
}

#[test]
fn gas_that_is_drawn_in_through_an_outlet_obeys_bernoulli() {
    let found = deviation_from_bernoulli(0.0);
    println!("Bernoulli: {found:e}");
    // Exact in space; in time of second order, (dt U / h)^2 / 8.
    assert!(found < 1.0e-3, "{found}");
    // Controls: gas that brings its momentum along speeds up for ever, u = t / 2; a tenth of it is seen.
    assert!(deviation_from_bernoulli(1.0) > 1.5);
    assert!(deviation_from_bernoulli(0.1) > 0.02);
}

#[test]
fn gas_that_comes_back_through_an_outlet_does_no_harm() {
    // A strong jet against one wall of a short box: a vortex stands in the outlet.
    let jet = Profile::Table((0..12).map(|i| if i < 3 { 4.0 } else { 0.0 }).collect());
    let ends = [inlet(1.0, jet), OUTLET];
    let mut flow = Problem::new([1.0, 0.2, 1.0], [12, 1, 12], [no_slip(), PERIODIC, ends]).start();
    flow.gas.viscosity = 2.0e-3;
    flow.complete();
    let (mut came_back, mut fastest) = (false, 0.0_f64);
    for _ in 0..1500 {
        flow.step(4.0e-3).unwrap();
        let out = (0..12).map(|i| flow.state.velocity[2].at([i, 0, 12]));
        came_back |= out.clone().any(|w| w < -0.01);
        fastest =
            flow.state.velocity.iter().flat_map(|u| u.owned()).fold(fastest, |a, b| a.max(b.abs()));
    }
    assert!(came_back);
    assert!(fastest < 8.0, "{fastest}");
}
