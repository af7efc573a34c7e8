//! The Gresho vortex (MFiX's FLD04): an inviscid gas that rotates in a circle, carried along by a uniform stream.

use super::driver::{Flow, PERIODIC, Problem, orders};

const STREAM: f64 = 1.0;
/// The stream passes the box once, and the vortex turns by 0.8 of a circle.
const END: f64 = 1.0;

/// Tangential velocity at a distance from the axis: it rises to 1 at 0.2 and falls to 0 at 0.4.
fn swirl(r: f64) -> f64 {
    if r < 0.2 { 5.0 * r } else { (2.0 - 5.0 * r).max(0.0) }
}

/// Pressure that holds the gas on its circles.
fn pressure([x, _, z]: [f64; 3]) -> f64 {
    let r = (x - 0.5).hypot(z - 0.5);
    let outer = |r: f64| 12.5 * r * r - 20.0 * r + 4.0 * (5.0 * r).ln();
    match r {
        r if r < 0.2 => 12.5 * r * r,
        r => outer(r.min(0.4)) - outer(0.2) + 0.5,
    }
}

fn velocity([x, _, z]: [f64; 3]) -> [f64; 3] {
    let (x, z) = (x - 0.5, z - 0.5);
    let r = x.hypot(z);
    let over_r = if r > 0.0 { swirl(r) / r } else { 5.0 };
    [STREAM - over_r * z, 0.0, over_r * x]
}

/// On n^2 cells; with a viscosity in the place of none.
fn carried(n: usize, viscosity: f64) -> Flow<'static> {
    let mut problem = Problem::new([1.0; 3], [n, 1, n], [PERIODIC, PERIODIC, PERIODIC]);
    problem.gas.viscosity = viscosity;
    let mut flow = problem.start();
    flow.set(velocity, pressure, |_| 1.0);
    // Steps of an eighth of a cell at twice the stream, so that errors are those of space.
    let steps = 8 * n;
    for _ in 0..steps {
        flow.step(END / steps as f64).unwrap();
    }
    flow
}

/// Root mean square error of the two components, over the largest swirl.
fn error(flow: &Flow) -> f64 {
    [0, 2].map(|axis| flow.velocity_error(axis, |x| velocity(x)[axis])).iter().sum::<f64>() / 2.0
}

/// Mean square of the swirl over the box.
fn energy(flow: &Flow) -> f64 {
    let squares = |axis: usize, mean: f64| {
        let field = &flow.state.velocity[axis];
        let count = field.owned().count() as f64;
        field.owned().map(|u| (u - mean) * (u - mean)).sum::<f64>() / count
    };
    squares(0, STREAM) + squares(2, 0.0)
}

#[test]
fn fld04_a_vortex_is_carried_along() {
    let counts = [32, 64, 128];
    let start = |n: usize| {
        let mut flow = Problem::new([1.0; 3], [n, 1, n], [PERIODIC, PERIODIC, PERIODIC]).start();
        flow.set(velocity, pressure, |_| 1.0);
        energy(&flow)
    };
    let flows = counts.map(|n| carried(n, 0.0));
    let errors = flows.each_ref().map(error);
    let kept = [0, 1, 2].map(|i| energy(&flows[i]) / start(counts[i]));
    let observed = orders(&counts, &errors);
    println!("Gresho: errors {errors:.5?}, orders {observed:.3?}, energy kept {kept:.4?}");
    // The vortex has kinks, where no method has more than 3/2 in the mean square; limiters, which smooth them too, come near it from 1 upwards.
    assert!(observed.iter().all(|order| *order > 1.0) && observed[1] > observed[0], "{observed:?}");
    // Of the swirl's energy limiters take the rest.
    assert!(kept[1] > 0.95 && kept[2] > 0.985 && kept.iter().all(|kept| *kept <= 1.0), "{kept:?}");
    // Control: a viscosity of 1e-3 of swirl times radius.
    let viscous = carried(64, 2.0e-4);
    let lost = energy(&viscous) / start(64);
    assert!(error(&viscous) > 1.2 * errors[1] && lost < kept[1] - 0.01, "{lost}");
}
