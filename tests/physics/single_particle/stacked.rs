//! MFiX DEM03: two stacked, compressed particles between two walls.

use super::damping_ratio;
use crate::beds::{Bench, PERIODIC, law};
use talcum::domain::{EffectiveGravity, Face};

const GRAVITY: f64 = 9.81;
const RADIUS: f64 = 5.0e-4;
const STIFFNESS: f64 = 1.0e3;
const CEILING: f64 = 3.6 * RADIUS;

/// Heights and velocities of the lower and the upper sphere.
type Motion = [f64; 4];

/// Spheres of densities 20,000 and 10,000 at a quarter and three quarters of a gap of 3.6 radii.
fn stack(restitution: f64, time_step: f64) -> Bench {
    let side = 8.0 * RADIUS;
    let mut bench = Bench::new([side, side, CEILING], [PERIODIC, PERIODIC, [Face::Wall; 2]]);
    bench.contact = law(STIFFNESS, restitution, 0.0);
    bench.gravity = EffectiveGravity { magnitude: GRAVITY, vibration: None };
    bench.time_step = time_step;
    bench.skin = Some(0.1 * RADIUS);
    bench.density = 20_000.0;
    bench.add([0.5 * side, 0.5 * side, 0.25 * CEILING], [0.0; 3], RADIUS);
    bench.density = 10_000.0;
    bench.add([0.5 * side, 0.5 * side, 0.75 * CEILING], [0.0; 3], RADIUS);
    bench
}

/// The two equations of motion, written independently here.
fn rates(masses: [f64; 2], damping_ratio: f64, [z1, z2, v1, v2]: Motion) -> Motion {
    let contact = |overlap: f64, separation_speed: f64, reduced_mass: f64| {
        let damping = 2.0 * damping_ratio * (STIFFNESS * reduced_mass).sqrt();
        if overlap > 0.0 { STIFFNESS * overlap - damping * separation_speed } else { 0.0 }
    };
    let [m1, m2] = masses;
    let floor = contact(RADIUS - z1, v1, m1);
    let between = contact(2.0 * RADIUS - (z2 - z1), v2 - v1, m1 * m2 / (m1 + m2));
    let ceiling = contact(RADIUS - (CEILING - z2), -v2, m2);
    [v1, v2, (floor - between) / m1 - GRAVITY, (between - ceiling) / m2 - GRAVITY]
}

/// One step of the classical Runge-Kutta method.
fn runge_kutta(rates: impl Fn(Motion) -> Motion, from: Motion, dt: f64) -> Motion {
    let along = |slope: Motion, part: f64| -> Motion {
        std::array::from_fn(|k| from[k] + part * dt * slope[k])
    };
    let first = rates(from);
    let second = rates(along(first, 0.5));
    let third = rates(along(second, 0.5));
    let fourth = rates(along(third, 1.0));
    std::array::from_fn(|k| {
        from[k] + dt / 6.0 * (first[k] + 2.0 * (second[k] + third[k]) + fourth[k])
    })
}

/// Largest difference of the heights from the reference over 1000 steps, over the radius.
fn largest_error(restitution: f64, reference_restitution: f64, time_step: f64) -> f64 {
    let bench = stack(restitution, time_step);
    let masses = [bench.particles[0].mass, bench.particles[1].mass];
    let ratio = damping_ratio(reference_restitution);
    let mut reference = [0.25 * CEILING, 0.75 * CEILING, 0.0, 0.0];
    let mut run = bench.alone();
    let mut error = 0.0_f64;
    for _ in 0..1000 {
        run.steps(1);
        for _ in 0..10 {
            reference =
                runge_kutta(|motion| rates(masses, ratio, motion), reference, 0.1 * time_step);
        }
        for id in [0, 1] {
            let height = run.particle(id).position[2];
            error = error.max((height - reference[id as usize]).abs() / RADIUS);
        }
    }
    error
}

#[test]
fn dem03_two_stacked_compressed_particles() {
    let natural = (2.0 * STIFFNESS / 5.2e-6_f64).sqrt(); // of the lighter sphere between two springs
    let dt = 2.0e-7; // 1600 steps of its period
    for restitution in [1.0, 0.8, 0.5] {
        let error = largest_error(restitution, restitution, dt);
        println!("DEM03 e {restitution}: largest error {error:.2e} of the radius");
        // Phase error of Verlet, (omega dt)^2/24 per radian, and of the dashpot, b omega dt / 2 of the
        // motion, whose amplitude is below 0.2 radii.
        let phase = 1000.0 * natural * dt * (natural * dt).powi(2) / 24.0;
        let bound = 0.2 * (2.0 * phase + damping_ratio(restitution) * natural * dt);
        assert!(error < bound, "e {restitution}: {error:.2e} is above {bound:.2e}");
        // Negative control: a restitution 2 % off.
        assert!(largest_error(restitution, 0.98 * restitution, dt) > bound);
    }
}
