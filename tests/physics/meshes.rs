//! Walls of triangles: a flat mesh is a plane, a round one tends to a cylinder as its triangles become finer, an edge is
//! one wall or two according to its bend, and ranks change no bit.

use crate::beds::{Bench, Run, law};
use crate::limited_walls::{
    add_spheres, assert_ranks_change_no_bit, assert_work_closes_the_ledger,
};
use nalgebra::{Rotation3, Vector3};
use std::f64::consts::PI;
use std::sync::Arc;
use talcum::contact::{ContactModel, RollingFriction, RollingKind};
use talcum::domain::{
    Axis, EffectiveGravity, Face, Mesh, Surface, Wall, WallRotation, WallShape, join_vertices,
};

const LENGTHS: [f64; 3] = [12.0, 12.0, 12.0];
const STIFFNESS: f64 = 2.0e4;
/// Bend of an edge from which it is sharp, in degrees.
const FEATURE_ANGLE: f64 = 30.0;

/// An empty box without walls in its faces.
fn bench(contact: impl Into<ContactModel>) -> Bench {
    let mut bench = Bench::new(LENGTHS, [[Face::Stop; 2]; 3]);
    bench.interface = Some(contact.into());
    bench.gravity = EffectiveGravity { magnitude: 1.0, vibration: None };
    bench.time_step = 2.0e-4;
    bench
}

fn mesh(corners: &[Vector3<f64>], feature_angle: f64) -> Wall {
    let (vertices, numbers) = join_vertices(corners, 1.0e-9);
    let mesh = Mesh::new(vertices, numbers.as_chunks().0, feature_angle.to_radians());
    Wall::of_shape("surface", WallShape::Limited(Surface::Mesh(Arc::new(mesh.unwrap()))))
}

/// The triangles between points on a grid of two parameters from 0 to 1.
fn grid(counts: [usize; 2], point: impl Fn(f64, f64) -> Vector3<f64>) -> Vec<Vector3<f64>> {
    let at = |u: usize, v: usize| point(u as f64 / counts[0] as f64, v as f64 / counts[1] as f64);
    let square = |u: usize, v: usize| {
        let [a, b, c, d] = [at(u, v), at(u + 1, v), at(u + 1, v + 1), at(u, v + 1)];
        [a, b, c, a, c, d]
    };
    let rows = (0..counts[0]).flat_map(|u| (0..counts[1]).map(move |v| (u, v)));
    rows.flat_map(|(u, v)| square(u, v)).collect()
}

/// A plate of triangles of different sizes, tilted about y through the middle of the box by an angle.
fn plate(angle: f64) -> Vec<Vector3<f64>> {
    let tilt = Rotation3::from_axis_angle(&Vector3::y_axis(), angle);
    let middle = Vector3::new(6.0, 6.0, 3.0);
    grid([7, 5], |u, v| {
        middle + tilt * Vector3::new(12.0 * (u * u - 0.5), 10.0 * (v.powi(3) - 0.5), 0.0)
    })
}

/// A sphere at a place with a velocity, among walls.
fn with_sphere(walls: &[Wall], from: Vector3<f64>, velocity: Vector3<f64>) -> Run<'static> {
    let mut bench = bench(law(STIFFNESS, 0.7, 0.3));
    for (number, wall) in walls.iter().enumerate() {
        bench.domain.walls.push(Wall { name: number.to_string(), ..wall.clone() });
    }
    bench.add(from.into(), velocity.into(), 0.5);
    bench.alone()
}

/// Position, velocity and spin of a sphere that was thrown at a wall.
fn thrown(wall: &Wall, from: Vector3<f64>, velocity: Vector3<f64>, time: f64) -> [[f64; 3]; 3] {
    let mut run = with_sphere(std::slice::from_ref(wall), from, velocity);
    run.steps((time / 2.0e-4).round() as u64);
    let sphere = run.particle(0);
    [sphere.position, sphere.velocity, sphere.angular_velocity]
}

#[test]
fn a_flat_mesh_acts_as_its_plane_to_the_bit() {
    let (from, velocity) = (Vector3::new(3.0, 8.0, 4.0), Vector3::new(1.2, -0.8, -0.5));
    let plane = Wall::plane("surface", Vector3::new(6.0, 6.0, 3.0), Vector3::z());
    let of_plane = thrown(&plane, from, velocity, 4.0);
    let of_mesh = thrown(&mesh(&plate(0.0), FEATURE_ANGLE), from, velocity, 4.0);
    assert_eq!(of_mesh, of_plane);
    // Control: it has rebounded, and rolled over several triangles.
    assert!(of_plane[0][0] > 6.0 && of_plane[2][1] > 0.5, "{of_plane:?}");
}

