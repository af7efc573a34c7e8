//! Several species in one bed: every pair of species, and each species at a wall, obeys its own law.

use crate::beds::{Bench, Mixture, OPEN, PERIODIC, PLATE, attraction, law};
use talcum::contact::{ByPair, BySpecies, ContactForceLaw, ContactModel};
use talcum::rules::ReducedBody;

const STIFFNESS: f64 = 2.0e5;
const RADIUS: f64 = 0.5;
/// Steps in a contact: the ends of a contact lie within a step, which costs some 1 % of the speed.
const STEPS: f64 = 1000.0;
/// Restitution of the pairs (0, 0), (0, 1) and (1, 1).
const RESTITUTION: [f64; 3] = [0.9, 0.6, 0.3];
const TOLERANCE: f64 = 0.01;

fn model(restitution: f64) -> ContactModel {
    law(STIFFNESS, restitution, 0.0).into()
}

/// Three pairs that meet head on at speed 1, of the species (0, 0), (0, 1) and (1, 1), under these laws: restitution of
/// each.
fn restitutions(contact: ByPair<ContactModel>) -> [f64; 3] {
    let mut bench = Bench::new([6.0, 6.0, 20.0], [PERIODIC, PERIODIC, OPEN]);
    bench.mixture = Some(Mixture { contact, at_walls: Vec::new(), cohesion: None });
    let gap = 1.0e-4;
    for pair in 0..3 {
        let bottom = 3.0 + 6.0 * f64::from(pair);
        bench.add([3.0, 3.0, bottom], [0.0, 0.0, 0.5], RADIUS);
        bench.add([3.0, 3.0, bottom + 2.0 * RADIUS + gap], [0.0, 0.0, -0.5], RADIUS);
    }
    for (particle, species) in bench.particles.iter_mut().zip([0, 0, 0, 1, 1, 1]) {
        particle.species = f64::from(species);
    }
    let bodies = ReducedBody::of_equal_spheres(bench.particles[0].mass, RADIUS);
    let contact = law(STIFFNESS, 1.0, 0.0);
    bench.time_step = contact.contact_duration(bodies.mass, bodies.radius) / STEPS;
    let mut run = bench.alone();
    // The lowest restitution lasts twice as long as an elastic contact.
    run.steps((gap / bench.time_step + 3.0 * STEPS) as u64);
    [0, 2, 4].map(|id| run.particle(id + 1).velocity[2] - run.particle(id).velocity[2])
}

#[test]
fn each_pair_has_its_own_restitution() {
    let laws = ByPair::of_species(2, |one, other| model(RESTITUTION[one + other]));
    for (found, given) in restitutions(laws).into_iter().zip(RESTITUTION) {
        assert!((found - given).abs() < TOLERANCE, "{found} for {given}");
    }
    // Negative control: one law for all gives all pairs the first restitution.
    let of_all = restitutions(ByPair::of_all(model(RESTITUTION[0])));
    assert!(of_all.iter().all(|found| (found - RESTITUTION[0]).abs() < TOLERANCE), "{of_all:?}");
}

#[test]
fn each_species_has_its_own_restitution_at_a_wall() {
    let mut bench = Bench::new([6.0, 6.0, 20.0], [PERIODIC, PERIODIC, PLATE]);
    let given = [0.8, 0.4];
    bench.mixture = Some(Mixture {
        contact: ByPair::of_all(model(0.1)),
        at_walls: vec![BySpecies::of_species(given.map(model).to_vec()).unwrap()],
        cohesion: None,
    });
    for (species, x) in [(0.0, 1.5), (1.0, 4.5)] {
        bench.add([x, 3.0, RADIUS + 1.0e-4], [0.0, 0.0, -1.0], RADIUS);
        bench.particles.last_mut().unwrap().species = species;
    }
    let contact = law(STIFFNESS, 1.0, 0.0);
    bench.time_step = contact.contact_duration(bench.particles[0].mass, RADIUS) / STEPS;
    let mut run = bench.alone();
    run.steps(3 * STEPS as u64);
    for (id, given) in given.into_iter().enumerate() {
        let found = run.particle(id as u64).velocity[2];
        assert!((found - given).abs() < TOLERANCE, "{found} for {given}");
    }
}

/// Pairs at rest at half the range: A r / (12 s^2) of each pair, on both and opposite, to the quantum of forces.
#[test]
fn each_pair_attracts_by_its_own_constant() {
    let (cut_off, range, separation) = (1.0e-4, 0.02, 0.01);
    /// Forces are rounded to 3e-13: 3e-9 of the smallest.
    const ROUNDING: f64 = 1.0e-8;
    let strengths = [1.0, 2.5, 7.0];
    let mut bench = Bench::new([6.0, 6.0, 20.0], [PERIODIC, PERIODIC, OPEN]);
    bench.mixture = Some(Mixture {
        contact: ByPair::of_all(model(0.9)),
        at_walls: Vec::new(),
        cohesion: Some(ByPair::of_species(2, |one, other| {
            attraction((strengths[one + other], 0.0), 1.0, (cut_off, range))
        })),
    });
    bench.force_limit = Some(20.0);
    for pair in 0..3 {
        let bottom = 3.0 + 6.0 * f64::from(pair);
        bench.add([3.0, 3.0, bottom], [0.0; 3], RADIUS);
        bench.add([3.0, 3.0, bottom + 2.0 * RADIUS + separation], [0.0; 3], RADIUS);
    }
    for (particle, species) in bench.particles.iter_mut().zip([0, 0, 0, 1, 1, 1]) {
        particle.species = f64::from(species);
    }
    let run = bench.alone();
    for (pair, strength) in strengths.into_iter().enumerate() {
        let [lower, upper] = [0, 1].map(|side| run.particle(2 * pair as u64 + side).force[2]);
        let expected = strength * (cut_off / separation).powi(2);
        assert!((lower / expected - 1.0).abs() < ROUNDING, "{lower} instead of {expected}");
        assert_eq!(lower, -upper);
    }
}
