//! One answer: the same bits on any number of ranks, in any decomposition, with any lists, through any restart.
//!
//! Equal means equal in every bit, so there are no tolerances. Each scene is dense: in a dilute one an error in the
//! order of sums would remain undetected.

use crate::beds::delayed::{Delayed, Network};
use crate::beds::{Bench, PERIODIC, PLATE, Run, Snapshot, law};
use crate::dense_beds::{bed_of_two_species, polydisperse_bed, vibrated_bed};
use std::collections::BTreeSet;
use std::time::Instant;
use talcum::analysis::{Digest, StateRecords};
use talcum::balance::Balance;
use talcum::domain::{EffectiveGravity, RankGrid};
use talcum::parallel::{OneRank, run_on_threads};

const STEPS: u64 = 3000;

/// The state after some steps.
fn after(bench: &Bench, grid: [usize; 3], steps: u64) -> Snapshot {
    bench.on_ranks(grid, |run| run.steps(steps).snapshot())
}

/// Digest of a whole state.
fn digest(state: &Snapshot) -> Digest {
    let Snapshot { particles, custom, pairs, walls, cells, clock, .. } = state;
    let records = StateRecords {
        custom,
        particles: &particles[..],
        contacts: pairs,
        wall_contacts: walls,
        cells,
        looked_at: &[],
    };
    Digest::of(clock, &records, &OneRank)
}

/// Panics with the first particle that differs.
fn assert_same_bits(one: &Snapshot, other: &Snapshot, what: &str) {
    if one.bits() == other.bits() {
        return;
    }
    let counts = |it: &Snapshot| (it.particles.len(), it.pairs.len(), it.walls.len());
    let particles = one.particles.iter().zip(&other.particles).find(|(a, b)| a != b);
    let pairs = one
        .pairs
        .iter()
        .zip(&other.pairs)
        .find(|(a, b)| bytemuck::bytes_of(*a) != bytemuck::bytes_of(*b));
    panic!("{what}: {:?} and {:?}\n{particles:?}\n{pairs:?}", counts(one), counts(other));
}

#[test]
fn any_number_of_slabs_gives_the_same_bits() {
    let bench = vibrated_bed();
    let reference = after(&bench, [1, 1, 1], STEPS);
    assert!(reference.pairs.len() > 300, "the bed is dense: {} contacts", reference.pairs.len());
    assert!(reference.pairs.iter().any(|pair| pair.state.tangential_spring != [0.0; 3]));
    for ranks in [2, 3, 4, 6, 8] {
        assert_same_bits(
            &reference,
            &after(&bench, [1, 1, ranks], STEPS),
            &format!("{ranks} slabs"),
        );
    }
}

#[test]
fn blocks_give_the_same_bits_as_one() {
    let bench = vibrated_bed();
    let reference = after(&bench, [1, 1, 1], STEPS);
    for grid in [[2, 2, 2], [2, 1, 3], [1, 3, 1]] {
        assert_same_bits(&reference, &after(&bench, grid, STEPS), &format!("blocks {grid:?}"));
    }
}

#[test]
fn messages_that_take_time_change_no_bit() {
    const LATENCY: f64 = 20.0; // microseconds
    let network = Network { latency: LATENCY, bandwidth: 1250.0 };
    for bench in [vibrated_bed(), polydisperse_bed(), bed_of_two_species()] {
        let reference = after(&bench, [1, 1, 1], STEPS);
        for grid in [[1, 1, 3], [2, 1, 2]] {
            let grid = RankGrid(grid);
            let mut found = run_on_threads(grid.size(), |ranks| {
                let delayed = Delayed { ranks, network };
                let mut run = bench.start(grid, &delayed);
                let begin = Instant::now();
                let state = run.steps(STEPS).snapshot();
                (state, begin.elapsed())
            });
            let (state, took) = found.swap_remove(0);
            assert_same_bits(&reference, &state, &format!("delayed, {grid:?}"));
            // The control: each step waits for a maximum over three or four ranks, two messages one after another.
            assert!(took.as_secs_f64() > 2.0e-6 * LATENCY * STEPS as f64, "{took:?}");
        }
    }
}

#[test]
fn load_balancing_and_skin_do_not_change_the_bits() {
    let mut bench = vibrated_bed();
    let reference = after(&bench, [1, 1, 1], STEPS);
    for (skin, every) in [(Some(0.02), 37), (Some(0.1), 250), (Some(0.4), 1000), (None, 250)] {
        bench.skin = skin;
        bench.balance = Some(Balance::new(every, 1.05));
        for grid in [[1, 1, 1], [1, 1, 3], [2, 1, 2]] {
            let what = format!("skin {skin:?}, balanced every {every} steps, ranks {grid:?}");
            let planes_moved = bench.on_ranks(grid, |run| {
                let before = run.work.decomposition.clone();
                let end = run.steps(STEPS).snapshot();
                assert_same_bits(&reference, &end, &what);
                before != run.work.decomposition
            });
            assert_eq!(planes_moved, grid[2] > 1, "{what}");
        }
    }
}

