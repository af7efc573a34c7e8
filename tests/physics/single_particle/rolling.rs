//! MFiX DEM04, slip to roll on a rough surface; rolling on a level and an inclined plate.

use crate::beds::{Bench, OPEN, PERIODIC, PLATE, law};
use nalgebra::Vector3;
use talcum::domain::{EffectiveGravity, Wall};

const GRAVITY: f64 = 9.81;
const RADIUS: f64 = 0.0625; // a power of two, so that rolling without slip is exact
const STIFFNESS: f64 = 1.0e6;

/// A sphere at rest in its hollow on a level plate.
fn sphere_on_plate(friction: f64, time_step: f64) -> Bench {
    let mut bench = Bench::new([1.0, 1.0, 1.0], [PERIODIC, PERIODIC, PLATE]);
    bench.contact = law(STIFFNESS, 1.0, friction);
    bench.gravity = EffectiveGravity { magnitude: GRAVITY, vibration: None };
    bench.time_step = time_step;
    bench.density = 2600.0;
    bench.add([0.5; 3], [0.0; 3], RADIUS);
    let sag = bench.particles[0].mass * GRAVITY / STIFFNESS;
    bench.particles[0].position[2] = bench.domain.bounds.position_quantum().round(RADIUS - sag);
    bench
}

/// Time at which the surface stops to slip, velocity then, and how far it swings about that afterwards.
fn slip_to_roll(friction: f64, speed: f64, time_step: f64) -> [f64; 3] {
    let mut bench = sphere_on_plate(friction, time_step);
    bench.particles[0].velocity[0] = speed;
    let mut run = bench.alone();
    let sphere = loop {
        run.steps(1);
        let sphere = run.particle(0);
        // Translation and spin share the angular momentum about the contact, whatever friction does:
        // here to the rounding of forces, 1e-9 N per step.
        let moment = sphere.velocity[0] + 0.4 * RADIUS * sphere.angular_velocity[1];
        assert!((moment - speed).abs() < 1.0e-9 * speed, "{moment}");
        if sphere.velocity[0] <= RADIUS * sphere.angular_velocity[1] {
            break sphere;
        }
    };
    let (end, velocity) = (run.time(), sphere.velocity[0]);
    let mut swing = 0.0_f64;
    for _ in 0..2000 {
        run.steps(1);
        swing = swing.max((run.particle(0).velocity[0] - 5.0 / 7.0 * speed).abs());
    }
    [end, velocity, swing]
}

#[test]
fn dem04_slip_to_roll() {
    let (speed, dt) = (1.0, 1.0e-5);
    for friction in [0.1, 0.3, 0.5, 1.0] {
        let [end, velocity, swing] = slip_to_roll(friction, speed, dt);
        let expected = 2.0 * speed / (7.0 * friction * GRAVITY);
        let relative = [end / expected - 1.0, velocity / (5.0 / 7.0 * speed) - 1.0].map(f64::abs);
        println!(
            "DEM04 mu {friction}: end of slip {end:.6} s ({:.4} % off), velocity {:.4} % off",
            100.0 * relative[0],
            100.0 * relative[1]
        );
        // Loading the spring takes until v t = mu m g / k_t, half of which is lost; one step at the end.
        let mass = sphere_on_plate(friction, dt).particles[0].mass;
        let loading = friction * mass * GRAVITY / (STIFFNESS * 1.4 / 1.7 * speed);
        let late = 2.0 * loading + 2.0 * dt;
        assert!((end - expected).abs() < late, "mu {friction}: {end} for {expected}");
        assert!(relative[1] < 7.0 / 5.0 * friction * GRAVITY * 2.0 * dt);
        // A spring without dashpot then swings: mu m g / k_t long, at omega^2 = 7/2 k_t / m.
        let most = friction * GRAVITY * (mass / (3.5 * STIFFNESS * 1.4 / 1.7)).sqrt();
        assert!(swing < 1.05 * most + friction * GRAVITY * 2.0 * dt, "{swing} for {most}");
        // Negative controls: the times of a hollow sphere (I = 2/3 m r^2) and of 2 % other friction.
        assert!((end - 0.4 * speed / (friction * GRAVITY)).abs() > late);
        assert!((end - expected / 1.02).abs() > late);
    }
}

#[test]
fn rolling_without_slip_feels_no_friction() {
    let mut bench = sphere_on_plate(0.5, 1.0e-5);
    bench.particles[0].velocity[0] = 0.5;
    bench.particles[0].angular_velocity[1] = 0.5 / RADIUS;
    let rolling = bench.alone().steps(5000).particle(0);
    // Not a tolerance: the surface velocity is exactly zero, so is the spring.
    assert_eq!((rolling.velocity[0], rolling.angular_velocity[1] * RADIUS), (0.5, 0.5));
    // Negative control: spin the other way.
    bench.particles[0].angular_velocity[1] = -0.5 / RADIUS;
    assert!(bench.alone().steps(5000).particle(0).velocity[0] < 0.4);
}

/// Acceleration down a plate inclined by `angle` in x, mean over 0.2 s from rest.
fn acceleration_on_incline(angle: f64, friction: f64) -> f64 {
    let mut bench = sphere_on_plate(friction, 1.0e-5);
    bench.domain.bounds = talcum::domain::Bounds::new(Vector3::repeat(1.0), [OPEN; 3]);
    let normal = Vector3::new(angle.sin(), 0.0, angle.cos());
    let point = Vector3::repeat(0.5);
    bench.domain.walls = vec![Wall::plane("chute", point, normal)];
    let sag = bench.particles[0].mass * GRAVITY * angle.cos() / STIFFNESS;
    let start =
        bench.domain.bounds.position_quantum().round_vector(point + normal * (RADIUS - sag));
    bench.particles[0].position = start.into();
    let mut run = bench.alone();
    run.steps(20_000);
    let moved = Vector3::from(run.particle(0).position) - start;
    let downhill = Vector3::new(angle.cos(), 0.0, -angle.sin());
    2.0 * moved.dot(&downhill) / run.time().powi(2)
}

#[test]
fn a_sphere_rolls_or_slides_down_a_chute() {
    let angle = 0.35_f64;
    let rolls = acceleration_on_incline(angle, 0.3);
    let slides = acceleration_on_incline(angle, 0.05);
    let fall = GRAVITY * angle.sin();
    println!("chute: rolls {rolls:.6}, slides {slides:.6}");
    // The way differs by the spring's swing about its static length, a few m g / k_t = 2e-5 m of 0.03 m.
    assert!((rolls / (5.0 / 7.0 * fall) - 1.0).abs() < 2.0e-3, "{rolls}");
    assert!((slides / (fall - 0.05 * GRAVITY * angle.cos()) - 1.0).abs() < 2.0e-3, "{slides}");
    // Negative control: rolling is neither a sliding without friction nor that of a hollow sphere.
    assert!((rolls / fall - 1.0).abs() > 0.1 && (rolls / (0.6 * fall) - 1.0).abs() > 0.1);
}
