//! Rolling friction: spin that decays on a smooth plate, MFiX DEM07, a sphere on an incline, and the rolling spring.

use super::rough;
use crate::beds::{Bench, OPEN, PERIODIC, PLATE};
use nalgebra::Vector3;
use talcum::contact::{
    ContactLaw, ContactModel, FrictionCap, LinearSpringDashpot, RollingFriction, RollingKind,
};
use talcum::domain::{Bounds, EffectiveGravity, Wall};

const GRAVITY: f64 = 9.81;
const RADIUS: f64 = 0.0625;
const STIFFNESS: f64 = 1.0e6;
const ROLLING: f64 = 0.05;
const ELASTIC: RollingKind = RollingKind::ElasticPlastic { damping: 0.3 };

fn interface(friction: f64, kind: RollingKind, coefficient: f64) -> ContactModel {
    let law =
        LinearSpringDashpot::new(STIFFNESS, 0.8 * STIFFNESS, 0.5, friction, FrictionCap::Contact);
    let rolling = RollingFriction::new(kind, coefficient).unwrap();
    rough(ContactLaw::LinearSpringDashpot(law.unwrap()), rolling)
}

/// A sphere at rest in its hollow on a plate inclined by an angle in x.
fn sphere(interface: ContactModel, angle: f64) -> Bench {
    let mut bench = Bench::new([1.0, 1.0, 1.0], [PERIODIC, PERIODIC, PLATE]);
    bench.interface = Some(interface);
    bench.gravity = EffectiveGravity { magnitude: GRAVITY, vibration: None };
    bench.time_step = 2.0e-5;
    bench.density = 2600.0;
    bench.domain.bounds = Bounds::new(Vector3::repeat(1.0), [OPEN; 3]);
    let normal = Vector3::new(angle.sin(), 0.0, angle.cos());
    bench.domain.walls = vec![Wall::plane("chute", Vector3::repeat(0.5), normal)];
    let mass = 2600.0 * 4.0 / 3.0 * std::f64::consts::PI * RADIUS.powi(3);
    let sag = mass * GRAVITY * angle.cos() / STIFFNESS;
    let start = Vector3::repeat(0.5) + normal * (RADIUS - sag);
    bench.add(start.into(), [0.0; 3], RADIUS);
    bench
}

#[test]
fn spin_on_a_smooth_plate_decays() {
    for kind in [RollingKind::ConstantTorque, ELASTIC] {
        let spin_after = |coefficient: f64, time: f64| {
            let mut bench = sphere(interface(0.0, kind, coefficient), 0.0);
            bench.particles[0].angular_velocity = [0.0, 40.0, 0.0];
            let mut run = bench.alone();
            run.steps((time / bench.time_step).round() as u64);
            run.particle(0).angular_velocity[1]
        };
        let time = 0.1;
        let found = spin_after(ROLLING, time);
        let expected = 40.0 - 5.0 * ROLLING * GRAVITY * time / (2.0 * RADIUS);
        println!("rolling decay, {kind:?}: {found:.5}, closed form {expected:.5}");
        // Constant: one step's torque. The spring yields after M / k_r = F / (2.25 k mu_r R), half of which is lost.
        let mass = 2600.0 * 4.0 / 3.0 * std::f64::consts::PI * RADIUS.powi(3);
        let bent = mass * GRAVITY / (2.25 * STIFFNESS * ROLLING * RADIUS);
        let lost = 0.5 * bent / 40.0 / time;
        let bound = (40.0 - expected) * (1.5 * lost + 2.0e-3);
        assert!((found - expected).abs() < bound, "{found} {expected}, bound {bound:.1e}");
        // Negative controls: no rolling friction; 10 % more.
        assert_eq!(spin_after(0.0, time), 40.0);
        assert!((spin_after(1.1 * ROLLING, time) - expected).abs() > 2.0 * bound);
    }
    // A constant torque stops the sphere, and does not turn it back.
    let mut bench = sphere(interface(0.0, RollingKind::ConstantTorque, ROLLING), 0.0);
    bench.particles[0].angular_velocity = [0.0, 0.5, 0.0];
    let mut run = bench.alone();
    let mut least = 1.0_f64;
    for _ in 0..3000 {
        least = least.min(run.steps(1).particle(0).angular_velocity[1]);
    }
    assert!(least > -1.0e-9 && run.particle(0).angular_velocity[1] < 1.0e-6, "{least}");
}

