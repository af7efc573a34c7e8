//! Walls: their own material, their motion, a round column, and a wall as the limit of a large sphere.

use super::{rough, smooth};
use crate::beds::{Bench, OPEN, PERIODIC, PLATE};
use nalgebra::Vector3;
use std::f64::consts::PI;
use talcum::contact::{
    AdhesiveElasticPlastic, ContactLaw, ContactModel, ContactModuli, FrictionCap, HertzMindlin,
    HystereticParameters, Jkr, LinearHysteretic, LinearSpringDashpot, RollingFriction, RollingKind,
};
use talcum::domain::{EffectiveGravity, Vibration, Wall, WallMotion};
use talcum::parallel::ParticleRecord;

fn linear(stiffness: f64, restitution: f64, friction: f64) -> ContactModel {
    let law = LinearSpringDashpot::new(
        stiffness,
        0.8 * stiffness,
        restitution,
        friction,
        FrictionCap::Contact,
    );
    smooth(ContactLaw::LinearSpringDashpot(law.unwrap()))
}

const GRAVITY: EffectiveGravity = EffectiveGravity { magnitude: 1.0, vibration: None };

/// Every law, with rolling friction, for spheres of radius 0.5 and density 1.
fn all_laws() -> Vec<ContactModel> {
    let parameters = HystereticParameters {
        loading_stiffness: 1.6e5,
        unloading_stiffness: 2.0e5,
        tangential_stiffness: 5.0e4,
        restitution: 0.9,
        friction: 0.3,
    };
    let moduli = ContactModuli { normal: 1.0e6, shear: 3.0e5 };
    let rolling = RollingFriction::new(RollingKind::ElasticPlastic { damping: 0.2 }, 0.1).unwrap();
    let linear = LinearSpringDashpot::new(2.0e5, 1.5e5, 0.9, 0.3, FrictionCap::Contact).unwrap();
    [
        ContactLaw::LinearSpringDashpot(linear),
        ContactLaw::AdhesiveElasticPlastic(
            AdhesiveElasticPlastic::new(parameters, 10.0, 1.0e-3).unwrap(),
        ),
        ContactLaw::LinearHysteretic(LinearHysteretic::new(parameters, 3.0e4).unwrap()),
        ContactLaw::HertzMindlin(HertzMindlin::new(moduli, 0.9, 0.3).unwrap()),
        ContactLaw::Jkr(Jkr::new(moduli, 2.0, 0.9, 0.3).unwrap()),
    ]
    .map(|law| rough(law, rolling))
    .to_vec()
}

/// A sphere of radius 0.5 after 400 steps, most of an oblique impact with spin, on a body below.
fn after_impact(mut bench: Bench, ground: f64) -> ParticleRecord {
    bench.time_step = 2.0e-5;
    let place = [0.0, 0.0, ground + 0.5 + 1.0e-5];
    let centre = bench.domain.bounds.lengths() * 0.5;
    bench.add([centre.x, centre.y, place[2]], [0.3, 0.1, -1.0], 0.5);
    let id = bench.particles.len() as u64 - 1;
    bench.particles[id as usize].angular_velocity = [0.5, -2.0, 1.0];
    bench.alone().steps(150).particle(id)
}

#[test]
fn a_wall_is_the_limit_of_a_large_sphere() {
    for interface in all_laws() {
        let mut flat = Bench::new([8.0; 3], [OPEN, OPEN, PLATE]);
        flat.interface = Some(interface.clone());
        let wall = after_impact(flat, 0.0);
        let difference = |radius: f64| {
            let mut round = Bench::new([2.1 * radius, 2.1 * radius, 4.0 * radius], [OPEN; 3]);
            round.interface = Some(interface.clone());
            // A pressing force far below that of the impact, were it to fall: there is no gravity.
            let centre = 1.05 * radius;
            round.add([centre, centre, centre], [0.0; 3], radius);
            let sphere = after_impact(round, 2.05 * radius);
            let v = Vector3::from(sphere.velocity) - Vector3::from(wall.velocity);
            let w = Vector3::from(sphere.angular_velocity) - Vector3::from(wall.angular_velocity);
            v.norm() + 0.5 * w.norm()
        };
        let [near, far] = [100.0, 1000.0].map(difference);
        println!("wall and sphere of radius 100, 1000: {near:.2e}, {far:.2e}");
        // 1/R* = 1/r + 1/R: the difference falls as r/R, and is of its size times speeds of order 1.
        assert!(near < 0.05 && far < 0.15 * near + 1.0e-6, "{near} {far} {interface:?}");
        // Negative control: a sphere of three times the radius is no wall.
        assert!(difference(1.5) > 10.0 * near.max(1.0e-3), "{}", difference(1.5));
    }
}

