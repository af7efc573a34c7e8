//! Walls of limited extent, and walls that turn: they act as the planes and columns that they are a part of, a sphere in
//! a drum rests where its torques balance, work closes the ledger of energies, and ranks change no bit.

use crate::beds::{Bench, law};
use nalgebra::{Vector2, Vector3};
use talcum::contact::{ContactModel, RollingFriction, RollingKind};
use talcum::domain::{Axis, EffectiveGravity, Face, Surface, Wall, WallRotation, WallShape};
use talcum::state::Mechanism;

const STOP: [Face; 2] = [Face::Stop; 2];
const LENGTHS: [f64; 3] = [12.0, 12.0, 12.0];
const MIDDLE: Vector3<f64> = Vector3::new(6.0, 6.0, 6.0);

/// An empty box without walls in its faces.
fn bench(contact: impl Into<ContactModel>) -> Bench {
    let mut bench = Bench::new(LENGTHS, [STOP; 3]);
    bench.interface = Some(contact.into());
    bench.gravity = EffectiveGravity { magnitude: 1.0, vibration: None };
    bench.time_step = 2.0e-4;
    bench
}

fn limited(surface: Surface) -> Wall {
    Wall::of_shape("surface", WallShape::Limited(surface))
}

fn revolved(axis: Axis, ends: [[f64; 2]; 2]) -> Wall {
    limited(Surface::Revolved { axis, ends: ends.map(Vector2::from) })
}

/// A horizontal plate at a height, as a plane, a rectangle and a disc.
fn plates(height: f64) -> [Wall; 3] {
    let centre = Vector3::new(6.0, 6.0, height);
    let half_edges = [Vector3::new(5.0, 0.0, 0.0), Vector3::new(0.0, 4.0, 0.0)];
    [
        Wall::plane("surface", centre, Vector3::z()),
        limited(Surface::Rectangle { centre, half_edges }),
        revolved(Axis { point: centre, direction: Vector3::z() }, [[0.0, 0.0], [0.0, 5.0]]),
    ]
}

/// Position, velocity and spin of a sphere that was thrown at a wall from a place.
fn thrown(wall: Wall, from: Vector3<f64>, velocity: Vector3<f64>, time: f64) -> [[f64; 3]; 3] {
    let mut bench = bench(law(2.0e4, 0.7, 0.3));
    bench.domain.walls.push(wall);
    bench.add(from.into(), velocity.into(), 0.5);
    let mut run = bench.alone();
    run.steps((time / bench.time_step).round() as u64);
    let sphere = run.particle(0);
    [sphere.position, sphere.velocity, sphere.angular_velocity]
}

#[test]
fn a_sphere_rebounds_from_plates_as_from_their_plane_to_the_bit() {
    let (from, velocity) = (Vector3::new(4.0, 6.5, 3.0), Vector3::new(1.0, -0.3, -1.0));
    let [of_plane, of_rectangle, of_disc] =
        plates(1.7).map(|wall| thrown(wall, from, velocity, 2.0));
    assert_eq!(of_rectangle, of_plane);
    assert_eq!(of_disc, of_plane);
    // Controls: the sphere has rebounded, and falls past the edge if it starts beyond it.
    assert!(of_plane[0][2] > 2.7 && of_plane[2][1] > 0.5, "{of_plane:?}");
    let beside = Vector3::new(11.6, 6.0, 3.0);
    let [_, past, _] = plates(1.7).map(|wall| thrown(wall, beside, Vector3::zeros(), 1.5));
    assert_eq!(past[2], [0.0; 3]);
    assert!((past[1][2] + 1.5).abs() < 1.0e-9, "free fall, rounded 7,500 times: {past:?}");
}

#[test]
fn plates_are_touched_from_below_too() {
    let (from, velocity) = (Vector3::new(4.0, 6.5, 3.0), Vector3::new(0.5, 0.0, 4.0));
    let [_, rectangle, disc] = plates(5.0);
    let [of_rectangle, of_disc] = [rectangle, disc].map(|wall| thrown(wall, from, velocity, 0.6));
    assert_eq!(of_rectangle, of_disc);
    assert!(of_disc[1][2] < -2.0 && of_disc[0][2] < 4.5, "{of_disc:?}");
}