/// A later stage may have forces of a longer range, for which blocks must have room before it begins.
#[test]
fn balancing_leaves_room_for_the_ghosts_of_every_stage() {
    let mut bench = vibrated_bed();
    bench.balance = Some(Balance::new(37, 1.0));
    let narrowest = |least_width: f64| {
        bench.on_ranks([1, 1, 12], |run| {
            run.work.least_width = least_width;
            run.steps(400).work.decomposition.narrowest(2)
        })
    };
    let room = narrowest(1.9);
    assert!(room > 1.9 - 1.0e-12, "but for the rounding of planes: {room}");
    // The control: the present ghosts, 1.16 d wide, would fit into less.
    let bare = narrowest(1.16);
    assert!((1.15..1.8).contains(&bare), "{bare}");
}

#[test]
fn the_skin_follows_the_speeds_as_far_as_there_is_room() {
    let skin_after = |speed: f64, width: f64, ranks: usize| {
        let mut bench = Bench::new([width, width, 30.0], [PERIODIC, PERIODIC, PLATE]);
        bench.skin = None;
        bench.add([2.0, 2.0, 5.0], [0.0, 0.0, speed], 0.5);
        bench.on_ranks([1, 1, ranks], |run| run.steps(STEPS).work.list_range.skin)
    };
    // 2.5e-4 d in a step.
    let wide = skin_after(1.0, 4.0, 1);
    assert!((wide - (120.0_f64 * 2.5e-4).sqrt()).abs() < 1.0e-9, "{wide}");
    assert_eq!(skin_after(1.0, 4.0, 2), wide, "on two ranks as on one");
    assert_eq!(skin_after(0.01, 4.0, 1), 0.08, "slow: the narrowest");
    // Two ghost layers of a diameter and the skin fit into 2.3 d.
    let narrow = skin_after(1.0, 2.3, 1);
    assert!((0.14..0.15).contains(&narrow), "{narrow}");
    assert_eq!(skin_after(1.0, 2.161, 1), 0.08, "there is room for the narrowest only");
}

#[test]
fn a_particle_that_is_too_fast_ends_the_run_at_the_same_step_with_any_skin() {
    let end = |skin| {
        let mut bench = Bench::new([4.0, 4.0, 30.0], [PERIODIC, PERIODIC, PLATE]);
        (bench.skin, bench.time_step) = (skin, 0.01);
        bench.gravity.magnitude = 10.0;
        bench.add([2.0, 2.0, 29.0], [0.0; 3], 0.5);
        let mut run = bench.setup().start_alone().unwrap();
        run.steps(200).unwrap_err().to_string()
    };
    // 10 d in a unit of time, a tenth of d in a step, after 100 steps.
    let expected = end(Some(0.02));
    assert!(expected.contains("step 101: particle 0 moves at"), "{expected}");
    for skin in [Some(0.5), Some(0.9), None] {
        assert_eq!(end(skin), expected, "{skin:?}");
    }
}

#[test]
fn ranks_without_particles_do_not_change_the_digest() {
    const STEPS: u64 = 400;
    let bench = vibrated_bed();
    let alone = digest(&after(&bench, [1, 1, 1], STEPS));
    let ends = run_on_threads(8, |ranks| {
        let mut run = bench.start(RankGrid([1, 1, 8]), ranks);
        run.steps(STEPS);
        (run.state.particles.owned_count(), digest(&run.snapshot()))
    });
    let counts: Vec<usize> = ends.iter().map(|(count, _)| *count).collect();
    assert!(counts.contains(&0), "the scene has ranks without particles: {counts:?}");
    assert!(ends.iter().all(|(_, digest)| *digest == alone), "{ends:?} and {alone}");
    // Negative control: a step more gives another digest.
    assert_ne!(digest(&after(&bench, [1, 1, 1], STEPS + 1)), alone);
}

#[test]
fn particles_of_different_sizes_give_the_same_bits() {
    let bench = polydisperse_bed();
    let reference = after(&bench, [1, 1, 1], STEPS);
    for grid in [[1, 1, 2], [1, 1, 3], [2, 1, 3]] {
        assert_same_bits(&reference, &after(&bench, grid, STEPS), &format!("ranks {grid:?}"));
    }
}

#[test]
fn particles_of_two_species_give_the_same_bits() {
    let bench = bed_of_two_species();
    let reference = after(&bench, [1, 1, 1], STEPS);
    let species = |id: u64| id % 3 / 2;
    let kinds: BTreeSet<u64> =
        reference.pairs.iter().map(|pair| species(pair.lower) + species(pair.higher)).collect();
    assert_eq!(kinds.len(), 3, "contacts of all kinds: {kinds:?}");
    for grid in [[1, 1, 2], [1, 1, 3], [2, 1, 3], [2, 2, 2]] {
        assert_same_bits(&reference, &after(&bench, grid, STEPS), &format!("ranks {grid:?}"));
    }
    // Negative control: a ghost of the wrong species would be seen, as one particle of it is.
    let mut other = bench.clone();
    other.particles[150].species = 1.0 - other.particles[150].species;
    let end = after(&other, [1, 1, 1], STEPS);
    assert!(end.particles[..] != reference.particles[..]);
}