/// Coefficients of sliding and of rolling friction, and the speed with which a sphere begins to slip.
const SLIDING: f64 = 0.5;
const DEM07_ROLLING: f64 = 0.1;
const SPEED: f64 = 1.0;

/// A sphere that begins to slip on a level plate, without spin: when it rolls, its speed then, and how far it comes by a time.
fn slip_and_roll(kind: RollingKind, rolling: f64, until: f64) -> [f64; 3] {
    let mut bench = sphere(interface(SLIDING, kind, rolling), 0.0);
    bench.particles[0].velocity[0] = SPEED;
    let mut run = bench.alone();
    let begins_to_roll = loop {
        let sphere = run.steps(1).particle(0);
        if sphere.velocity[0] <= RADIUS * sphere.angular_velocity[1] {
            break sphere;
        }
    };
    let slips = run.time();
    run.steps(((until - slips) / bench.time_step) as u64);
    [slips, begins_to_roll.velocity[0], run.particle(0).position[0] - 0.5]
}

/// The same in closed form, and the whole way until the sphere rests.
///
/// While it slips, dv/dt = -mu g and r d(omega)/dt = (5/2) (mu - mu_r) g, until v = r omega at t = 2 v_0 / ((7 mu - 5 mu_r) g).
/// Then dv/dt = -(5/7) mu_r g.
fn slip_and_roll_in_closed_form(rolling: f64) -> [f64; 3] {
    let slips = 2.0 * SPEED / ((7.0 * SLIDING - 5.0 * rolling) * GRAVITY);
    let speed = SPEED - SLIDING * GRAVITY * slips;
    let rolls = speed * speed / (2.0 * 5.0 / 7.0 * rolling * GRAVITY);
    [slips, speed, 0.5 * (SPEED + speed) * slips + rolls]
}

#[test]
fn dem07_a_sphere_slips_rolls_and_comes_to_rest() {
    let errors = |found: [f64; 3], rolling: f64| {
        let expected = slip_and_roll_in_closed_form(rolling);
        std::array::from_fn::<f64, 3, _>(|k| (found[k] / expected[k] - 1.0).abs())
    };
    // The sliding spring takes 1.6e-5 s to load, and the end of slip is seen at a step of 2e-5 s: 6e-4 of 0.068 s. A rolling
    // spring bends by F / (2.25 k mu_r r) = 1.9e-3 before it yields: for 5 ms a third of its torque is missing, which makes a
    // sixth of the rate at which slip ends, so that slip ends earlier by up to 0.4 %.
    for (kind, tolerance) in [(RollingKind::ConstantTorque, 1.0e-3), (ELASTIC, 4.0e-3)] {
        let found = slip_and_roll(kind, DEM07_ROLLING, 1.1); // it rests after 1.02
        let wrong = errors(found, DEM07_ROLLING);
        println!("DEM07, {kind:?}: {found:?}, relative errors {wrong:?}");
        assert!(wrong.iter().all(|&error| error < tolerance), "{kind:?}: {found:?}, {wrong:?}");
        // Negative control: 10 % more rolling friction.
        assert!(errors(found, 1.1 * DEM07_ROLLING).iter().all(|&error| error > tolerance));
    }
    // Negative control: without rolling friction the sphere slips for a shorter time, and rolls faster.
    let free = slip_and_roll(RollingKind::ConstantTorque, 0.0, 0.1);
    assert!(errors(free, DEM07_ROLLING)[..2].iter().all(|&error| error > 0.05), "{free:?}");
}