#[test]
fn each_wall_has_its_own_material() {
    let rebound = |at_walls: Vec<ContactModel>, cohesive: bool| {
        let mut bench = Bench::new([4.0; 3], [PERIODIC, PERIODIC, PLATE]);
        let parameters = HystereticParameters {
            loading_stiffness: 1.0e5,
            unloading_stiffness: 2.0e5,
            tangential_stiffness: 1.0e4,
            restitution: 0.9,
            friction: 0.3,
        };
        let law = AdhesiveElasticPlastic::new(parameters, if cohesive { 200.0 } else { 0.0 }, 0.0);
        bench.interface = Some(smooth(ContactLaw::AdhesiveElasticPlastic(law.unwrap())));
        bench.at_walls = at_walls;
        bench.time_step = 2.0e-6;
        bench.add([2.0, 2.0, 0.5 + 1.0e-5], [0.0, 0.0, -1.0], 0.5);
        let mut run = bench.alone();
        run.steps(12_000);
        (run.particle(0).velocity[2], !run.snapshot().walls.is_empty())
    };
    // Elastic: (omega dt)^2 of the wall's own law.
    assert!((rebound(vec![linear(2.0e5, 1.0, 0.3)], true).0 - 1.0).abs() < 1.0e-5);
    assert!((rebound(vec![linear(2.0e5, 0.5, 0.3)], true).0 - 0.5).abs() < 5.0e-3);
    // Negative control: like the particles, the wall holds the sphere; without adhesion it does not.
    assert!(rebound(Vec::new(), true).1);
    let (speed, held) = rebound(Vec::new(), false);
    assert!(speed > 0.5 && !held);
}

/// A belt: slip until the sphere has 2/7 of its speed by friction, then it rolls; never more.
#[test]
fn a_moving_plate_carries_a_sphere_along() {
    let (mu, speed) = (0.3, 0.5);
    let mut bench = Bench::new([40.0, 4.0, 4.0], [PERIODIC, PERIODIC, PLATE]);
    bench.interface = Some(linear(2.0e5, 0.9, mu));
    bench.gravity = GRAVITY;
    bench.domain.walls[0].motion =
        WallMotion { velocity: Vector3::x() * speed, ..WallMotion::REST };
    let sag = PI / 6.0 / 2.0e5;
    bench.add([2.0, 2.0, 0.5 - sag], [0.0; 3], 0.5);
    let mut run = bench.alone();
    let (mut impulse, dt) = (0.0, bench.time_step);
    let slips_until = 2.0 / 7.0 * speed / mu;
    for _ in 0..(1.5 * slips_until / dt) as u64 {
        // The balance of momentum: what the wall does is what the sphere gets.
        let before = run.work.on_walls.on_wall(0)[0];
        run.steps(1);
        let after = run.work.on_walls.on_wall(0)[0];
        impulse -= 0.5 * dt * (before + after) as f64 * run.models.force_quantum.spacing();
        let sphere = run.particle(0);
        let gained = sphere.mass * sphere.velocity[0];
        assert!((gained - impulse).abs() < 1.0e-12, "{gained} {impulse}"); // sums of 7000 roundings
        if run.time() < 0.98 * slips_until {
            // The spring is loaded within the first steps: mu g t, less mu m g / k_t over the speed.
            assert!(
                (sphere.velocity[0] - mu * run.time()).abs() < 1.0e-4,
                "{}",
                sphere.velocity[0]
            );
        }
    }
    let sphere = run.particle(0);
    println!("on a belt: v {} of {}", sphere.velocity[0], 2.0 / 7.0 * speed);
    // The spring swings about zero with mu g sqrt(m / 3.5 k_t) = 3e-4.
    assert!((sphere.velocity[0] - 2.0 / 7.0 * speed).abs() < 5.0e-4);
    // Negative control: a plate at rest leaves it at rest.
    bench.domain.walls[0].motion = WallMotion::REST;
    assert_eq!(bench.alone().steps(1000).particle(0).velocity[0], 0.0);
}

