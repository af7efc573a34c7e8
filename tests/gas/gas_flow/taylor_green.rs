//! Taylor-Green vortices carried along by a uniform stream: orders in space and time.

use super::driver::{Flow, PERIODIC, Problem, orders};
use nalgebra::Vector3;
use std::f64::consts::PI;

const VISCOSITY: f64 = 0.05;
const STREAM: [f64; 2] = [0.4, 0.3];
const END: f64 = 0.5;

fn moved([x, _, z]: [f64; 3], t: f64) -> [f64; 2] {
    [x - STREAM[0] * t, z - STREAM[1] * t]
}

fn velocity(x: [f64; 3], t: f64) -> [f64; 3] {
    let ([x, z], decay) = (moved(x, t), (-2.0 * VISCOSITY * t).exp());
    [STREAM[0] - x.cos() * z.sin() * decay, 0.0, STREAM[1] + x.sin() * z.cos() * decay]
}

fn pressure(x: [f64; 3], t: f64) -> f64 {
    let ([x, z], decay) = (moved(x, t), (-4.0 * VISCOSITY * t).exp());
    -0.25 * ((2.0 * x).cos() + (2.0 * z).cos()) * decay
}

/// The flow at `END`, on n^2 cells, after `steps` steps.
fn flow(n: usize, steps: usize, decay: f64) -> Flow<'static> {
    dragged_flow(n, steps, decay, 0.0)
}

/// The same with a drag -beta u by the velocity at the beginning of each step: of first order in time.
fn dragged_flow(n: usize, steps: usize, decay: f64, beta: f64) -> Flow<'static> {
    let side = 2.0 * PI;
    let mut problem = Problem::new([side; 3], [n, 1, n], [PERIODIC, PERIODIC, PERIODIC]);
    problem.gas.viscosity = VISCOSITY * decay;
    let mut flow = problem.start();
    flow.set(|x| velocity(x, 0.0), |x| pressure(x, 0.0), |_| 1.0);
    for _ in 0..steps {
        let mut lagged = flow.state.velocity.clone();
        lagged.iter_mut().flat_map(|u| u.values_mut()).for_each(|u| *u *= -beta);
        flow.driven_step(END / steps as f64, Vector3::zeros(), Some(&lagged)).unwrap();
    }
    flow
}

fn error(flow: &Flow) -> f64 {
    flow.velocity_error(0, |x| velocity(x, END)[0])
}

#[test]
fn vortices_are_of_second_order_in_space() {
    // Steps of a quarter of the spacing over the largest velocity, so that time adds little.
    let flows = [16, 32, 64, 128].map(|n| flow(n, n, 1.0));
    let errors = flows.each_ref().map(error);
    let observed = orders(&[16, 32, 64, 128], &errors);
    println!("space: {errors:?} {observed:.3?}");
    // Nominally 2; the limiter is of third order here, so that there is more until the other errors remain.
    assert!(observed.iter().all(|order| *order > 1.9), "{errors:?} {observed:?}");
    // The pressure acts in the middle of the step.
    let errors = [0, 1, 2, 3].map(|i: usize| {
        let n = 16 << i;
        flows[i].pressure_error(|x| pressure(x, END - 0.5 * END / n as f64))
    });
    println!("pressure: {errors:?} {:.3?}", orders(&[16, 32, 64, 128], &errors));
    // Control: a viscosity off by 2 % shows on the finest grid.
    let wrong = error(&flow(128, 128, 1.02));
    assert!(wrong > 3.0 * error(&flows[3]), "{wrong}");
}

/// Differences of u with 16, 32, 64 and 128 steps on n^2 cells from 1024, so short that they no longer matter, and their
/// orders.
fn orders_in_time(n: usize, beta: f64) -> ([f64; 4], Vec<f64>) {
    let reference = dragged_flow(n, 1024, 1.0, beta);
    let steps = [16, 32, 64, 128];
    let differences = steps.map(|steps| {
        let flow = dragged_flow(n, steps, 1.0, beta);
        let exact = reference.state.velocity[0].owned();
        let squares = flow.state.velocity[0].owned().zip(exact).map(|(u, v)| (u - v) * (u - v));
        squares.sum::<f64>().sqrt()
    });
    (differences, orders(&steps, &differences))
}

#[test]
fn vortices_are_of_second_order_in_time() {
    let (differences, observed) = orders_in_time(32, 0.0);
    println!("time: {differences:?} {observed:.3?}");
    assert!(observed.iter().all(|order| (order - 2.0).abs() < 0.1), "{observed:?}");
    // Control: with a part of first order, a weak drag that lags behind.
    let (differences, observed) = orders_in_time(16, 0.1);
    println!("time, with lagged drag: {differences:?} {observed:.3?}");
    assert!(observed.iter().all(|order| *order < 1.2), "{observed:?}");
}
