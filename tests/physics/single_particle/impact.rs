//! Impacts: restitution, oblique impacts in gross sliding and in sticking, and spinning spheres.

use super::damping_ratio;
use crate::beds::{Bench, OPEN, PERIODIC, PLATE, law};
use std::f64::consts::PI;
use talcum::contact::{ContactForceLaw, FrictionCap, LinearSpringDashpot};
use talcum::parallel::ParticleRecord;

const STIFFNESS: f64 = 2.0e5;
const RADIUS: f64 = 0.5;

/// Time step that divides a contact of this reduced mass into `steps`.
fn step_of(contact: &LinearSpringDashpot, reduced_mass: f64, steps: f64) -> f64 {
    contact.contact_duration(reduced_mass, RADIUS) / steps
}

/// Speed of separation over that of approach of two spheres that meet head on.
fn restitution_of_pair(restitution: f64, radii: [f64; 2], steps: f64) -> f64 {
    let mut bench = Bench::new([6.0; 3], [PERIODIC, PERIODIC, OPEN]);
    bench.contact = law(STIFFNESS, restitution, 0.1);
    let gap = 1.0e-4;
    bench.add([3.0, 3.0, 3.0], [0.0, 0.0, 0.3], radii[0]);
    bench.add([3.0, 3.0, 3.0 + radii[0] + radii[1] + gap], [0.0, 0.0, -0.7], radii[1]);
    let [m1, m2] = [bench.particles[0].mass, bench.particles[1].mass];
    bench.time_step = step_of(&bench.contact, m1 * m2 / (m1 + m2), steps);
    let mut run = bench.alone();
    let approach = (gap / bench.time_step) as u64 + 1;
    run.steps(approach + steps as u64 + 2);
    run.particle(1).velocity[2] - run.particle(0).velocity[2]
}

/// The same of a sphere and the plate.
fn restitution_at_plate(restitution: f64, steps: f64) -> f64 {
    let mut bench = Bench::new([6.0; 3], [PERIODIC, PERIODIC, PLATE]);
    bench.contact = law(STIFFNESS, restitution, 0.1);
    let gap = 1.0e-4;
    bench.add([3.0, 3.0, RADIUS + gap], [0.0, 0.0, -1.0], RADIUS);
    bench.time_step = step_of(&bench.contact, bench.particles[0].mass, steps);
    let mut run = bench.alone();
    run.steps((gap / bench.time_step) as u64 + 3 + steps as u64);
    run.particle(0).velocity[2]
}

#[test]
fn restitution_out_is_restitution_in() {
    let steps = 1000.0;
    let mut worst = 0.0_f64;
    for tenths in 1..=10 {
        let given = 0.1 * f64::from(tenths);
        let b = damping_ratio(given);
        let omega_dt = PI / steps / (1.0 - b * b).sqrt();
        // The contact begins and ends within a step, at which the dashpot acts in full or not at all:
        // 2 b omega_0 dt of the speed each. Elastic: (omega_0 dt)^2.
        let bound = 4.0 * b * omega_dt + omega_dt * omega_dt;
        for found in [
            restitution_of_pair(given, [RADIUS, RADIUS], steps),
            restitution_of_pair(given, [RADIUS, 0.2], steps),
            restitution_at_plate(given, steps),
        ] {
            worst = worst.max((found - given).abs());
            assert!((found - given).abs() < bound, "{found} for {given}, bound {bound:.1e}");
        }
        // Negative control: a coefficient 0.02 off.
        let wrong = restitution_at_plate((given - 0.02).max(0.01), steps);
        assert!((wrong - given).abs() > bound);
    }
    println!("restitution 0.1 to 1.0: largest error {worst:.1e}");
}

/// A weightless sphere after it has met the plate at velocity (v_x, -v_z) with spin.
pub(super) fn rebound(
    contact: LinearSpringDashpot,
    velocity: [f64; 2],
    spin: f64,
    steps: f64,
) -> ParticleRecord {
    let mut bench = Bench::new([6.0; 3], [PERIODIC, PERIODIC, PLATE]);
    bench.contact = contact;
    let gap = 1.0e-4;
    bench.add([3.0, 3.0, RADIUS + gap], [velocity[0], 0.0, -velocity[1]], RADIUS);
    bench.particles[0].angular_velocity = [0.0, spin, 0.0];
    bench.time_step = step_of(&contact, bench.particles[0].mass, steps);
    let mut run = bench.alone();
    run.steps((gap / velocity[1] / bench.time_step) as u64 + 3 + steps as u64);
    run.particle(0)
}

