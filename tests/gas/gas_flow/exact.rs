//! Flows whose solution is known to round-off, or to a known power of the spacing.

use super::driver::{FREE_SLIP, Flow, OUTLET, PERIODIC, Problem, inlet, no_slip, wall};
use nalgebra::Vector3;
use talcum::gas::NavierStokesError;
use talcum::gas::volume_averaged::{Boundary, Profile};

/// Gas between two plates, of which the upper moves along x with velocity 1.
fn couette() -> Flow<'static> {
    let lid = wall(Vector3::new(1.0, 0.0, 0.0));
    let between = [wall(Vector3::zeros()), lid];
    let mut flow = Problem::new([1.0; 3], [1, 1, 16], [PERIODIC, PERIODIC, between]).start();
    flow.run_to_rest(1.0e-3, Vector3::zeros(), 1.0e-16);
    flow
}

#[test]
fn couette_is_exact() {
    let flow = couette();
    // 16 cells, each rounded a few times at steps that no longer change anything: some 1e-15.
    let error = flow.velocity_error(0, |[_, _, z]| z);
    assert!(error < 1.0e-13, "{error:e}");
    // Control: plates half a cell away would be seen.
    assert!(flow.velocity_error(0, |[_, _, z]| (z + 1.0 / 32.0) / (1.0 + 1.0 / 16.0)) > 1.0e-3);
}

/// The flow that a driving force of 1 pushes between two plates at rest, whose gap 1 lies along `axis`.
fn poiseuille(cells: usize, axis: usize, viscosity: f64) -> Flow<'static> {
    let along = (axis + 1) % 3;
    let mut boundaries = [PERIODIC, PERIODIC, PERIODIC];
    boundaries[axis] = no_slip();
    let mut counts = [1; 3];
    counts[axis] = cells;
    let mut problem = Problem::new([1.0; 3], counts, boundaries);
    problem.gas.viscosity = viscosity;
    let mut flow = problem.start();
    let mut driving = Vector3::zeros();
    driving[along] = 1.0;
    flow.run_to_rest(0.25 / (cells * cells) as f64, driving, 1.0e-15);
    flow
}

#[test]
fn poiseuille_has_an_error_of_pure_second_order() {
    for (axis, cells) in [0, 1, 2].into_iter().flat_map(|axis| [(axis, 8), (axis, 16)]) {
        let h = 1.0 / cells as f64;
        // From the parabola between walls that lie so far outside, and h^2/8 more.
        let deviation = |flow: &Flow, outside: f64| {
            let parabola = |x: f64| 0.5 * (x + outside) * (1.0 + outside - x);
            flow.velocity_error((axis + 1) % 3, |x| parabola(x[axis]) + h * h / 8.0) / (h * h)
        };
        let flow = poiseuille(cells, axis, 1.0);
        // The three-point scheme with mirrored walls is off by h^2/8 in every cell, and by nothing else; each step moves
        // the velocity by up to 1e-15 when it is called steady, some 1e-12 of the way left.
        assert!(deviation(&flow, 0.0) < 1.0e-9, "{cells} cells along {axis}");
        // Controls: walls half a cell away; a viscosity 1 % off.
        assert!(deviation(&flow, 0.5 * h) > 1.0);
        assert!(axis > 0 || deviation(&poiseuille(cells, axis, 1.01), 0.0) > 0.01);
    }
}

