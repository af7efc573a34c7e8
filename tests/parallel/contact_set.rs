//! Touching and attracting pairs, compared with a test of all pairs one by one; the forces on both ends of a pair are
//! exactly opposite.

use crate::beds::{Bench, OPEN, PERIODIC, Run, Snapshot, attraction, branch, law};
use nalgebra::Vector3;
use std::collections::BTreeSet;
use talcum::analysis::RunView;
use talcum::domain::{Bounds, RankGrid};
use talcum::parallel::{run_on_threads, share_with_all};

const RANK_GRIDS: [[usize; 3]; 4] = [[1, 1, 1], [1, 1, 2], [1, 1, 3], [2, 2, 1]];

/// About 100 particles in a periodic box, sheared and agitated, so dense that they always touch.
fn agitated_box(diameters: &[f64]) -> Bench {
    let mut bench = Bench::new([4.6, 4.6, 6.9], [PERIODIC; 3]);
    bench.contact = law(2.0e4, 0.95, 0.2);
    bench.time_step = 5.0e-4;
    bench.add_layers(96, (1.15, 0.575), diameters, (0.0, 3.0));
    for particle in &mut bench.particles {
        particle.velocity[0] += if particle.position[2] > 3.45 { 4.0 } else { -4.0 };
    }
    bench
}

/// All pairs whose surfaces are closer than `range`, found by trying all.
fn pairs_by_trial(bounds: &Bounds, state: &Snapshot, range: f64) -> BTreeSet<(u64, u64)> {
    let particles = &state.particles;
    let mut pairs = BTreeSet::new();
    for (index, one) in particles.iter().enumerate() {
        for other in &particles[index + 1..] {
            if branch(bounds, one, other).norm() < one.radius + other.radius + range {
                pairs.insert((one.id, other.id));
            }
        }
    }
    pairs
}

fn recorded_pairs(state: &Snapshot) -> BTreeSet<(u64, u64)> {
    let pairs: BTreeSet<_> = state.pairs.iter().map(|pair| (pair.lower, pair.higher)).collect();
    assert_eq!(pairs.len(), state.pairs.len(), "each pair is recorded once");
    pairs
}

#[test]
fn the_touching_pairs_are_those_found_by_trying_all() {
    for diameters in [vec![1.0], vec![0.6, 1.0, 1.1, 0.8]] {
        let bench = agitated_box(&diameters);
        let bounds = &bench.domain.bounds;
        for grid in RANK_GRIDS {
            let changes = bench.on_ranks(grid, |run| {
                let mut changes = 0;
                let mut before = BTreeSet::new();
                for step in 1..=1000 {
                    let state = run.steps(1).snapshot();
                    let touching = recorded_pairs(&state);
                    assert_eq!(
                        touching,
                        pairs_by_trial(bounds, &state, 0.0),
                        "step {step}, {grid:?}"
                    );
                    changes += touching.symmetric_difference(&before).count();
                    before = touching;
                }
                changes
            });
            // Otherwise nothing was tested.
            assert!(changes > 400, "contacts begin and end: {changes}");
        }
    }
}

/// Negative control: the trial sees a radius that is 1 % off.
#[test]
fn a_pair_too_many_or_too_few_is_seen() {
    let bench = agitated_box(&[1.0]);
    let state = bench.alone().steps(300).snapshot();
    let bounds = &bench.domain.bounds;
    assert_eq!(recorded_pairs(&state), pairs_by_trial(bounds, &state, 0.0));
    assert_ne!(recorded_pairs(&state), pairs_by_trial(bounds, &state, 0.01));
    assert_ne!(recorded_pairs(&state), pairs_by_trial(bounds, &state, -0.01));
}

const STIFFNESS: f64 = 2.0e4;
const ATTRACTION: f64 = 3.0;
const CUT_OFF: f64 = 0.02;