#[test]
fn a_sphere_rolls_down_a_tilted_mesh_as_down_its_plane() {
    let angle = 0.3_f64;
    let normal = Vector3::new(angle.sin(), 0.0, angle.cos());
    let middle = Vector3::new(6.0, 6.0, 3.0);
    // Where the spring carries the weight, so that it does not bounce.
    let overlap = PI / 6.0 * angle.cos() / STIFFNESS;
    let from =
        middle + normal * (0.5 - overlap) + Vector3::new(-angle.cos(), 0.2, angle.sin()) * 2.0;
    let plane = Wall::plane("surface", middle, normal);
    let walls = [plane, mesh(&plate(angle), FEATURE_ANGLE)];
    let time = 4.0;
    let [of_plane, of_mesh] = walls.map(|wall| thrown(&wall, from, Vector3::zeros(), time));
    for (one, other) in of_plane.iter().flatten().zip(of_mesh.iter().flatten()) {
        // Distances differ by 1e-15, so that forces differ by the stiffness times this, at each of 20,000 steps.
        assert!((one - other).abs() < 5.0e-11, "{of_plane:?} {of_mesh:?}");
    }
    // A solid sphere rolls with (5/7) g sin(angle); its springs swing in the first contact.
    let down = |place: [f64; 3]| {
        (Vector3::from(place) - from).dot(&Vector3::new(angle.cos(), 0.0, -angle.sin()))
    };
    let expected = 0.5 * (5.0 / 7.0) * angle.sin() * time * time;
    println!("rolled down a mesh: {:.5}, closed form {expected:.5}", down(of_mesh[0]));
    assert!((down(of_mesh[0]) / expected - 1.0).abs() < 2.0e-3, "{} {expected}", down(of_mesh[0]));
    // Negative control: without rolling it would slide with g sin(angle).
    assert!((down(of_mesh[0]) / (1.4 * expected) - 1.0).abs() > 0.2);
}

/// A drum about an axis along y with so many flat sides, which touch the round one from outside.
fn drum(sides: usize, feature_angle: f64) -> Wall {
    let corners = grid([sides, 2], |u, v| {
        // The lowest point is the middle of a side.
        let angle = 2.0 * PI * u + PI / sides as f64;
        let angle = if u == 1.0 { PI / sides as f64 } else { angle };
        let radius = 4.0 / (PI / sides as f64).cos();
        Vector3::new(6.0 + radius * angle.sin(), 3.0 + 6.0 * v, 6.0 - radius * angle.cos())
    });
    mesh(&corners, feature_angle)
}

fn round_drum() -> Wall {
    let axis = Axis { point: Vector3::new(6.0, 3.0, 6.0), direction: Vector3::y() };
    let ends = [[0.0, 4.0], [6.0, 4.0]].map(Into::into);
    Wall::of_shape("surface", WallShape::Limited(Surface::Revolved { axis, ends }))
}

/// Places of a sphere that swings in a drum, and the largest of its energies of motion and height, less the first.
fn swings(wall: &Wall) -> (Vec<f64>, f64) {
    let angle = 0.5_f64;
    let from = Vector3::new(6.0 + 3.5 * angle.sin(), 6.0, 6.0 - 3.5 * angle.cos());
    let mut run = with_sphere(std::slice::from_ref(wall), from, Vector3::zeros());
    let (mut places, mut highest) = (Vec::new(), f64::NEG_INFINITY);
    for _ in 0..100 {
        run.steps(700);
        let sphere = run.particle(0);
        let [speed, spin] =
            [sphere.velocity, sphere.angular_velocity].map(|it| Vector3::from(it).norm_squared());
        let energy = 0.5 * speed + 0.2 * 0.25 * spin + sphere.position[2];
        places.push(sphere.position[0]);
        highest = highest.max(energy - from.z);
    }
    (places, highest)
}

