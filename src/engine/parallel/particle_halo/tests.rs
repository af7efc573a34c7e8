//! Ghosts on grids of ranks: they move like their originals, and forces on them are returned.

use super::*;
use crate::domain::{Bounds, Decomposition, Face, RankGrid};
use crate::numbers::{Quantum, random_of, uniform};
use crate::parallel::run_on_threads;
use crate::particles::{Body, Weight};
use std::collections::BTreeMap;

const WIDTH: f64 = 1.1;
const TIME_STEP: f64 = 0.01;

fn bounds() -> Bounds {
    let periodic = [Face::Periodic; 2];
    Bounds::new(Vector3::new(6.0, 2.5, 9.0), [periodic, periodic, [Face::Wall; 2]])
}

fn drift(body: &mut Body, quantum: Quantum) {
    body.position += quantum.round_vector(body.velocity * TIME_STEP);
}

/// The particles of a rank, at random, and all particles in the box by their ids.
fn particles_of(subdomain: Subdomain) -> (Particles, BTreeMap<u64, Body>) {
    let quantum = bounds().position_quantum();
    let (mut particles, mut all) = (Particles::default(), BTreeMap::new());
    let ([lower, upper], lengths) = (subdomain.corners(), bounds().lengths());
    for id in 0..300 {
        let mut random = random_of(7, id, "halo");
        let mut numbers = || Vector3::from_fn(|_, _| uniform(&mut random));
        let position = quantum.round_vector(numbers().component_mul(&lengths));
        let mut body = Body::new(position, numbers(), 0.5, 1.0);
        body.angular_velocity = numbers();
        all.insert(id, body);
        if (0..3).all(|axis| (lower[axis]..upper[axis]).contains(&position[axis])) {
            particles.push(id, position, body.velocity, 0.5, 1.0);
            particles.body.last_mut().expect("it was pushed").angular_velocity =
                body.angular_velocity;
        }
    }
    (particles, all)
}

/// Moves all particles on a grid of ranks, the ghosts too if `moves` is set. Returns for each rank the number of ghosts
/// that are copies of other ranks' particles, the number of particles that it was sent, and the number of ghosts that
/// are not at the place of an image of their original, or do not move as it does.
fn moved_on(grid: [usize; 3], moves: bool) -> Vec<[usize; 3]> {
    let (bounds, quantum) = (bounds(), bounds().position_quantum());
    let decomposition = Decomposition::even(RankGrid(grid), &bounds);
    run_on_threads(grid.iter().product(), |ranks| {
        let subdomain = decomposition.subdomain(&bounds, ranks.rank());
        let (mut particles, mut all) = particles_of(subdomain);
        let mut halo = ParticleHalo::default();
        halo.make_ghosts(&mut particles, subdomain, WIDTH, ranks);
        halo.follow(&particles, |_| true, ranks);
        let owned = particles.owned_count();
        for body in particles.body[..owned].iter_mut().chain(all.values_mut()) {
            body.velocity.x += 1.0;
            drift(body, quantum);
        }
        halo.pack_velocities(&mut particles);
        let velocities = halo.send_velocities(ranks);
        halo.receive_velocities(velocities);
        let dt = if moves { TIME_STEP } else { 0.0 };
        let weight = Weight { gravity: 0.0, quantum };
        halo.drift_copies(&mut particles, DriftStep { dt, quantum, weight });
        let is_wrong = |ghost: &usize| {
            let (id, body) = (particles.id[*ghost], particles.body[*ghost]);
            let original = all[&id];
            let shift = body.position - original.position;
            let lengths = bounds.lengths();
            let is_image = (0..3).all(|axis| [0.0, lengths[axis]].contains(&shift[axis].abs()));
            let moves = [body.velocity, body.angular_velocity];
            !is_image || moves != [original.velocity, original.angular_velocity]
        };
        let copies: usize = halo.copies.iter().map(Vec::len).sum();
        let images: usize = halo.images.iter().map(|images| images.pairs.len()).sum();
        assert_eq!(copies + images, particles.count() - owned);
        let incoming = &halo.velocities.incoming;
        let bytes: usize = incoming.iter().map(|message| message.bytes.len()).sum();
        let sent = bytes / size_of::<GhostVelocities>();
        [copies, sent, (owned..particles.count()).filter(is_wrong).count()]
    })
}

/// Pairs of an owned particle and a ghost that are nearer than the width of the halo, by their ids, on all ranks of a
/// grid, and the number of such pairs of two owned particles.
fn pairs_on(grid: [usize; 3]) -> (Vec<[u64; 2]>, usize) {
    let bounds = bounds();
    let decomposition = Decomposition::even(RankGrid(grid), &bounds);
    let found = run_on_threads(grid.iter().product(), |ranks| {
        let subdomain = decomposition.subdomain(&bounds, ranks.rank());
        let mut particles = particles_of(subdomain).0;
        ParticleHalo::default().make_ghosts(&mut particles, subdomain, WIDTH, ranks);
        let (mut with_ghosts, mut owned) = (Vec::new(), 0);
        for i in 0..particles.owned_count() {
            for j in i + 1..particles.count() {
                let branch = particles.body[j].position - particles.body[i].position;
                let ids = [particles.id[i], particles.id[j]];
                if branch.norm() >= WIDTH {
                    continue;
                }
                if j < particles.owned_count() {
                    owned += 1;
                } else {
                    with_ghosts.push([ids[0].min(ids[1]), ids[0].max(ids[1])]);
                }
            }
        }
        (with_ghosts, owned)
    });
    let owned = found.iter().map(|(_, owned)| owned).sum();
    (found.into_iter().flat_map(|(with_ghosts, _)| with_ghosts).collect(), owned)
}

