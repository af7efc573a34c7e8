//! The force on every wall: plate and side walls together carry the weight of a bed, and the forces of size classes add
//! up.

use crate::beds::{Bench, PERIODIC, PLATE, Reading, law};
use nalgebra::Vector3;
use talcum::domain::{EffectiveGravity, Face, Wall};
use talcum::instruments::View;

/// A bed of three sizes that falls between rough side walls.
fn bed() -> Bench {
    let mut bench = Bench::new([5.0, 5.0, 30.0], [[Face::Wall; 2], PERIODIC, PLATE]);
    bench.contact = law(2.0e4, 0.5, 0.6);
    bench.gravity = EffectiveGravity { magnitude: 1.0, vibration: None };
    bench.time_step = 4.0e-4;
    bench.add_layers(320, (1.05, 0.6), &[1.0, 0.8, 0.9], (0.04, 0.2));
    bench
}

const NAMES: [&str; 3] = ["x lower", "x upper", "base plate"];

#[test]
fn plate_and_side_walls_carry_the_weight_that_the_bed_does_not_gain_as_momentum() {
    let bench = bed();
    let mut run = bench.alone();
    run.steps(15_000);
    // The weight that acts: each particle's is rounded to the quantum of forces, 5e-10 here.
    let quantum = run.models.force_quantum;
    let weight: f64 = bench.particles.iter().map(|particle| quantum.round(particle.mass)).sum();
    let momentum = |run: &talcum::setup::Run<'_>| {
        let of = run.particles().map(|particle| particle.mass * particle.velocity[2]);
        of.sum::<f64>()
    };
    // Upwards, on the bed; by all walls, and by the plate alone.
    let carried = |run: &talcum::setup::Run<'_>| {
        let forces = run.wall_forces();
        let names: Vec<&str> = forces.iter().map(|force| force.wall.as_str()).collect();
        assert_eq!(names, NAMES);
        let up: Vec<f64> = forces.iter().map(|force| -force.force.z).collect();
        [up.iter().sum(), up[2]]
    };
    let (mut largest, mut without_sides, mut on_sides) = (0.0_f64, 0.0_f64, 0.0);
    for _ in 0..200 {
        let ([all_before, plate_before], before) = (carried(&run), momentum(&run));
        run.steps(1);
        let ([all, plate], after) = (carried(&run), momentum(&run));
        // Velocity Verlet: the mean of the forces at both ends of the step.
        let gained = (after - before) / bench.time_step;
        largest = largest.max((0.5 * (all_before + all) - weight - gained).abs());
        without_sides = without_sides.max((0.5 * (plate_before + plate) - weight - gained).abs());
        on_sides = (all - plate) / weight;
    }
    println!(
        "walls carry the weight to {largest:.1e} of {weight:.1}; side walls {on_sides:.3} of it"
    );
    // Velocities below 0.1 are rounded twice a step, each to 1e-17, and summed with rounding to 3e-17 of momenta below 0.1:
    // 320 of them, over the step.
    assert!(largest < 320.0 * 1.0e-16 / bench.time_step, "{largest}");
    // Negative control: the plate alone does not carry it.
    assert!(on_sides > 0.05 && without_sides > 0.05 * weight, "{on_sides} {without_sides}");
}

#[test]
fn forces_by_size_add_up_and_are_the_same_bits_on_any_ranks() {
    let bench = bed();
    let of = |grid: [usize; 3]| {
        bench.on_ranks(grid, |run| {
            run.work.on_walls.set_classes(vec![0.9, 0.8, 1.0]);
            run.steps(3000).wall_forces()
        })
    };
    let alone = of([1, 1, 1]);
    assert_eq!(alone.len(), 3 * 4);
    for of_wall in alone.chunks(4) {
        let diameters: Vec<_> = of_wall.iter().map(|force| force.diameter).collect();
        assert_eq!(diameters, [None, Some(0.8), Some(0.9), Some(1.0)]);
        let sum: f64 = of_wall[1..].iter().map(|force| force.force.z).sum();
        // Multiples of a quantum: their sum is exact.
        assert_eq!(sum, of_wall[0].force.z, "{of_wall:?}");
    }
    // Negative control: the sizes differ.
    let plate = &alone[8..];
    assert!(plate[1].force.z != plate[2].force.z && plate[0].force.z < -5.0, "{plate:?}");
    for grid in [[1, 1, 3], [2, 1, 2]] {
        assert_eq!(of(grid), alone, "{grid:?}");
    }
}