#[test]
fn a_cylinder_acts_as_the_round_column_of_its_radius() {
    let (from, velocity) = (Vector3::new(7.0, 5.0, 8.0), Vector3::new(2.0, 1.0, 1.0));
    let axis = Axis { point: Vector3::new(6.0, 6.0, 1.0), direction: Vector3::z() };
    let column = thrown(Wall::cylinder("surface", MIDDLE, 4.0), from, velocity, 3.0);
    let cylinder = thrown(revolved(axis, [[0.0, 4.0], [10.0, 4.0]]), from, velocity, 3.0);
    for (one, other) in column.iter().flatten().zip(cylinder.iter().flatten()) {
        // Some hundred steps in contact with roundings of 1e-15, which impacts magnify.
        assert!((one - other).abs() < 1.0e-10, "{column:?} {cylinder:?}");
    }
    assert!(column[2][2].abs() > 0.1, "a control: it has touched the wall");
}

#[test]
fn a_sphere_meets_the_edge_of_a_plate_at_the_nearest_point() {
    // It falls beside the edge, which its surface passes at 0.3 from the middle, and is pushed aside along the line to it.
    let [_, rectangle, _] = plates(5.0);
    let from = Vector3::new(11.3, 6.0, 5.6);
    let [position, velocity, _] = thrown(rectangle, from, Vector3::zeros(), 1.0);
    assert!(velocity[0] > 0.1 && position[0] > 11.3, "{position:?} {velocity:?}");
    assert_eq!((position[1], velocity[1]), (6.0, 0.0));
}

/// A drum about an axis along y, half as long as the box, that turns right-handed at this angular speed.
fn drum(speed: f64) -> Wall {
    let axis = Axis { point: Vector3::new(6.0, 3.0, 6.0), direction: Vector3::y() };
    let rotation = WallRotation {
        axis,
        speed,
        ramp: 2.0,
        amplitude: 0.0,
        frequency: 0.0,
        start: 0.0,
        end: f64::INFINITY,
    };
    Wall { rotation: Some(rotation), ..revolved(axis, [[0.0, 4.0], [6.0, 4.0]]) }
}

/// Period of small swings of a rolling sphere at the bottom of the drum, 2 pi sqrt((7 / 5) (R - r) / g).
const SWING: f64 = 13.908;

/// Mean angle of a sphere in a drum from the vertical through the axis. It swings about its place for ever, since a constant
/// torque takes no energy from a swing: the mean is that of three periods.
fn angle_in_drum(coefficient: f64, speed: f64) -> f64 {
    let rolling = RollingFriction::new(RollingKind::ConstantTorque, coefficient).unwrap();
    let contact = ContactModel { rolling: Some(rolling), ..law(2.0e4, 0.5, 0.6).into() };
    let mut bench = bench(contact);
    // It starts over one period of a swing: the sphere, whose spin follows the drum, is then left with little of one.
    let round = drum(speed);
    let rotation = round.rotation.map(|rotation| WallRotation { ramp: SWING, ..rotation });
    bench.domain.walls.push(Wall { rotation, ..round });
    bench.add([6.0, 6.0, 2.51], [0.0; 3], 0.5);
    let mut run = bench.alone();
    run.steps((20.0 / bench.time_step) as u64);
    let (samples, mut sum) = (600, 0.0);
    let time = 3.0 * SWING;
    for _ in 0..samples {
        run.steps((time / bench.time_step) as u64 / samples);
        let sphere = run.particle(0);
        sum += ((sphere.position[0] - 6.0) / (6.0 - sphere.position[2])).atan();
    }
    sum / samples as f64
}

#[test]
fn a_sphere_in_a_drum_rests_where_rolling_friction_balances_its_weight() {
    // The torque mu_r R* N of rolling friction balances that of the tangential force m g sin theta, with N = m g cos theta and
    // R* = r at a wall: tan theta = mu_r. The wall moves towards -x at the bottom, and takes the sphere with it.
    for coefficient in [0.02, 0.05] {
        let angle = angle_in_drum(coefficient, 0.3);
        let expected = f64::atan(coefficient);
        println!("sphere in a drum, mu_r = {coefficient}: {angle:.5} rad, expected {expected:.5}");
        // An amplitude of mu_r changes the mean by mu_r^2 / 4 of it, and the period is known to 1e-3.
        assert!((angle.abs() - expected).abs() < 0.01 * expected, "{angle} {expected}");
    }
    // Negative controls: it follows the drum, and stays at the bottom without rolling friction.
    let [one, other] = [0.3, -0.3].map(|speed| angle_in_drum(0.05, speed));
    assert!(one * other < 0.0, "{one} {other}");
    assert!(angle_in_drum(0.0, 0.3).abs() < 1.0e-3);
}