#[test]
fn a_channel_from_inlet_to_outlet_has_the_pressure_drop_of_poiseuille() {
    let drop = |cells: usize, viscosity: f64| {
        let ends = [inlet(1.0, Profile::Parabolic), OUTLET];
        let mut problem =
            Problem::new([2.0, 1.0, 1.0], [2 * cells, 1, cells], [ends, PERIODIC, no_slip()]);
        (problem.gas.density, problem.gas.viscosity) = (0.1, viscosity);
        let mut flow = problem.start();
        flow.run_to_rest(0.015 / (cells * cells) as f64, Vector3::zeros(), 1.0e-9);
        let middle = [(cells / 2) as isize, 0, (cells / 2) as isize];
        let mut next = middle;
        next[0] += cells as isize;
        (flow.state.pressure.at(middle) - flow.state.pressure.at(next), flow)
    };
    // 12 mu U / H^2 over a length of 1. The discrete parabola has 1.5 h^2 more in its mean at the inlet, and 3 h^2
    // more curvature for the same mean: below 3 h^2 of the whole.
    let (coarse, _) = drop(8, 1.0);
    let (fine, flow) = drop(16, 1.0);
    assert!((coarse - 12.0).abs() < 12.0 * 3.0 / 64.0, "{coarse}");
    assert!((fine - 12.0).abs() < 12.0 * 3.0 / 256.0, "{fine}");
    assert!(((coarse - 12.0) / (fine - 12.0) - 4.0).abs() < 0.2, "{coarse} {fine}");
    // The gas leaves as it came.
    let out = flow.state.velocity[0].at([32, 0, 8]) / flow.state.velocity[0].at([0, 0, 8]);
    assert!((out - 1.0).abs() < 3.0 / 256.0, "{out}");
    // Control: a viscosity 3 % off.
    let (wrong, _) = drop(16, 1.03);
    assert!((wrong - 12.0).abs() > 12.0 * 3.0 / 256.0, "{wrong}");
}

/// A voidage that varies from cell to cell.
fn rough([x, y, z]: [f64; 3]) -> f64 {
    0.6 + 0.2 * (37.0 * x + 11.0 * y).sin() * (53.0 * z + 5.0 * y).cos()
}

#[test]
fn gas_at_rest_in_a_fixed_bed_stays_at_rest_and_bears_its_own_weight() {
    let closed = [no_slip(), PERIODIC, no_slip()];
    let open = [FREE_SLIP, PERIODIC, [inlet(0.0, Profile::Uniform), OUTLET]];
    for boundaries in [closed, open] {
        let mut flow = Problem::new([1.0, 0.7, 2.0], [6, 5, 9], boundaries).start();
        flow.set(|_| [0.0; 3], |_| 0.0, rough);
        flow.bed.momentum_transfer = flow.field(None, |x| 1.0e4 * (1.0 - rough(x)));
        for _ in 0..20 {
            flow.step(1.0e-3).unwrap();
        }
        let moving =
            |flow: &Flow| flow.state.velocity.iter().flat_map(|u| u.values()).any(|&u| u != 0.0);
        assert!(!moving(&flow));
        assert!(flow.state.pressure.values().iter().all(|&p| p == 0.0));
        // Control: weight that the pressure does not know of beforehand, and that is not shared with the particles,
        // sets the gas in motion.
        let weight =
            [0, 1, 2].map(|axis| flow.field(Some(axis), |_| if axis == 2 { -9.8 } else { 0.0 }));
        flow.driven_step(1.0e-3, Vector3::zeros(), Some(&weight)).unwrap();
        assert!(moving(&flow));
    }
}