/// A plate shaken in the laboratory is the same as gravity shaken in the frame of the plate.
#[test]
fn a_shaken_wall_is_a_shaken_frame() {
    let (gamma, frequency) = (2.0, 0.5);
    let amplitude = gamma / (2.0 * PI * frequency).powi(2);
    let bench = |shaken_wall: bool| {
        let mut bench = Bench::new([4.0, 4.0, 12.0], [PERIODIC, PERIODIC, OPEN]);
        bench.interface = Some(linear(2.0e4, 0.7, 0.3));
        bench.time_step = 1.0e-4;
        bench.gravity = GRAVITY;
        let mut plate = Wall::plane("shaker", Vector3::new(0.0, 0.0, 2.0), Vector3::z());
        if shaken_wall {
            let amplitude = Vector3::z() * -amplitude;
            plate.motion = WallMotion { amplitude, frequency, ..WallMotion::REST };
        } else {
            let vibration = Vibration { relative_acceleration: gamma, frequency, start: 0.0 };
            bench.gravity.vibration = Some(vibration);
        }
        bench.domain.walls = vec![plate];
        bench.add([2.0, 2.0, 2.6], [0.0; 3], 0.5);
        // The frame starts with the plate's velocity, which is not zero: -A omega.
        let start = if shaken_wall { 0.0 } else { amplitude * 2.0 * PI * frequency };
        bench.particles[0].velocity = [0.0, 0.0, start];
        bench
    };
    let (laboratory, frame) = (bench(true), bench(false));
    let (mut one, mut other) = (laboratory.alone(), frame.alone());
    let (mut worst, mut moved) = (0.0_f64, 0.0_f64);
    for _ in 0..400 {
        one.steps(100);
        other.steps(100);
        let plate = laboratory.domain.walls[0].pose(one.time(), 0.0).displacement.z;
        let heights = [one.particle(0).position[2] - plate, other.particle(0).position[2]];
        worst = worst.max((heights[0] - heights[1]).abs());
        moved = moved.max(plate.abs());
    }
    println!("shaken wall and shaken frame: heights differ by {worst:.1e} of {moved:.2}");
    // Verlet's error of the shaken frame, A (omega dt)^2 / 12 and its growth over bounces of e = 0.7.
    assert!(worst < 1.0e-3 && moved > 0.15, "{worst} {moved}");
    // Negative control: the other phase is another motion.
    let mut wrong = bench(true);
    wrong.domain.walls[0].motion.amplitude *= -1.0;
    assert!((wrong.alone().steps(4000).particle(0).position[2] - 2.5).abs() > 10.0 * worst);
}

/// A sphere that has left a wall remembers nothing of it, although the pair stays in the list.
#[test]
fn a_contact_with_a_wall_ends_with_its_history() {
    for contact in all_laws() {
        let mut bench = Bench::new([4.0, 4.0, 12.0], [PERIODIC, PERIODIC, PLATE]);
        bench.interface = Some(contact.clone());
        bench.time_step = 2.0e-5;
        bench.skin = Some(0.5);
        bench.add([2.0, 2.0, 0.6], [0.3, 0.1, -20.0], 0.5);
        let mut run = bench.alone();
        let mut touched = false;
        for _ in 0..800 {
            let walls = run.steps(1).snapshot().walls;
            let height = run.particle(0).position[2];
            match &walls[..] {
                [] => {}
                [wall] => {
                    touched = true;
                    assert!(height < 0.51, "{contact:?}: {wall:?} at {height}");
                }
                _ => panic!("{contact:?}: one particle and one wall have {walls:?}"),
            }
        }
        // The control: there was a contact, and the sphere has flown from the wall but not from its list.
        assert!(touched, "{contact:?}");
        let (height, speed) = (run.particle(0).position[2], run.particle(0).velocity[2]);
        assert!((0.55..1.0).contains(&height) && speed > 0.0, "{contact:?}: {height} {speed}");
        assert!(run.snapshot().walls.is_empty(), "{contact:?}");
    }
}

/// A piston pushes a sphere: elastic, it leaves at twice the speed of the piston.
#[test]
fn a_wall_that_comes_towards_a_sphere_is_found_by_the_list() {
    let mut bench = Bench::new([4.0, 4.0, 12.0], [PERIODIC, PERIODIC, PLATE]);
    bench.interface = Some(linear(2.0e4, 1.0, 0.3));
    bench.time_step = 1.0e-4;
    bench.skin = Some(0.05);
    bench.domain.walls[0].motion = WallMotion { velocity: Vector3::z() * 2.0, ..WallMotion::REST };
    bench.add([2.0, 2.0, 2.0], [0.0; 3], 0.5);
    let mut run = bench.alone();
    run.steps(9000);
    let speed = run.particle(0).velocity[2];
    // A contact of 160 steps: (omega dt)^2.
    assert!((speed - 4.0).abs() < 4.0 * (PI / 160.0_f64).powi(2), "{speed}");
    // Negative control: without the motion nothing happens.
    bench.domain.walls[0].motion = WallMotion::REST;
    assert_eq!(bench.alone().steps(9000).particle(0).velocity[2], 0.0);
}