/// Spheres in a drum with end plates, of which one tilts, with rolling friction.
fn tumbling() -> Bench {
    let rolling = RollingFriction::new(RollingKind::ElasticPlastic { damping: 0.3 }, 0.2).unwrap();
    let contact = ContactModel { rolling: Some(rolling), ..law(2.0e4, 0.8, 0.4).into() };
    let mut bench = bench(contact);
    let round = drum(1.5);
    let axis = round.rotation.unwrap().axis;
    let disc = |at: f64| revolved(axis, [[at, 0.0], [at, 4.0]]);
    let half_edges = [Vector3::new(2.0, 0.0, 0.0), Vector3::new(0.0, 2.9, 0.0)];
    let paddle = limited(Surface::Rectangle { centre: MIDDLE, half_edges });
    let swing =
        WallRotation { speed: 0.4, amplitude: 0.3, frequency: 0.5, ..round.rotation.unwrap() };
    for (name, wall) in [("near", disc(0.0)), ("far", disc(6.0)), ("round", round)] {
        bench.domain.walls.push(Wall { name: name.to_owned(), rotation: round_of(name), ..wall });
    }
    bench.domain.walls.push(Wall { rotation: Some(swing), ..paddle });
    add_spheres(&mut bench, 0.55);
    bench
}

/// The rotation of a part of the drum; the far end is at rest.
fn round_of(name: &str) -> Option<WallRotation> {
    drum(1.5).rotation.filter(|_| name != "far")
}

/// Adds spheres to a drum of radius 4 about the middle of the box, except within a distance of the horizontal plane
/// through its axis, where the paddle is.
pub(crate) fn add_spheres(bench: &mut Bench, distance: f64) {
    for k in 0..45_u32 {
        let [x, y, z] = [k % 3, k / 3 % 3, k / 9].map(f64::from);
        let place = Vector3::new(4.4 + 1.6 * x, 4.2 + 1.7 * y, 3.6 + 1.15 * z);
        if (place.z - 6.0).abs() > distance {
            bench.add(place.into(), [0.1 * y, 0.0, 0.0], 0.5);
        }
    }
}

/// Asserts that the work of walls, the fourth of which is a paddle, closes the ledger of energies.
pub(crate) fn assert_work_closes_the_ledger(name: &str, tumbling: impl Fn() -> Bench) {
    let balance = |part: f64| {
        let mut bench = tumbling();
        bench.time_step *= part;
        let mut run = bench.alone();
        run.keep_energy_ledger();
        run.steps((4.0 / bench.time_step).round() as u64);
        run.energy_balance().unwrap()
    };
    let [coarse, fine] = [1.0, 0.5].map(balance);
    let [first, second] = [coarse.relative_error(), fine.relative_error()];
    println!("energy ledger, {name}: {first:.2e}, {second:.2e}");
    // As in the ledgers of beds: an integrator of first order, and contacts that begin within a step.
    assert!(first < 2.0e-2 && second < 0.75 * first, "{coarse:?} {fine:?}");
    // Negative control: the work of the walls would be missed.
    let walls = fine.of(Mechanism::Walls);
    assert!(walls > 5.0 * fine.closure_error.abs() && walls > 1.0, "{fine:?}");
}

/// Asserts that ranks change no bit between walls, the fourth of which is a paddle.
pub(crate) fn assert_ranks_change_no_bit(tumbling: impl Fn() -> Bench) {
    let bench = tumbling();
    let on = |grid: [usize; 3]| {
        bench.on_ranks(grid, |run| {
            run.steps(8000);
            (run.snapshot().bits(), run.wall_forces())
        })
    };
    let alone = on([1, 1, 1]);
    for grid in [[2, 1, 1], [1, 2, 2], [2, 2, 2]] {
        assert!(on(grid) == alone, "{grid:?}");
    }
    let mut other = tumbling();
    other.domain.walls[3].rotation = None;
    let differs = other.on_ranks([1, 1, 1], |run| run.steps(8000).snapshot().bits());
    assert!(differs != alone.0, "a control: the paddle matters");
}

#[test]
fn the_work_of_turning_walls_closes_the_ledger() {
    assert_work_closes_the_ledger("drum with a paddle", tumbling);
}

#[test]
fn ranks_change_no_bit_between_turning_walls() {
    assert_ranks_change_no_bit(tumbling);
}