#[test]
fn a_sphere_rolls_down_an_incline_against_rolling_friction() {
    let angle = 0.35_f64;
    for kind in [RollingKind::ConstantTorque, ELASTIC] {
        let speed_after = |coefficient: f64, time: f64| {
            let bench = sphere(interface(0.6, kind, coefficient), angle);
            let mut run = bench.alone();
            run.steps((time / bench.time_step).round() as u64);
            let velocity = Vector3::from(run.particle(0).velocity);
            velocity.dot(&Vector3::new(angle.cos(), 0.0, -angle.sin()))
        };
        let time = 0.2;
        let found = speed_after(ROLLING, time);
        let expected = 5.0 / 7.0 * GRAVITY * (angle.sin() - ROLLING * angle.cos()) * time;
        println!("incline, {kind:?}: {found:.5}, closed form {expected:.5}");
        // The sliding spring swings about its static length, 1e-3 of the speed; the rolling spring yields after
        // some milliseconds.
        assert!((found / expected - 1.0).abs() < 1.0e-2, "{found} {expected}");
        // Negative control: without rolling friction it is faster by a seventh.
        assert!((speed_after(0.0, time) / expected - 1.0).abs() > 0.1);
    }
}

#[test]
fn a_rolling_spring_holds_a_sphere_on_a_flat_incline_and_a_torque_only_slows_it() {
    let angle = 0.5 * ROLLING; // below the angle of rolling friction
    let displacement = |kind, coefficient| {
        let bench = sphere(interface(0.6, kind, coefficient), angle);
        let mut run = bench.alone();
        run.steps(40_000);
        let moved =
            Vector3::from(run.particle(0).position) - Vector3::from(bench.particles[0].position);
        (moved.norm(), Vector3::from(run.particle(0).velocity).norm())
    };
    let (held, speed) = displacement(RollingKind::ElasticPlastic { damping: 1.0 }, ROLLING);
    println!("rolling spring on an incline: moved {held:.2e}, speed {speed:.2e}");
    // It bends by M / k_r, the arm R: m g sin R / (2.25 k (mu R)^2) R = 1.4e-4, and rests.
    assert!(held < 3.0e-4 && speed < 1.0e-5, "{held} {speed}");
    // Negative control: without it the sphere rolls.
    let (rolled, _) = displacement(RollingKind::ElasticPlastic { damping: 1.0 }, 0.0);
    assert!(rolled > 0.04, "{rolled}");
}

/// Two spheres in contact that roll on each other: torques are opposite, and angular momentum of the spin goes to
/// neither side more.
#[test]
fn rolling_friction_of_a_pair_is_opposite_on_both() {
    for kind in [RollingKind::ConstantTorque, ELASTIC] {
        let mut bench = Bench::new([4.0; 3], [PERIODIC; 3]);
        let law = LinearSpringDashpot::new(2.0e5, 1.0e5, 1.0, 0.0, FrictionCap::Contact).unwrap();
        let rolling = RollingFriction::new(kind, 0.3).unwrap();
        bench.interface = Some(rough(ContactLaw::LinearSpringDashpot(law), rolling));
        bench.add([2.0, 2.0, 1.0], [0.0, 0.0, 0.2], 0.5);
        bench.add([2.0, 2.0, 1.9999], [0.0, 0.0, -0.2], 0.5);
        bench.particles[0].angular_velocity = [3.0, -1.0, 2.0];
        bench.particles[1].angular_velocity = [-1.0, 0.5, 1.0];
        let mut run = bench.alone();
        run.steps(5);
        let (one, other) = (run.particle(0), run.particle(1));
        let [first, second] = [one, other].map(|it| Vector3::from(it.torque));
        assert_eq!(first, -second);
        assert!(first.norm() > 0.0 && first.z.abs() < 1.0e-6 * first.norm(), "{first:?}");
        let spins = Vector3::from(one.angular_velocity) - Vector3::from(other.angular_velocity);
        assert!(spins.xy().norm() < (4.0_f64.powi(2) + 1.5 * 1.5).sqrt(), "it slows");
        assert!((spins.z - 1.0).abs() < 1.0e-12, "spin about the normal stays");
    }
}