/// Largest change in ten steps of a uniform velocity with which gas and bed move, in a box without walls. The
/// voidage changes by `share` of what continuity asks for.
fn change_of_uniform_flow(share: f64) -> f64 {
    let lengths = [1.0, 0.8, 1.2];
    let mut flow = Problem::new(lengths, [6, 5, 7], [PERIODIC, PERIODIC, PERIODIC]).start();
    flow.gas.viscosity = 0.01;
    let (u, dt, turn) = ([0.3, -0.2, 0.5], 5.0e-3, 2.0 * std::f64::consts::PI);
    let mut largest = 0.0_f64;
    for step in 0..10 {
        let phase = 0.3 * f64::from(step);
        let eps =
            |x: [f64; 3]| 0.6 + 0.2 * (turn * x[0] + phase).sin() * (turn * x[2] / 1.2 + 1.0).cos();
        let spacing = flow.spacing;
        let before = |x: [f64; 3]| {
            let along = |axis: usize| {
                let (mut below, mut above) = (x, x);
                below[axis] -= spacing[axis];
                above[axis] += spacing[axis];
                u[axis] * (eps(above) - eps(below)) / (2.0 * spacing[axis])
            };
            eps(x) + share * dt * (along(0) + along(1) + along(2))
        };
        flow.set(|_| u, |_| 0.0, before);
        let beta = |x: [f64; 3]| 30.0 * (1.0 - eps(x));
        flow.bed.voidage = flow.field(None, eps);
        flow.bed.momentum_transfer = flow.field(None, beta);
        flow.bed.transferred_velocity = [0, 1, 2].map(|a| flow.field(None, |x| beta(x) * u[a]));
        flow.step(dt).unwrap();
        for (velocity, u) in flow.state.velocity.iter().zip(u) {
            largest = velocity.owned().map(|now| (now - u).abs()).fold(largest, f64::max);
        }
    }
    largest
}

#[test]
fn a_uniform_velocity_is_kept_whatever_the_voidage_does() {
    // Round-off of divergences, 1e-16 u / h, over a step, through the pressure: some 1e-15.
    let change = change_of_uniform_flow(1.0);
    assert!(change < 1.0e-13, "{change:e}");
    // Control: if d(eps)/dt were left out.
    assert!(change_of_uniform_flow(0.0) > 1.0e-3);
}

#[test]
fn continuity_holds_in_every_cell() {
    let ends = [inlet(0.3, Profile::Uniform), OUTLET];
    let mut flow = Problem::new([1.0, 0.7, 2.0], [6, 5, 9], [no_slip(), PERIODIC, ends]).start();
    flow.gas.viscosity = 0.01;
    flow.set(|_| [0.0; 3], |_| 0.0, rough);
    for step in 0..10 {
        let moved = 0.02 * f64::from(step);
        let eps = |[x, y, z]: [f64; 3]| rough([x, y, z + moved]);
        flow.bed.voidage = flow.field(None, eps);
        flow.bed.momentum_transfer = flow.field(None, |x| 300.0 * (1.0 - eps(x)));
        let before = flow.state.voidage.clone();
        let report = flow.step(5.0e-3).unwrap();
        // The largest of all cells is at most the norm that the tolerance limits.
        let allowed = 1.1e-10 * report.convergence.right_hand_side;
        let error = flow.continuity_error(&before, 5.0e-3);
        assert!(error < allowed + 1.0e-13, "{error:e} {allowed:e}");
        // Control: the change of voidage matters.
        if step > 0 {
            let still = flow.state.voidage.clone();
            assert!(flow.continuity_error(&still, 5.0e-3) > 1.0e-3);
        }
    }
}

/// How much the gas's momentum along x changes until the time 0.1 in a steady bed without drag, by steps `dt`, and
/// how much its velocity does.
fn lost_momentum(dt: f64) -> (f64, f64) {
    let mut flow = Problem::new([1.0; 3], [8, 6, 7], [PERIODIC, PERIODIC, PERIODIC]).start();
    flow.gas.viscosity = 0.02;
    let turn = 2.0 * std::f64::consts::PI;
    let velocity = |[x, _, z]: [f64; 3]| {
        [0.3 + (turn * z).sin(), 0.2 * (turn * x).cos(), 0.5 + (turn * x + 1.0).sin()]
    };
    flow.set(velocity, |_| 0.0, |_| 0.7);
    // The first steps make the velocity obey continuity, and find the pressure.
    for _ in 0..10 {
        flow.step(1.0e-6).unwrap();
    }
    let momentum = |flow: &Flow| -> f64 { flow.state.velocity[0].owned().sum() };
    let (before, start) = (momentum(&flow), flow.state.velocity[0].clone());
    for _ in 0..(0.1 / dt).round() as usize {
        flow.step(dt).unwrap();
    }
    let changes =
        flow.state.velocity[0].owned().zip(start.owned()).map(|(new, old)| (new - old).abs());
    ((momentum(&flow) - before).abs() / flow.cells().len() as f64, changes.fold(0.0, f64::max))
}