/// A sphere in a round column of radius 3, weightless or falling.
fn in_column(interface: ContactModel, speed: f64) -> Bench {
    let mut bench = Bench::new([8.0, 8.0, 60.0], [OPEN; 3]);
    bench.interface = Some(interface);
    bench.time_step = 1.0e-4;
    bench.domain.walls = vec![Wall::cylinder("column", Vector3::new(4.0, 4.0, 0.0), 3.0)];
    // Pressed in by its own turning: k delta = m v^2 / (R - r + delta).
    let mass = PI / 6.0;
    let mut overlap = 0.0;
    for _ in 0..20 {
        overlap = mass * speed * speed / (2.5 + overlap) / 2.0e5;
    }
    bench.add([4.0 + 2.5 + overlap, 4.0, 50.0], [0.0, speed, 0.0], 0.5);
    bench
}

#[test]
fn a_sphere_circles_in_a_smooth_round_column_and_falls_freely() {
    let speed = 2.0;
    let mut bench = in_column(linear(2.0e5, 1.0, 0.0), speed);
    bench.gravity = GRAVITY;
    let mut run = bench.alone();
    let period = 2.0 * PI * 2.5 / speed;
    run.steps((period / bench.time_step).round() as u64);
    let sphere = run.particle(0);
    let out = Vector3::new(sphere.position[0] - 4.0, sphere.position[1] - 4.0, 0.0);
    println!("round column: back at {out:?}, z {}", sphere.position[2]);
    // The overlap of 4e-6 lengthens the way, and the step cuts the last 5e-5 of the period.
    assert!((out.x - 2.5).abs() < 1.0e-4 && out.y.abs() < 3.0e-4, "{out:?}");
    assert!((sphere.position[2] - (50.0 - 0.5 * run.time().powi(2))).abs() < 1.0e-6);
    // Negative control: a column wider by 1 % is seen.
    bench.domain.walls = vec![Wall::cylinder("column", Vector3::new(4.0, 4.0, 0.0), 3.03)];
    let mut run = bench.alone();
    run.steps((period / bench.time_step).round() as u64);
    assert!(run.particle(0).position[1] - 4.0 < -0.03);
}

#[test]
fn a_sphere_begins_to_roll_around_in_a_rough_round_column() {
    let (mu, speed) = (0.2, 2.0);
    let bench = in_column(linear(2.0e5, 0.9, mu), speed);
    let mut run = bench.alone();
    // dv/dt = -mu v^2 / 2.5 until v = 5/7 of the start.
    let slips_until = 0.4 * 2.5 / (mu * speed);
    let half = 0.5 * slips_until;
    run.steps((half / bench.time_step) as u64);
    let expected = 1.0 / (1.0 / speed + mu * run.time() / 2.5);
    let speed_of = |sphere: ParticleRecord| Vector3::from(sphere.velocity).norm();
    let found = speed_of(run.particle(0));
    println!("round column, rough: slipping at {found:.5}, closed form {expected:.5}");
    // Loading of the spring, and k delta that follows v^2 with a small swing.
    assert!((found / expected - 1.0).abs() < 1.0e-3, "{found} {expected}");
    run.steps((1.5 * slips_until / bench.time_step) as u64);
    let sphere = run.particle(0);
    let (found, spin) = (speed_of(sphere), sphere.angular_velocity[2]);
    println!("round column, rough: rolling at {found:.5}, spin {spin:.5}");
    assert!((found / (5.0 / 7.0 * speed) - 1.0).abs() < 3.0e-3, "{found}");
    // Rolling on the outside of its circle turns it the other way round, at v/r.
    assert!((spin + found / 0.5).abs() < 2.0e-2, "{spin}");
    // Negative control: smooth, it keeps its speed.
    let smooth = in_column(linear(2.0e5, 0.9, 0.0), speed);
    assert!((speed_of(smooth.alone().steps(5000).particle(0)) - speed).abs() < 1.0e-3);
}

/// The column moves along its axis and carries a sphere up; and sideways, it pushes it along.
#[test]
fn a_moving_column_carries_a_sphere() {
    let mut bench = in_column(linear(2.0e5, 0.9, 0.3), 2.0);
    bench.domain.walls[0].motion = WallMotion { velocity: Vector3::z(), ..WallMotion::REST };
    let up = bench.alone().steps(3000).particle(0).velocity[2];
    bench.domain.walls[0].motion = WallMotion::REST;
    let rest = bench.alone().steps(3000).particle(0).velocity[2];
    assert!(up > 0.05 && rest.abs() < 1.0e-12, "{up} {rest}");
    let mut bench = in_column(linear(2.0e5, 1.0, 0.0), 0.0);
    bench.add([4.0 - 2.6, 4.0, 50.0], [0.0; 3], 0.4);
    bench.skin = Some(0.05);
    bench.domain.walls[0].motion = WallMotion { velocity: Vector3::x() * 0.5, ..WallMotion::REST };
    let pushed = bench.alone().steps(9000).particle(1).velocity[0];
    assert!((pushed - 1.0).abs() < 1.0e-3, "{pushed}");
}