/// Spring without dashpot and friction, and attraction up to `range`, on each particle, from all pairs.
fn forces_by_trial(bounds: &Bounds, state: &Snapshot, range: f64) -> Vec<Vector3<f64>> {
    let particles = &state.particles;
    let mut forces = vec![Vector3::zeros(); particles.len()];
    for (lower, higher) in pairs_by_trial(bounds, state, range) {
        let (i, j) = (lower as usize, higher as usize);
        let displacement = branch(bounds, &particles[i], &particles[j]);
        let (r1, r2) = (particles[i].radius, particles[j].radius);
        let separation = displacement.norm() - r1 - r2;
        let spring = STIFFNESS * (-separation).max(0.0);
        // F_max is that of spheres of diameter 1; r = 2 r_1 r_2 / (r_1 + r_2).
        let pull =
            ATTRACTION * 4.0 * r1 * r2 / (r1 + r2) * (CUT_OFF / separation.max(CUT_OFF)).powi(2);
        let force = displacement.normalize() * (spring - pull);
        forces[i] -= force;
        forces[j] += force;
    }
    forces
}

fn attractive_box() -> Bench {
    let mut bench = agitated_box(&[0.6, 1.0, 1.1, 0.8]);
    bench.contact = law(STIFFNESS, 1.0, 0.0);
    bench.cohesion = Some(attraction((ATTRACTION, 0.0), 1.0, (CUT_OFF, 0.2)));
    bench.skin = Some(0.03); // rebuilt often
    bench
}

fn largest_difference(state: &Snapshot, forces: &[Vector3<f64>]) -> f64 {
    let pairs = state.particles.iter().zip(forces);
    pairs.map(|(it, force)| (Vector3::from(it.force) - force).amax()).fold(0.0, f64::max)
}

#[test]
fn forces_are_those_of_all_pairs_in_reach_through_rebuild_and_migration() {
    let bench = attractive_box();
    let bounds = &bench.domain.bounds;
    for grid in [[1, 1, 1], [1, 1, 2], [1, 1, 3]] {
        let (worst, apart) = bench.on_ranks(grid, |run| {
            let (mut worst, mut apart) = (0.0_f64, 0);
            for _ in 0..600 {
                let state = run.steps(1).snapshot();
                worst =
                    worst.max(largest_difference(&state, &forces_by_trial(bounds, &state, 0.2)));
                apart += pairs_by_trial(bounds, &state, 0.2).len() - recorded_pairs(&state).len();
            }
            (worst, apart)
        });
        println!("ranks {grid:?}: largest difference of a force {worst:.1e}");
        assert!(apart > 600 * 50, "pairs attract without touching: {apart}");
        // Overlap is a difference of numbers near 7, stiffness 2e4: 2e4 x 1e-15; then a rounding of forces (limit
        // about 3e3: quantum 1e-10) for each of a dozen pairs.
        assert!(worst < 2.0e-9, "{worst:.1e}");
    }
    // Negative control: without the pairs that do not touch.
    let state = bench.alone().steps(100).snapshot();
    assert!(largest_difference(&state, &forces_by_trial(bounds, &state, 0.0)) > 0.1);
}

/// One pair, kept apart by nothing but distance, drifts through rank borders and the periodic face.
#[test]
fn an_attractive_pair_that_does_not_touch_survives_borders() {
    let mut bench = Bench::new([4.0, 4.0, 6.0], [PERIODIC; 3]);
    bench.cohesion = Some(attraction((1.0e-3, 0.0), 1.0, (0.05, 0.2)));
    bench.skin = Some(0.01);
    bench.time_step = 2.0e-3;
    let velocity = [0.9, -0.7, 2.1];
    bench.add([1.0, 1.0, 0.3], velocity, 0.5).add([1.6, 1.6, 1.0], velocity, 0.5);
    let mut ends: Vec<Snapshot> = Vec::new();
    for grid in RANK_GRIDS {
        let end = bench.on_ranks(grid, |run| {
            for _ in 0..3000 {
                let state = run.steps(1).snapshot();
                let displacement =
                    branch(&run.domain.bounds, &state.particles[0], &state.particles[1]);
                let separation = displacement.norm() - 1.0;
                assert!((0.05..0.15).contains(&separation), "{separation}");
                let pull = displacement.normalize() * 1.0e-3 * (0.05 / separation).powi(2);
                // Forces are rounded to a quantum of about 1e-9 here.
                let force = Vector3::from(state.particles[0].force);
                assert!((force - pull).amax() < 2.0e-9, "{force} {pull}");
                assert!(pull.norm() > 1.0e-4 && state.pairs.is_empty());
            }
            run.snapshot()
        });
        ends.push(end);
    }
    assert!(ends.iter().all(|end| end.bits() == ends[0].bits()));
}