#[test]
fn a_pair_with_a_ghost_is_on_one_rank_only() {
    let (images, alone) = pairs_on([1, 1, 1]);
    for grid in [[1, 1, 1], [2, 1, 1], [1, 1, 3], [2, 1, 2], [3, 1, 1], [4, 1, 4]] {
        let (mut pairs, owned) = pairs_on(grid);
        let count = pairs.len();
        assert_eq!(count + owned, images.len() + alone, "{grid:?}");
        pairs.sort_unstable();
        pairs.dedup();
        assert_eq!(pairs.len(), count, "{grid:?}");
        assert!(grid == [1, 1, 1] || count > images.len());
    }
}

#[test]
fn ghosts_move_as_their_originals_on_any_grid() {
    for grid in [[1, 1, 1], [2, 1, 1], [1, 1, 3], [2, 1, 2], [3, 1, 1]] {
        for [_, _, wrong] in moved_on(grid, true) {
            assert_eq!(wrong, 0, "{grid:?}");
        }
    }
    // Control: copies that stay behind are found.
    for [copies, _, wrong] in moved_on([2, 1, 1], false) {
        assert!(copies > 0 && wrong == copies);
    }
}

/// Puts a force and a torque on each copy, different for each particle, and sends them to the owners on a grid of
/// ranks. Returns for each rank its number of copies, the number of received forces, and the number of particles whose
/// force is not the sum of those on their copies.
fn returned_on(grid: [usize; 3]) -> Vec<[usize; 3]> {
    let bounds = bounds();
    let decomposition = Decomposition::even(RankGrid(grid), &bounds);
    run_on_threads(grid.iter().product(), |ranks| {
        let subdomain = decomposition.subdomain(&bounds, ranks.rank());
        let mut particles = particles_of(subdomain).0;
        let mut halo = ParticleHalo::default();
        halo.make_ghosts(&mut particles, subdomain, WIDTH, ranks);
        halo.follow(&particles, |_| true, ranks);
        let of_id = |id: u64| {
            let number = id as f64;
            ForceTorque::new(Vector3::new(1.0, number, 0.0), Vector3::new(0.0, 0.0, -number))
        };
        let mut counts = vec![0; particles.count()];
        let copies: Vec<u32> = halo.copies.iter().flatten().map(|&[_, ghost]| ghost).collect();
        for &ghost in &copies {
            particles.forces[ghost as usize] = of_id(particles.id[ghost as usize]);
            counts[ghost as usize] = 1;
        }
        halo.pack_forces(&mut particles);
        let forces = halo.return_forces(ranks);
        halo.receive_forces(forces);
        halo.unpack_forces(&mut particles);
        halo.return_counts(&mut counts, ranks);
        let is_wrong = |&i: &usize| {
            let (mut expected, count) = (ForceTorque::default(), counts[i]);
            (0..count).for_each(|_| expected += of_id(particles.id[i]));
            particles.forces[i] != expected
        };
        let owned = 0..particles.owned_count();
        let came: f64 = particles.forces[owned.clone()].iter().map(|load| load.force.x).sum();
        assert!(
            copies.iter().all(|&ghost| particles.forces[ghost as usize] == ForceTorque::default())
        );
        [copies.len(), came as usize, owned.filter(is_wrong).count()]
    })
}

#[test]
fn forces_on_copies_come_to_their_owners_on_any_grid() {
    for grid in [[1, 1, 1], [2, 1, 1], [1, 1, 3], [2, 1, 2], [3, 1, 1]] {
        let found = returned_on(grid);
        let [copies, came] = [0, 1].map(|k| found.iter().map(|of_rank| of_rank[k]).sum::<usize>());
        assert_eq!(copies, came, "{grid:?}");
        assert_eq!(copies > 0, grid != [1, 1, 1]);
        assert!(found.iter().all(|of_rank| of_rank[2] == 0), "{grid:?}");
    }
}

#[test]
fn a_particle_is_sent_once_to_each_rank_with_copies_of_it() {
    // The box is 2.5 wide along y: nearly every copy has an image there. None is ahead of the upper rank.
    let [[copies, sent, _], [none, ..]] = moved_on([1, 1, 2], true)[..] else { unreachable!() };
    assert!(10 * copies > 17 * sent, "{copies} copies of {sent} particles");
    assert_eq!(none, 0);
    // On three ranks along x, where only images make second copies, there are at least as many copies as particles
    // sent.
    for [copies, sent, _] in moved_on([3, 1, 1], true) {
        assert!(copies >= sent && sent > 0);
    }
}