/// The largest difference of the force on a wall from the sum of those of single particles, over the quantum of forces and their
/// number, at many instants.
fn difference_from_single_forces(restitution: f64) -> f64 {
    let mut bench = bed();
    bench.contact = law(2.0e4, restitution, 0.0);
    let mut run = bench.alone();
    let quantum = run.models.force_quantum.spacing();
    let (mut largest, mut all) = (0.0_f64, 0);
    for _ in 0..60 {
        run.steps(50);
        let (mut sums, mut count) = ([Vector3::zeros(); 3], 0);
        let sum = |view: &View<'_>| {
            for pair in view.wall_pair_forces() {
                sums[pair.wall as usize] -= pair.contact + pair.cohesive;
                count += 1;
            }
        };
        run.look(&mut Reading(sum)).unwrap();
        let on_walls = run.wall_forces();
        let differences = on_walls.iter().zip(sums).map(|(on_wall, sum)| on_wall.force - sum);
        let difference = differences.map(|difference| difference.norm()).fold(0.0, f64::max);
        largest = largest.max(difference / quantum / f64::from(count.max(1)));
        all += count;
    }
    assert!(all > 30, "{all}");
    largest
}

#[test]
fn forces_of_single_particles_add_up_to_the_force_on_a_wall() {
    // Springs alone do not depend on velocities: each component of each force is rounded by half a quantum at most.
    let springs = difference_from_single_forces(1.0);
    assert!(springs < 0.5 * 3.0_f64.sqrt(), "{springs}");
    // Negative control: dashpots do, and the force on the wall is of the half step.
    let dashpots = difference_from_single_forces(0.5);
    assert!(dashpots > 1.0e3, "{dashpots}");
}

/// The stress on the base plate, over the weight, of a particle at rest on a wall at z = 0, where the box has this face.
fn plate_stress(lower: Face, own: Option<Wall>) -> f64 {
    let mut bench = Bench::new([4.0; 3], [PERIODIC, PERIODIC, [lower, Face::Open]]);
    bench.domain.walls.extend(own);
    bench.gravity = EffectiveGravity { magnitude: 1.0, vibration: None };
    // m g / k_n: the spring bears the weight.
    bench.add([2.0, 2.0, 0.5 - std::f64::consts::PI / 6.0 / 2.0e5], [0.0; 3], 0.5);
    let mut run = bench.alone();
    run.steps(1);
    let forces = run.wall_forces();
    assert_eq!(forces.len(), 1);
    let weight = std::f64::consts::PI / 6.0;
    // Overlaps are multiples of the quantum of positions, some 1e-15: a force of 2e-10.
    assert!((-forces[0].force.z / weight - 1.0).abs() < 1.0e-6, "the wall bears it: {forces:?}");
    let mut stress = f64::NAN;
    let read = |view: &View<'_>| stress = view.series.map_or(f64::NAN, |row| row.plate_stress);
    run.look(&mut Reading(read)).unwrap();
    stress
}

#[test]
fn base_plate_is_the_wall_in_the_lower_face_whatever_others_are_called() {
    let floor = |name: &str| Wall::plane(name, Vector3::zeros(), Vector3::z());
    assert!((plate_stress(Face::Wall, None) - 1.0).abs() < 1.0e-6);
    // Negative controls: a floor that the case defines is none, not even by this name.
    assert_eq!(plate_stress(Face::Open, Some(floor("base plate"))), 0.0);
    assert_eq!(plate_stress(Face::Open, Some(floor("floor"))), 0.0);
}