/// Sum over all ranks' particles; forces are multiples of one quantum, so the sum is exact.
fn total_force(run: &Run) -> Vector3<f64> {
    let particles = &run.state.particles;
    let here: Vec<[f64; 3]> =
        particles.forces[..particles.owned_count()].iter().map(|load| load.force.into()).collect();
    share_with_all(here, run.ranks).into_iter().map(Vector3::from).sum()
}

#[test]
fn both_ends_of_a_pair_feel_exactly_opposite_forces() {
    let mut bench = agitated_box(&[0.6, 1.0, 1.1, 0.8]);
    bench.cohesion = Some(attraction((ATTRACTION, 0.0), 1.0, (CUT_OFF, 0.2)));
    let forces = |grid| {
        bench.on_ranks(grid, |run| {
            for _ in 0..400 {
                // Not a tolerance: what one end feels is the other's with the sign changed, bit for bit.
                assert_eq!(total_force(run.steps(1)), Vector3::zeros());
            }
            run.snapshot().bits()
        })
    };
    let alone = forces([1, 1, 1]);
    for grid in RANK_GRIDS {
        assert_eq!(forces(grid), alone, "{grid:?}");
    }
}

/// Negative control: the sum is not zero by itself.
#[test]
fn a_force_from_outside_is_seen_in_the_sum() {
    let mut bench = agitated_box(&[1.0]);
    bench.domain.bounds = Bounds::new(bench.domain.bounds.lengths(), [PERIODIC, PERIODIC, OPEN]);
    bench.gravity.magnitude = 1.0e-6;
    let sum = total_force(bench.alone().steps(10));
    assert!(sum.z < 0.0 && sum.x == 0.0 && sum.y == 0.0, "{sum}");
}

/// Numbers of touching neighbours by id after 300 steps: as the ranks of a grid count them, without pairs that other ranks
/// evaluate, and as the recorded pairs say.
fn coordination_numbers(grid: [usize; 3]) -> [Vec<u32>; 3] {
    let found = run_on_threads(grid.iter().product(), |ranks| {
        let mut run = agitated_box(&[1.0]).start(RankGrid(grid), ranks);
        let pairs = run.steps(300).snapshot().pairs;
        let (state, work) = (&run.state, &run.work);
        let view = RunView { state, domain: &run.domain, models: &run.models, work };
        let counted = view.coordination_numbers(ranks);
        let alone = state.contacts.touching_by_particle(&state.particles);
        let ids = state.particles.id.iter().copied();
        let numbers: Vec<_> = ids.zip(counted.into_iter().zip(alone)).collect();
        (numbers, pairs)
    });
    let mut numbers = [0; 3].map(|_| vec![0; 96]);
    for &(id, (counted, alone)) in found.iter().flat_map(|(numbers, _)| numbers) {
        numbers[0][id as usize] += counted;
        numbers[1][id as usize] += alone;
    }
    for id in found[0].1.iter().flat_map(|pair| [pair.lower, pair.higher]) {
        numbers[2][id as usize] += 1;
    }
    numbers
}

#[test]
fn neighbours_in_pairs_of_other_ranks_are_counted() {
    for grid in RANK_GRIDS {
        let [counted, alone, recorded] = coordination_numbers(grid);
        assert_eq!(counted, recorded, "{grid:?}");
        // The control: on several ranks there are such pairs.
        assert_eq!(alone == recorded, grid == [1, 1, 1], "{grid:?}");
    }
}