#[test]
fn oblique_impact_in_gross_sliding() {
    let (mu, steps, vx, vz) = (0.1, 1000.0, 2.0, 1.0); // tan of the angle 2 > 7/2 mu (1 + e)
    for e in [1.0, 0.9, 0.7] {
        let out = rebound(law(STIFFNESS, e, mu), [vx, vz], 0.0, steps);
        let b = damping_ratio(e);
        let errors = [
            out.velocity[0] - (vx - mu * (1.0 + e) * vz),
            RADIUS * (out.angular_velocity[1] - 2.5 * mu * (1.0 + e) * vz / RADIUS),
        ];
        println!("oblique, sliding, e {e}: errors {:.1e} {:.1e}", errors[0], errors[1]);
        // The cap is mu |F_n|, also while the dashpot pulls at the end: an impulse of 2 b^2 m v each time
        // counted with the other sign. Then the error of e itself.
        let impulse_error = 4.0 * b * b * e + (4.0 * b + PI / steps) * PI / steps;
        let bound = mu * impulse_error * vz;
        assert!(errors[0].abs() < bound && errors[1].abs() < 2.5 * bound, "{errors:?} {bound:.1e}");
        // Negative controls: another friction; a disk (I = m r^2 / 2) instead of a sphere.
        assert!((out.velocity[0] - (vx - 1.1 * mu * (1.0 + e) * vz)).abs() > bound);
        assert!((out.angular_velocity[1] - 2.0 * mu * (1.0 + e) * vz / RADIUS).abs() > 5.0 * bound);
    }
    // Elastic, friction's impulse is mu times the normal one at every step, to round-off of velocities and
    // 1000 roundings of forces (1e-9) times dt / m = 1e-6.
    let out = rebound(law(STIFFNESS, 1.0, mu), [vx, vz], 0.0, steps);
    assert!(((vx - out.velocity[0]) - mu * (out.velocity[2] + vz)).abs() < 1.0e-11);
}

#[test]
fn spinning_impact() {
    let (mu, steps, vz) = (0.2, 1000.0, 1.0);
    let spin = 8.0; // surface velocity 4 > 7/2 mu (1 + e)
    let out = rebound(law(STIFFNESS, 1.0, mu), [0.0, vz], spin, steps);
    let bound = mu * (PI / steps).powi(2); // the error of an elastic impulse
    assert!((out.velocity[0] - mu * 2.0 * vz).abs() < bound, "{}", out.velocity[0]);
    let slowed = spin - 2.5 * mu * 2.0 * vz / RADIUS;
    assert!((out.angular_velocity[1] - slowed).abs() < 5.0 * bound);
    // Negative control: without friction the spin stays.
    let smooth = rebound(law(STIFFNESS, 1.0, 0.0), [0.0, vz], spin, steps);
    assert_eq!((smooth.velocity[0], smooth.angular_velocity[1]), (0.0, spin));
}

/// Tangential velocity after an elastic impact: the motion of the surface against spring and slider,
/// integrated in small steps along the closed form of the normal motion. Symplectic Euler, written independently.
fn reference_tangential(contact: (f64, f64), mu: f64, [vx, vz]: [f64; 2], mass: f64) -> f64 {
    let (kn, kt) = contact;
    let natural = (kn / mass).sqrt();
    let steps = 1_000_000;
    let dt = PI / natural / f64::from(steps);
    let (mut velocity, mut spring, mut surface) = (vx, 0.0_f64, vx);
    for step in 0..steps {
        let normal = (kn * mass).sqrt() * vz * (natural * (f64::from(step) + 0.5) * dt).sin();
        spring += surface * dt;
        let most = mu * normal / kt;
        spring = spring.clamp(-most, most);
        let change = -kt * spring / mass * dt;
        velocity += change;
        surface += 3.5 * change; // 1 + m r^2 / I
    }
    velocity
}

#[test]
fn oblique_impact_that_sticks() {
    let (steps, mass) = (2000.0, PI / 6.0);
    let kt = LinearSpringDashpot::tangential_stiffness_of(STIFFNESS, 0.3);
    for (mu, vx) in [(0.3, 0.1), (0.3, 0.5), (0.5, 1.5), (0.1, 0.4)] {
        let out = rebound(law(STIFFNESS, 1.0, mu), [vx, 1.0], 0.0, steps).velocity[0];
        let expected = reference_tangential((STIFFNESS, kt), mu, [vx, 1.0], mass);
        println!("oblique, sticking, mu {mu}, v_x {vx}: {out:.6}, reference {expected:.6}");
        // The contact begins within a step; what the spring misses then is of order omega dt of v_x.
        let bound = 3.0 * PI / steps * vx;
        assert!((out - expected).abs() < bound, "{out} for {expected}");
        // Negative controls: gross sliding would be another velocity; so would another k_t.
        assert!((out - (vx - 2.0 * mu)).abs() > 10.0 * bound);
        let softer = reference_tangential((STIFFNESS, 0.8 * kt), mu, [vx, 1.0], mass);
        assert!((out - softer).abs() > bound);
    }
}

/// With friction that never slips, the surface swings at omega_t^2 = 7/2 k_t / m for pi / omega_n.
#[test]
fn oblique_impact_without_slip() {
    let kt = LinearSpringDashpot::tangential_stiffness_of(STIFFNESS, 0.3);
    let contact =
        LinearSpringDashpot::new(STIFFNESS, kt, 1.0, 1.0e6, FrictionCap::Contact).unwrap();
    let (steps, vx) = (2000.0, 0.3);
    let out = rebound(contact, [vx, 1.0], 0.0, steps).velocity[0];
    let phase = PI * (3.5 * kt / STIFFNESS).sqrt();
    let expected = vx - 2.0 / 7.0 * vx * (1.0 - phase.cos());
    // Begin and end of the contact within a step: a phase of order omega_t dt = 1.7 pi / steps.
    assert!((out - expected).abs() < 2.0 / 7.0 * vx * 2.0 * 1.7 * PI / steps, "{out}, {expected}");
    // Negative control: the phase without the sphere's rotation.
    let rigid = vx - vx * (1.0 - (PI * (kt / STIFFNESS).sqrt()).cos()) / 1.0;
    assert!((out - rigid).abs() > 0.01);
}
