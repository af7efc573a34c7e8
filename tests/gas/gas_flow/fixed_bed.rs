//! Gas through fixed beds: Ergun's pressure drop, and Darcy's law for strong drag.

use super::driver::{FREE_SLIP, Flow, OUTLET, PERIODIC, Problem, inlet};
use nalgebra::Vector3;
use talcum::gas::NavierStokesError;
use talcum::gas::volume_averaged::Profile;

/// beta of Ergun: 150 mu (1 - eps)^2 / (eps d^2) + 1.75 rho (1 - eps) |u - v| / d, per volume, u between particles.
fn ergun(eps: f64, velocity: f64) -> f64 {
    let (d, rho, mu) = (1.0e-3, 1.2, 1.8e-5);
    let phi = 1.0 - eps;
    150.0 * mu * phi * phi / (eps * d * d) + 1.75 * rho * phi * velocity / d
}

/// Pressure drop per length at a superficial velocity of 0.1 m/s through a bed of voidage 0.4 at rest.
fn bed_pressure_drop(steps: usize, beta: impl Fn(f64, f64) -> f64) -> f64 {
    let ends = [inlet(0.1, Profile::Uniform), OUTLET];
    let mut problem = Problem::new([0.01, 0.01, 0.02], [4, 4, 10], [FREE_SLIP, FREE_SLIP, ends]);
    (problem.gas.density, problem.gas.viscosity) = (1.2, 1.8e-5);
    let mut flow = problem.start();
    flow.set(|_| [0.0; 3], |_| 0.0, |_| 0.4);
    for _ in 0..steps {
        let state = flow.state.velocity[2].clone();
        for cell in flow.cells() {
            let [i, j, k] = cell;
            let velocity = 0.5 * (state.at(cell) + state.at([i, j, k + 1]));
            *flow.bed.momentum_transfer.at_mut(cell) = beta(0.4, velocity);
        }
        flow.step(1.0e-3).unwrap();
    }
    (flow.state.pressure.at([1, 1, 1]) - flow.state.pressure.at([1, 1, 8])) / (7.0 * 2.0e-3)
}

#[test]
fn a_fixed_bed_has_the_pressure_drop_of_ergun() {
    let error =
        |beta: &dyn Fn(f64, f64) -> f64| (bed_pressure_drop(40, beta) / 1715.625 - 1.0).abs();
    // Uniform flow: the only error is the tolerance of the pressure equation.
    assert!(error(&ergun) < 1.0e-8);
    // Controls: without the inertial part, or with eps counted once too often.
    assert!(error(&|eps, _| ergun(eps, 0.0)) > 0.1);
    assert!(error(&|eps, velocity| eps * ergun(eps, velocity)) > 0.1);
}

#[test]
fn drag_however_strong_gives_darcys_pressure_drop() {
    for strength in [1.0e3, 1.0e9] {
        // beta dt / rho is some 3e3 and 3e9.
        let error = |wrong: f64| {
            let beta = |eps, velocity| wrong * strength * ergun(eps, velocity);
            (bed_pressure_drop(3, beta) / (strength * 1715.625) - 1.0).abs()
        };
        assert!(error(1.0) < 1.0e-7, "{}", error(1.0));
        assert!(error(1.0001) > 0.9e-4); // control: a drag that is 1e-4 off
    }
}

/// How drag gets into a step.
#[derive(Clone, Copy, PartialEq)]
enum Drag {
    /// Implicitly, as in the gas.
    Implicit,
    /// A planted error: by the velocity at the beginning of the step.
    Lagged,
}

/// Stripes of beds side by side, beta growing tenfold from each to the next, in a periodic box through which a force of
/// 1 per volume drives the gas. Returns the largest deviation from Darcy's u = eps / beta after three steps, over that u.
fn deviation_in_stripes(drag: Drag, strength: f64) -> Result<f64, NavierStokesError> {
    let mut problem = Problem::new([0.4, 0.4, 0.5], [4, 4, 5], [PERIODIC, PERIODIC, PERIODIC]);
    problem.gas.viscosity = 0.0;
    let mut flow = problem.start();
    flow.set(|_| [0.0; 3], |_| 0.0, |_| 0.4);
    let beta = |x: [f64; 3]| strength * 10.0_f64.powf((x[0] / 0.1).floor());
    for _ in 0..3 {
        let lagged = explicit_drag(&flow, beta);
        if drag == Drag::Implicit {
            flow.bed.momentum_transfer = flow.field(None, beta);
        }
        let source = (drag == Drag::Lagged).then_some(&lagged);
        flow.driven_step(1.0, Vector3::z(), source)?;
    }
    let deviation = |cell: [isize; 3]| {
        let darcy = 0.4 / beta(flow.place(cell, Some(2)));
        (flow.state.velocity[2].at(cell) / darcy - 1.0).abs()
    };
    Ok(flow.cells().into_iter().map(deviation).fold(0.0, f64::max))
}

/// -beta u along z on faces.
fn explicit_drag(flow: &Flow, beta: impl Fn([f64; 3]) -> f64) -> [talcum::grid::Field; 3] {
    let mut force = [0, 1, 2].map(|axis| flow.field(Some(axis), |_| 0.0));
    for cell in flow.cells() {
        let drag = -beta(flow.place(cell, Some(2))) * flow.state.velocity[2].at(cell);
        *force[2].at_mut(cell) = drag;
    }
    force
}

#[test]
fn drag_however_strong_shares_the_gas_as_darcy_says() {
    for strength in [1.0e3, 1.0e9] {
        // What inertia leaves after three steps is (eps rho / (beta dt))^3 < 1e-10, and each step rounds.
        let found = deviation_in_stripes(Drag::Implicit, strength).unwrap();
        assert!(found < 1.0e-9, "{found:e}");
        // Control: drag by the velocity of the step before grows by beta dt / (eps rho) in each.
        let lagged = deviation_in_stripes(Drag::Lagged, strength);
        assert!(lagged.map_or(true, |found| found > 1.0e6));
    }
}