#[test]
fn particles_that_leave_give_the_same_bits() {
    let mut bench = vibrated_bed();
    for particle in &mut bench.particles {
        particle.position[2] += 10.0;
        particle.velocity[2] += if particle.id >= 200 { 4.0 } else { 0.0 };
    }
    let reference = after(&bench, [1, 1, 1], STEPS);
    let (left, stayed) = (reference.departed.count, reference.particles.len());
    assert!(left > 10 && stayed > 10, "some leave, some stay: {left}, {stayed}");
    assert_eq!(left as usize + stayed, bench.particles.len());
    for grid in [[1, 1, 2], [1, 1, 3], [1, 1, 8], [2, 2, 2]] {
        assert_same_bits(&reference, &after(&bench, grid, STEPS), &format!("ranks {grid:?}"));
    }
}

/// Neat towers, one particle on another, that fall without any lateral motion: many springs are exactly
/// zero, and a zero has a sign.
#[test]
fn springs_that_are_zero_give_the_same_bits() {
    let mut bench = Bench::new([5.0, 5.0, 8.0], [PERIODIC, PERIODIC, PLATE]);
    bench.contact = law(2.0e5, 0.3, 0.3);
    bench.gravity = EffectiveGravity { magnitude: 1.0, vibration: None };
    bench.add_layers(64, (1.001, 0.501), &[1.0], (0.0, 0.0));
    let reference = after(&bench, [1, 1, 1], 2000);
    assert!(!reference.pairs.is_empty() && !reference.walls.is_empty());
    for grid in [[1, 1, 2], [1, 1, 3], [2, 2, 1]] {
        assert_same_bits(&reference, &after(&bench, grid, 2000), &format!("ranks {grid:?}"));
    }
}

#[test]
fn a_restart_on_other_ranks_gives_the_bits_of_the_uninterrupted_run() {
    for bench in [vibrated_bed(), polydisperse_bed(), bed_of_two_species()] {
        let reference = after(&bench, [1, 1, 1], STEPS);
        for (first, second) in
            [([1, 1, 1], [1, 1, 3]), ([1, 1, 3], [1, 1, 2]), ([1, 1, 2], [2, 2, 2])]
        {
            let middle = after(&bench, first, STEPS / 2 + 7);
            let mut other = bench.clone();
            other.skin = Some(0.25);
            let grid = RankGrid(second);
            let ends = run_on_threads(grid.size(), |ranks| {
                let mut run = other.resume(&middle, grid, ranks);
                run.steps(STEPS - (STEPS / 2 + 7)).snapshot()
            });
            for end in &ends {
                assert_same_bits(&reference, end, &format!("{first:?}, then {second:?}"));
            }
        }
    }
}

fn resumed_alone(bench: &Bench, middle: &Snapshot) -> Snapshot {
    let mut run: Run = bench.resume(middle, RankGrid([1, 1, 1]), &OneRank);
    run.steps(1000).snapshot()
}

/// Negative controls: each thing that a state holds is needed for the same bits.
#[test]
fn a_restart_that_loses_part_of_the_state_is_detected() {
    let bench = vibrated_bed();
    let middle = after(&bench, [1, 1, 1], 1000);
    let reference = resumed_alone(&bench, &middle);
    assert_same_bits(&after(&bench, [1, 1, 1], 2000), &reference, "nothing forgotten");
    let mut without_pairs = middle.clone();
    without_pairs.pairs.clear();
    let mut without_walls = middle.clone();
    without_walls.walls.clear();
    let mut without_forces = middle.clone();
    without_forces.particles.iter_mut().for_each(|particle| particle.force = [0.0; 3]);
    let mut at_another_time = middle.clone();
    at_another_time.clock.step += 1;
    for damaged in [without_pairs, without_walls, without_forces, at_another_time] {
        let end = resumed_alone(&bench, &damaged);
        assert!(end.particles != reference.particles, "the comparison is blind");
    }
}

/// Negative control: the smallest change there is, one quantum of one position, spreads over the
/// bed and is seen.
#[test]
fn a_shift_of_one_position_quantum_is_detected() {
    let bench = vibrated_bed();
    let reference = after(&bench, [1, 1, 1], STEPS);
    let mut moved = bench.clone();
    moved.particles[150].position[0] += moved.domain.bounds.position_quantum().spacing();
    let end = after(&moved, [1, 1, 2], STEPS);
    let pairs = reference.particles.iter().zip(&end.particles);
    let differing = pairs.filter(|(a, b)| a.position != b.position).count();
    assert!(differing > 100, "{differing} of {} particles differ", end.particles.len());
}
