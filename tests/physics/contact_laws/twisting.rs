//! Resistance to twisting: spin about the normal that decays on a plate, the twisting spring, and pairs.

use crate::beds::{Bench, OPEN, PERIODIC};
use nalgebra::Vector3;
use std::f64::consts::PI;
use talcum::contact::{ContactModel, FrictionCap, LinearSpringDashpot, TwistingFriction};
use talcum::domain::{Bounds, EffectiveGravity, Wall};

const GRAVITY: f64 = 9.81;
const RADIUS: f64 = 0.0625;
const STIFFNESS: f64 = 1.0e6;
const TWISTING: f64 = 0.05;
const RATIO: f64 = 0.02;

fn interface(coefficient: f64, damping: f64) -> ContactModel {
    let law = LinearSpringDashpot::new(STIFFNESS, 0.8 * STIFFNESS, 0.5, 0.3, FrictionCap::Contact);
    let twisting = TwistingFriction::new(coefficient, RATIO, damping).unwrap();
    ContactModel { twisting: Some(twisting), ..law.unwrap().into() }
}

/// A sphere at rest in its hollow on a level plate, with a spin about the vertical.
fn sphere(interface: ContactModel, spin: [f64; 3]) -> Bench {
    let mut bench = Bench::new([1.0; 3], [PERIODIC, PERIODIC, OPEN]);
    bench.interface = Some(interface);
    bench.gravity = EffectiveGravity { magnitude: GRAVITY, vibration: None };
    bench.time_step = 2.0e-5;
    bench.density = 2600.0;
    bench.domain.bounds = Bounds::new(Vector3::repeat(1.0), [OPEN; 3]);
    bench.domain.walls = vec![Wall::plane("plate", Vector3::repeat(0.5), Vector3::z())];
    bench.add([0.5, 0.5, 0.5 + RADIUS - mass() * GRAVITY / STIFFNESS], [0.0; 3], RADIUS);
    bench.particles[0].angular_velocity = spin;
    bench
}

fn mass() -> f64 {
    2600.0 * 4.0 / 3.0 * PI * RADIUS.powi(3)
}

#[test]
fn spin_about_the_normal_decays_as_the_closed_form_says() {
    let spin_after = |coefficient: f64, time: f64| {
        let mut run = sphere(interface(coefficient, 0.3), [0.0, 0.0, 40.0]).alone();
        run.steps((time / 2.0e-5).round() as u64);
        run.particle(0).angular_velocity[2]
    };
    // The torque mu_o R m g over (2/5) m R^2.
    let time = 0.2;
    let expected = 40.0 - 2.5 * TWISTING * GRAVITY * time / RADIUS;
    let found = spin_after(TWISTING, time);
    println!("twisting decay: {found:.5}, closed form {expected:.5}");
    // The spring yields after M / (k_o omega), 2e-4 of the time, and half of the torque is lost until then; one step.
    let bent = TWISTING * mass() * GRAVITY / (RATIO * STIFFNESS * RADIUS) / 40.0;
    let bound = (40.0 - expected) * (0.5 * bent + 2.0e-5) / time + 1.0e-6;
    assert!((found - expected).abs() < 1.5 * bound, "{found} {expected} {bound:.1e}");
    // Negative controls: no resistance; 1 % more.
    assert_eq!(spin_after(0.0, time), 40.0);
    assert!((spin_after(1.01 * TWISTING, time) - expected).abs() > 5.0 * bound);
}

#[test]
fn below_its_limit_the_twisting_spring_swings_with_its_own_period() {
    let period = 2.0 * PI * (0.4 * mass() / (RATIO * STIFFNESS)).sqrt(); // I / k_o with k_o = kappa k_n R^2
    let spin_after = |periods: f64, damping: f64| {
        let mut run = sphere(interface(1.0, damping), [0.0, 0.0, 1.0e-3]).alone();
        run.steps((periods * period / 2.0e-5).round() as u64);
        run.particle(0).angular_velocity[2] / 1.0e-3
    };
    let steps = period / 2.0e-5;
    // Velocity Verlet shortens the period by (omega dt)^2 / 24 of it; half a step of rounding in the times.
    let bound = PI / steps;
    for (periods, expected) in [(0.25, 0.0), (0.5, -1.0), (1.0, 1.0), (10.0, 1.0)] {
        let found = spin_after(periods, 0.0);
        assert!((found - expected).abs() < 2.0 * bound, "{periods}: {found}, bound {bound:.1e}");
    }
    // Negative controls: the dashpot damps it, and another time is seen.
    assert!(spin_after(10.0, 0.1).abs() < 0.05, "{}", spin_after(10.0, 0.1));
    assert!((spin_after(0.6, 0.0) + 1.0).abs() > 0.1);
}

#[test]
fn twisting_of_a_pair_is_opposite_on_both_and_leaves_rolling_alone() {
    let mut bench = Bench::new([4.0; 3], [PERIODIC; 3]);
    let law = LinearSpringDashpot::new(2.0e5, 1.0e5, 1.0, 0.0, FrictionCap::Contact).unwrap();
    let twisting = TwistingFriction::new(0.3, 0.1, 0.2).unwrap();
    bench.interface = Some(ContactModel { twisting: Some(twisting), ..law.into() });
    bench.add([2.0, 2.0, 1.0], [0.0, 0.0, 0.2], 0.5);
    bench.add([2.0, 2.0, 1.9999], [0.0, 0.0, -0.2], 0.5);
    bench.particles[0].angular_velocity = [3.0, -1.0, 2.0];
    bench.particles[1].angular_velocity = [-1.0, 0.5, 1.0];
    let mut run = bench.alone();
    run.steps(5);
    let (one, other) = (run.particle(0), run.particle(1));
    let [first, second] = [one, other].map(|it| Vector3::from(it.torque));
    assert_eq!(first, -second);
    assert!(first.z < 0.0 && first.xy().norm() < 1.0e-6 * first.norm(), "{first:?}");
    let spins = Vector3::from(one.angular_velocity) - Vector3::from(other.angular_velocity);
    assert!(spins.z < 1.0 - 1.0e-6, "it slows: {spins:?}");
    assert_eq!([spins.x, spins.y], [4.0, -1.5], "the other components stay");
}