#[test]
fn swings_in_a_drum_of_triangles_tend_to_those_in_a_round_one() {
    let (round, _) = swings(&round_drum());
    let mut errors = Vec::new();
    for sides in [64, 256, 1024] {
        let (places, gained) = swings(&drum(sides, FEATURE_ANGLE));
        let error = places.iter().zip(&round).map(|(one, other)| (one - other).abs());
        errors.push(error.fold(0.0, f64::max));
        println!(
            "drum of {sides} sides: error {:.2e}, energy gained {gained:.1e}",
            errors.last().unwrap()
        );
        // A sphere whose weight presses its springs holds 7e-6 of energy in them.
        assert!(gained < 1.0e-4, "{sides} sides: {gained}");
    }
    assert!(errors[1] < 0.5 * errors[0] && errors[2] < errors[1], "{errors:?}");
    assert!(errors[2] < 0.01, "{errors:?}");
}

/// The overlap of a sphere at rest at the bottom of a drum, times the stiffness, over its weight.
fn load_at_rest(wall: &Wall) -> f64 {
    let mut run =
        with_sphere(std::slice::from_ref(wall), Vector3::new(6.0, 6.0, 2.4999), Vector3::zeros());
    run.steps(60_000);
    STIFFNESS * (2.5 - run.particle(0).position[2]) / (PI / 6.0)
}

#[test]
fn the_force_does_not_grow_with_the_number_of_triangles() {
    for sides in [64, 1024] {
        let load = load_at_rest(&drum(sides, FEATURE_ANGLE));
        println!("drum of {sides} sides: load {load:.6} of the weight");
        // The oscillation of the first contact has decayed by its dashpot.
        assert!((load - 1.0).abs() < 1.0e-6, "{sides} sides: {load}");
    }
    // Negative control: each of the fine sides that the sphere touches as a wall of its own.
    let load = load_at_rest(&drum(1024, 0.0));
    assert!(load < 0.6, "{load}");
}

/// A trench along y whose sides fall towards each other by these angles.
fn trench(angle: f64, feature_angle: f64) -> Wall {
    let corners = grid([2, 3], |u, v| {
        let out = 8.0 * (u - 0.5);
        Vector3::new(6.0 + out, 2.0 + 8.0 * v, 3.0 + out.abs() * angle.tan())
    });
    mesh(&corners, feature_angle)
}

/// The normal force of each side of a trench without friction on a sphere at rest in it, over its weight.
fn force_in_trench(angle: f64) -> f64 {
    let mut bench = bench(law(STIFFNESS, 0.7, 0.0));
    bench.domain.walls.push(trench(angle, FEATURE_ANGLE));
    bench.add([6.0, 6.0, 3.0 + 0.4999 / angle.cos()], [0.0; 3], 0.5);
    let mut run = bench.alone();
    run.steps(60_000);
    let height = (run.particle(0).position[2] - 3.0) * angle.cos();
    STIFFNESS * (0.5 - height) / (PI / 6.0)
}

#[test]
fn a_sphere_in_a_sharp_corner_has_two_springs() {
    // Two normal forces at the angle of the sides carry the weight: each is W / (2 cos(angle)).
    for degrees in [20.0_f64, 45.0] {
        let angle = degrees.to_radians();
        let (force, expected) = (force_in_trench(angle), 0.5 / angle.cos());
        println!("trench of {degrees} degrees: {force:.6} of the weight, expected {expected:.6}");
        // The oscillation of the first contact has decayed by its dashpot.
        assert!((force / expected - 1.0).abs() < 1.0e-6, "{degrees}: {force} {expected}");
    }
    // Negative control: a bend below the feature angle makes one contact, which carries the whole weight alone.
    let angle = 10.0_f64.to_radians();
    let force = force_in_trench(angle);
    assert!((force / (0.5 / angle.cos()) - 1.0).abs() > 0.5, "{force}");
}

#[test]
fn a_sphere_between_two_meshes_touches_both() {
    // The two halves of a trench of 45 degrees, each a wall of its own.
    let half = |side: f64| {
        let corners =
            grid([2, 3], |u, v| Vector3::new(6.0 + 4.0 * side * u, 2.0 + 8.0 * v, 3.0 + 4.0 * u));
        mesh(&corners, FEATURE_ANGLE)
    };
    let mut bench = bench(law(STIFFNESS, 0.7, 0.0));
    for (name, side) in [("left", -1.0), ("right", 1.0)] {
        bench.domain.walls.push(Wall { name: name.to_owned(), ..half(side) });
    }
    bench.add([6.0, 6.0, 3.0 + 0.4999 * 2.0_f64.sqrt()], [0.0; 3], 0.5);
    let mut run = bench.alone();
    run.steps(60_000);
    let height = (run.particle(0).position[2] - 3.0) * 0.5_f64.sqrt();
    let force = STIFFNESS * (0.5 - height) / (PI / 6.0);
    // As in a trench of one mesh, whose test has the reason for the tolerance and the control.
    assert!((force / 0.5_f64.sqrt() - 1.0).abs() < 1.0e-6, "{force}");
}

