//! MFiX DEM01, freely-falling particle, and DEM02, bouncing particle.

use super::damping_ratio;
use crate::beds::{Bench, PERIODIC, PLATE, Run, law};
use talcum::domain::EffectiveGravity;

const GRAVITY: f64 = 9.81;
const RADIUS: f64 = 0.1;
const HEIGHT: f64 = 0.5;

/// A sphere of density 2600 and radius 0.1 m whose centre is 0.5 m above a plate.
fn sphere_above_plate(stiffness: f64, restitution: f64, time_step: f64) -> Bench {
    let mut bench = Bench::new([1.0, 1.0, 1.0], [PERIODIC, PERIODIC, PLATE]);
    bench.contact = law(stiffness, restitution, 0.0);
    bench.gravity = EffectiveGravity { magnitude: GRAVITY, vibration: None };
    bench.time_step = time_step;
    bench.density = 2600.0;
    bench.force_limit = Some(2.0 * stiffness * RADIUS); // MFiX lets the sphere sink in by its radius
    bench.add([0.5, 0.5, HEIGHT], [0.0; 3], RADIUS);
    bench
}

fn impact_speed() -> f64 {
    (2.0 * GRAVITY * (HEIGHT - RADIUS)).sqrt()
}

/// Height of the centre while in contact, a time tau after it began (DEM01).
fn height_in_contact(tau: f64, natural: f64, restitution: f64) -> f64 {
    let b = damping_ratio(restitution);
    let (damped, sag) = (natural * (1.0 - b * b).sqrt(), GRAVITY / natural.powi(2));
    let swing = (b * GRAVITY / natural - impact_speed()) / damped;
    let (sine, cosine) = (damped * tau).sin_cos();
    RADIUS - sag + (-b * natural * tau).exp() * (sag * cosine + swing * sine)
}

/// Largest difference of simulated and closed-form height over the first contact, over the largest overlap.
fn contact_error(restitution: f64, assumed_restitution: f64, time_step: f64) -> f64 {
    let bench = sphere_above_plate(1.0e4, restitution, time_step);
    let natural = (1.0e4 / bench.particles[0].mass).sqrt();
    let begin = impact_speed() / GRAVITY;
    let mut run = bench.alone();
    let (mut error, mut deepest) = (0.0_f64, 0.0_f64);
    loop {
        run.steps(1);
        let tau = run.time() - begin;
        if tau < 0.0 {
            continue;
        }
        let exact = height_in_contact(tau, natural, assumed_restitution);
        if exact > RADIUS {
            return error / deepest;
        }
        error = error.max((run.particle(0).position[2] - exact).abs());
        deepest = deepest.max(RADIUS - exact);
    }
}

#[test]
fn dem01_freely_falling_particle() {
    for restitution in [1.0, 0.9, 0.5] {
        let dt = 1.0e-4; // 1000 steps of the contact
        let natural = (1.0e4_f64 / 10.9).sqrt();
        let error = contact_error(restitution, restitution, dt);
        println!("DEM01 e {restitution}: largest error over largest overlap {error:.2e}");
        // First order in b omega_0 dt by the dashpot, in omega_0 dt squared by the spring; twice each.
        let bound = 2.0 * (damping_ratio(restitution) + natural * dt) * natural * dt;
        assert!(error < bound, "e {restitution}: {error:.2e} is above {bound:.2e}");
        // Negative control: a restitution that is 2 % off.
        assert!(contact_error(restitution, 0.98 * restitution, dt) > 2.0 * bound.min(1.0e-3));
    }
}

#[test]
fn a_free_fall_is_exact() {
    let mut run = sphere_above_plate(1.0e4, 0.9, 1.0e-4).alone();
    run.steps(2500);
    let (time, particle) = (run.time(), run.particle(0));
    let fall = HEIGHT - 0.5 * GRAVITY * time * time;
    // Verlet is exact under a constant force. The weight is rounded to the lattice of forces, whose
    // spacing is 2^-51 of 64 to 128 times the limit of 1000 N: 6e-11 N of 107 N; the way to that of
    // positions: 2500 roundings of 4e-16.
    assert!((particle.position[2] - fall).abs() < 2.0e-12, "{}", particle.position[2] - fall);
    assert!((particle.velocity[2] + GRAVITY * time).abs() < 4.0e-12);
    // Negative control: half a step of another start of the clock.
    let late = HEIGHT - 0.5 * GRAVITY * (time - 0.5e-4).powi(2);
    assert!((particle.position[2] - late).abs() > 1.0e-5);
}

/// Centre's height at the first three apices; each is that of the parabola through the step there.
fn apices(mut run: Run) -> [f64; 3] {
    let mut heights = [0.0; 3];
    let mut rises = false;
    let mut found = 0;
    while found < 3 {
        run.steps(1);
        let particle = run.particle(0);
        let (height, velocity) = (particle.position[2], particle.velocity[2]);
        if rises && velocity <= 0.0 {
            heights[found] = height + velocity * velocity / (2.0 * GRAVITY);
            found += 1;
        }
        rises = velocity > 0.0;
    }
    heights
}

#[test]
fn dem02_bouncing_particle() {
    let (stiffness, dt) = (1.0e8, 2.0e-6); // 520 steps of a contact
    for restitution in [0.7, 0.9, 1.0] {
        let bench = sphere_above_plate(stiffness, restitution, dt);
        let natural = (stiffness / bench.particles[0].mass).sqrt();
        let heights = apices(bench.alone());
        let b = damping_ratio(restitution);
        for (bounce, height) in (1..=3).zip(heights) {
            let ideal = RADIUS + (HEIGHT - RADIUS) * restitution.powi(2 * bounce);
            let error = (height / ideal - 1.0).abs();
            println!(
                "DEM02 e {restitution} bounce {bounce}: h {height:.6}, error {:.4} %",
                100.0 * error
            );
            // The formula knows no weight during contact, of order g / (omega_0 v), and the dashpot is of
            // first order; both act per bounce and only for e < 1. Elastic: (omega_0 dt)^2.
            let speed = impact_speed() * restitution.powi(bounce);
            let per_bounce = 2.0 * b * (GRAVITY / (natural * speed) + natural * dt);
            let bound = bounce as f64 * (2.0 * per_bounce + (natural * dt).powi(2));
            assert!(error < bound, "bounce {bounce}: {error:.2e} is above {bound:.2e}");
            // Negative control: a restitution that is 1 % off.
            let wrong = RADIUS + (HEIGHT - RADIUS) * (0.99 * restitution).powi(2 * bounce);
            assert!((height / wrong - 1.0).abs() > bound);
        }
    }
}
