//! The order of the integrator over a full collision with the real contact law.
//!
//! If a contact begins within a step, the error has a term (omega dt)^2 that depends on the position within the step.
//! Here the contact begins at the end of a step for any step, so that errors fall smoothly.

use crate::beds::{Bench, OPEN, PERIODIC, law};
use nalgebra::Vector3;
use std::f64::consts::PI;
use talcum::contact::{FrictionCap, LinearSpringDashpot};

const STIFFNESS: f64 = 2.0e5;
const REDUCED_MASS: f64 = PI / 12.0;

/// Duration of an elastic contact of two unit spheres.
fn duration() -> f64 {
    PI * (REDUCED_MASS / STIFFNESS).sqrt()
}

/// Velocity and place of the upper sphere relative to the lower, 1.25 contact durations after the start
/// 1/4 of one before contact, in `steps` steps per contact.
fn collision(contact: LinearSpringDashpot, tangential: f64, steps: u32) -> [Vector3<f64>; 2] {
    let mut bench = Bench::new([5.0; 3], [PERIODIC, PERIODIC, OPEN]);
    bench.contact = contact;
    bench.time_step = duration() / f64::from(steps);
    let speed = 1.0;
    // A hair more, so that rounding does not decide at which step it begins.
    let gap = 0.25 * duration() * speed + 1.0e-11;
    bench.add([2.0, 2.0, 1.0], [0.0; 3], 0.5);
    bench.add([2.0, 2.0, 2.0 + gap], [tangential, 0.0, -speed], 0.5);
    let mut run = bench.alone();
    // Three quarters of the contact: spring, dashpot and slider are all at work.
    run.steps(u64::from(steps));
    let [lower, upper] = [run.particle(0), run.particle(1)];
    let minus = |a: [f64; 3], b: [f64; 3]| Vector3::from(a) - Vector3::from(b);
    [minus(upper.velocity, lower.velocity), minus(upper.position, lower.position)]
}

/// Error of the velocity with n, 2n and 4n steps against 64 n, each over the next: 4 for second order.
fn ratios(contact: LinearSpringDashpot, tangential: f64) -> [f64; 2] {
    let n = 40;
    let reference = collision(contact, tangential, 64 * n);
    let errors = [1, 2, 4].map(|finer| {
        let [velocity, _] = collision(contact, tangential, finer * n);
        (velocity - reference[0]).norm()
    });
    [errors[0] / errors[1], errors[1] / errors[2]]
}

#[test]
fn a_head_on_collision_follows_the_closed_form_to_second_order() {
    let errors = [40, 80, 160, 320].map(|steps| {
        let [velocity, place] = collision(law(STIFFNESS, 1.0, 0.0), 0.0, steps);
        // After 3/4 of a half period: s = 1 - (v/omega) sin(3 pi/4), ds/dt = -v cos(3 pi/4).
        let omega = PI / duration();
        let exact = [-(0.75 * PI).cos(), 1.0 - (0.75 * PI).sin() / omega];
        [(velocity.z - exact[0]).abs(), (place.z - exact[1]).abs() * omega]
    });
    for pair in errors.windows(2) {
        for (coarse, fine) in pair[0].iter().zip(pair[1]) {
            let ratio = coarse / fine;
            println!("head on, error ratio {ratio:.3}");
            // 4, and terms of order (omega dt)^2 = 0.006 beside it.
            assert!((ratio - 4.0).abs() < 0.1, "{errors:?}");
        }
    }
}

#[test]
fn an_oblique_collision_with_a_tangential_spring_is_of_second_order() {
    let kt = LinearSpringDashpot::tangential_stiffness_of(STIFFNESS, 0.3);
    // Friction that never slips: a slider is not smooth, where it begins to slip is a matter of the step.
    let sticking =
        LinearSpringDashpot::new(STIFFNESS, kt, 1.0, 1.0e6, FrictionCap::Contact).unwrap();
    for contact in [law(STIFFNESS, 1.0, 0.0), sticking] {
        for ratio in ratios(contact, 0.7) {
            println!("oblique, error ratio {ratio:.3}");
            // 4, with the reference's own error of 1/4096 and 1/256 of the first and last error.
            assert!((ratio - 4.0).abs() < 0.15, "{ratio}");
        }
    }
}

/// Negative control, and a fact to know: the dashpot acts at velocities half a step old, and for whole steps
/// from the first on, so that with e < 1 the order is one.
#[test]
fn the_dashpot_is_of_first_order() {
    let restitution = 0.9_f64;
    let log = restitution.ln();
    let b = -log / (PI * PI + log * log).sqrt();
    let (omega, tau) = (PI / duration(), 0.75 * duration());
    let damped = omega * (1.0 - b * b).sqrt();
    let (sine, cosine) = (damped * tau).sin_cos();
    let exact = -(-b * omega * tau).exp() * (cosine - b * omega / damped * sine);
    let errors = [40, 80, 160, 320].map(|steps| {
        let [velocity, _] = collision(law(STIFFNESS, restitution, 0.0), 0.0, steps);
        velocity.z - exact
    });
    println!("with dashpot, errors {errors:?}");
    for pair in errors.windows(2) {
        // 2, and terms of second order, which are b times less, beside it.
        assert!((pair[0] / pair[1] - 2.0).abs() < 0.5, "{errors:?}");
    }
}