#[test]
fn a_sphere_rolls_over_convex_edges_without_gaining_energy() {
    for degrees in [1.0, 5.0, 10.0, 20.0, 29.0, 31.0_f64] {
        // A roof: it rolls along the flat side, over the ridge, and down the other side.
        let fall = degrees.to_radians().tan();
        let corners = grid([2, 3], |u, v| {
            let out = 10.0 * (u - 0.5);
            Vector3::new(6.0 + out, 2.0 + 8.0 * v, 5.0 - out.max(0.0) * fall)
        });
        let from = Vector3::new(5.0, 6.0, 5.5);
        let roof = [mesh(&corners, FEATURE_ANGLE)];
        let mut run = with_sphere(&roof, from, Vector3::new(0.3, 0.0, 0.0));
        let mut energies = Vec::new();
        for _ in 0..50 {
            run.steps(800);
            let sphere = run.particle(0);
            let [speed, spin] = [sphere.velocity, sphere.angular_velocity]
                .map(|it| Vector3::from(it).norm_squared());
            energies.push(0.5 * speed + 0.05 * spin + sphere.position[2]);
        }
        let end = run.particle(0);
        let gained = energies[49] - energies[10];
        println!(
            "ridge of {degrees} degrees: x {:.3}, energy gained {gained:.2e}",
            end.position[0]
        );
        assert!(end.position[0] > 6.5, "it has passed the ridge");
        // It rolls already when it comes to the ridge; there it slips a little, which costs energy. Its weight in the
        // contact stores 2e-5 of energy, and heights are those of a centre that sinks by 2.6e-5.
        assert!(gained < 1.0e-4 && gained > -0.05, "{degrees}: {energies:?}");
    }
}

/// Spheres in a turning drum of 48 flat sides with a paddle that is a mesh too.
fn tumbling() -> Bench {
    let rolling = RollingFriction::new(RollingKind::ElasticPlastic { damping: 0.3 }, 0.2).unwrap();
    let contact = ContactModel { rolling: Some(rolling), ..law(STIFFNESS, 0.8, 0.4).into() };
    let mut bench = bench(contact);
    let axis = Axis { point: Vector3::new(6.0, 3.0, 6.0), direction: Vector3::y() };
    let still = WallRotation {
        axis,
        speed: 0.0,
        ramp: 1.0,
        amplitude: 0.0,
        frequency: 0.0,
        start: 0.0,
        end: f64::INFINITY,
    };
    let paddle = mesh(
        &grid([3, 3], |u, v| {
            Vector3::new(4.0 + 4.0 * u, 3.1 + 5.8 * v, 6.0 + 0.3 * (6.0 * u).sin())
        }),
        FEATURE_ANGLE,
    );
    let end = |at: f64| {
        Wall::plane("end", Vector3::new(0.0, at, 0.0), Vector3::y() * (6.0 - at).signum())
    };
    let swing = WallRotation { speed: 0.4, amplitude: 0.3, frequency: 0.5, ..still };
    let walls = [
        ("near", None, end(3.0)),
        ("far", None, end(9.0)),
        ("drum", Some(WallRotation { speed: 1.5, ..still }), drum(48, FEATURE_ANGLE)),
        ("paddle", Some(swing), paddle),
    ];
    for (name, rotation, wall) in walls {
        bench.domain.walls.push(Wall { name: name.to_owned(), rotation, ..wall });
    }
    add_spheres(&mut bench, 0.85);
    bench
}

#[test]
fn the_work_of_turning_meshes_closes_the_ledger() {
    assert_work_closes_the_ledger("meshed drum with a paddle", tumbling);
}

#[test]
fn ranks_change_no_bit_between_turning_meshes() {
    assert_ranks_change_no_bit(tumbling);
}