#[test]
fn momentum_is_conserved_to_second_order_in_time() {
    let losses = [1.0e-2, 5.0e-3, 2.5e-3].map(lost_momentum);
    // Fluxes of the first prediction obey continuity to second order only: 2^2 for half the step.
    for pair in losses.windows(2) {
        assert!(pair[0].0 / pair[1].0 > 3.5, "{losses:?}");
    }
    // Control: the velocity itself changes much more.
    assert!(losses[0].0 < 1.0e-5 * losses[0].1, "{losses:?}");
}

#[test]
fn a_jump_that_is_carried_along_makes_no_overshoot() {
    // Shear layers of u in a uniform stream w, without viscosity: a scalar that is carried along z.
    let mut flow =
        Problem::new([1.0, 1.0, 1.0], [3, 1, 40], [PERIODIC, PERIODIC, PERIODIC]).start();
    flow.gas.viscosity = 0.0;
    let layer = |z: f64| if (0.3..0.6).contains(&z) { 1.0 } else { 0.0 };
    flow.set(|[_, _, z]| [layer(z), 0.0, 0.5], |_| 0.0, |_| 1.0);
    // Courant number 0.4: sums of |u| dt / h over x and z, 1/3 and 0.5 of 40.
    for _ in 0..100 {
        flow.step(0.4 / (3.0 + 20.0)).unwrap();
    }
    let extremes = flow.state.velocity[0]
        .owned()
        .fold((0.0_f64, 0.0_f64), |(low, high), u| (low.min(u), high.max(u)));
    assert!(extremes.0 > -1.0e-12 && extremes.1 < 1.0 + 1.0e-12, "{extremes:?}");
    // Control: the layers have moved, and are still there.
    assert!(extremes.1 > 0.9 && flow.velocity_error(0, |[_, _, z]| layer(z)) > 0.1);
    // Control: without the limiter the same interpolation overshoots.
    let start: Vec<f64> = (0..40).map(|cell| layer((f64::from(cell) + 0.5) / 40.0)).collect();
    let carried = carried_without_limiter(start, 0.5 * 40.0 * 0.4 / (3.0 + 20.0), 100);
    assert!(carried.iter().any(|&u| u > 1.05) && carried.iter().any(|&u| u < -0.05));
}

/// Numbers carried upwards through a periodic row of cells by so many steps of a Courant number: interpolation of
/// third order towards the wind, Heun's steps.
fn carried_without_limiter(start: Vec<f64>, courant: f64, steps: usize) -> Vec<f64> {
    let change = |u: &[f64]| -> Vec<f64> {
        let count = u.len();
        let in_upper = |cell: usize| {
            let (below, above) = (u[(cell + count - 1) % count], u[(cell + 1) % count]);
            (2.0 * above + 5.0 * u[cell] - below) / 6.0
        };
        (0..count)
            .map(|cell| courant * (in_upper((cell + count - 1) % count) - in_upper(cell)))
            .collect()
    };
    (0..steps).fold(start, |u, _| {
        let first = change(&u);
        let second = change(&u.iter().zip(&first).map(|(u, by)| u + by).collect::<Vec<_>>());
        u.iter().zip(first.iter().zip(&second)).map(|(u, (a, b))| u + 0.5 * (a + b)).collect()
    })
}

#[test]
fn what_cannot_be_is_said() {
    let mut flow = Problem::new([1.0; 3], [4, 4, 4], [PERIODIC, PERIODIC, PERIODIC]).start();
    flow.set(|_| [1.0, 0.0, 0.0], |_| 0.0, |_| 0.5);
    let before = flow.state.clone();
    let error = flow.step(0.2).unwrap_err();
    let NavierStokesError::StepTooLong { courant, viscous, longest, .. } = error else {
        panic!("{error}")
    };
    assert!((courant - 0.8).abs() < 1.0e-12 && (viscous / 0.2 - 256.0).abs() < 1.0e-9);
    assert!(error.to_string().contains("too long"));
    assert_eq!(flow.state, before);
    assert!(flow.step(longest).is_ok());
    *flow.bed.voidage.at_mut([1, 2, 3]) = 0.0;
    assert_eq!(flow.step(1.0e-3), Err(NavierStokesError::Voidage { least: 0.0, largest: 0.5 }));
    *flow.bed.voidage.at_mut([1, 2, 3]) = 0.5;
    *flow.state.velocity[1].at_mut([1, 2, 3]) = f64::NAN;
    assert_eq!(flow.step(1.0e-3), Err(NavierStokesError::NotFinite));

    let wrong = |boundaries| {
        let problem = Problem::new([1.0; 3], [4, 4, 4], boundaries);
        problem.gas.check(&problem.grid()).unwrap_err()
    };
    let message = wrong([PERIODIC, PERIODIC, [inlet(1.0, Profile::Uniform), Boundary::FreeSlip]]);
    assert!(message.contains("outlet"), "{message}");
    let message = wrong([PERIODIC, [wall(Vector3::y()), Boundary::FreeSlip], FREE_SLIP]);
    assert!(message.contains("y lower") && message.contains("normal"), "{message}");
    let message = wrong([PERIODIC, PERIODIC, [inlet(1.0, Profile::Table(vec![1.0; 15])), OUTLET]]);
    assert!(message.contains("15 numbers for 16 cells"), "{message}");
}

#[test]
fn a_uniform_flow_whose_continuity_is_rounding_alone_continues() {
    // The pressure has nothing to correct: the right-hand side of its equation is the rounding of the flows. No solver
    // takes fifteen digits off it, and none needs to.
    for trial in 0..12 {
        let push = 0.1 * f64::from(trial);
        let mut problem = Problem::new([1.0, 1.3, 1.7], [4, 6, 10], [PERIODIC; 3]);
        problem.gas.tolerance.relative = 1.0e-15;
        problem.gas.viscosity = 0.1;
        let mut flow = problem.start();
        let velocity = [0.1, 0.2, 0.3 + push];
        flow.set(
            |_| velocity,
            |_| 0.0,
            |[x, y, z]| 0.61 + 4.0e-16 * (99.0 * x + 77.0 * y + 55.0 * z).sin(),
        );
        flow.bed.momentum_transfer =
            flow.field(None, |[x, _, z]| 7.0 + 4.0e-15 * (31.0 * x * z).cos());
        let driving = Vector3::new(0.3, 0.7, 1.0 + push);
        let mut last = 0.0;
        for _ in 0..400 {
            last = flow.driven_step(1.0e-2, driving, None).unwrap().convergence.right_hand_side;
        }
        assert!(last > 0.0 && last < 1.0e-12, "{last:e}");
        // u = eps f / beta to round-off of some hundred steps.
        let [x, y, z]: [f64; 3] = (driving * (0.61 / 7.0)).into();
        let error = flow.velocity_error(0, |_| x) + flow.velocity_error(1, |_| y);
        assert!(error + flow.velocity_error(2, |_| z) < 1.0e-13);
    }
    // Control: where there is something to correct, it is corrected to the tolerance.
    let mut flow = Problem::new([1.0; 3], [4, 4, 8], [PERIODIC; 3]).start();
    let wave = |x: f64| (2.0 * std::f64::consts::PI * x).sin();
    flow.set(|[_, _, z]| [0.0, 0.0, 0.1 * wave(z)], |_| 0.0, |_| 0.61);
    let convergence = flow.step(1.0e-3).unwrap().convergence;
    assert!(convergence.iterations > 0, "{convergence:?}");
    assert!(convergence.residual <= 1.0e-10 * convergence.right_hand_side, "{convergence:?}");
}
