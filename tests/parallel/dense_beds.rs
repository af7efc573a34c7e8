//! Dense beds, in which an error in the order of sums has a visible effect.

use crate::beds::{Bench, Mixture, PERIODIC, PLATE, attraction, gas, law, shaken};
use std::f64::consts::PI;
use talcum::contact::{ByPair, BySpecies, ContactModel};

/// Dense, cohesive, frictional, shaken, with gas: about 300 particles that fill the lower two thirds of
/// the box, so that some ranks have none.
pub(crate) fn vibrated_bed() -> Bench {
    let mut bench = Bench::new([4.2, 4.2, 30.0], [PERIODIC, PERIODIC, PLATE]);
    bench.contact = law(2.0e4, 0.6, 0.3);
    bench.cohesion = Some(attraction((5.0 * PI / 6.0, 2.0), 1.0, (1.0e-4, 0.01)));
    bench.gas = Some(gas(0.02));
    bench.gravity = shaken(3.0, 0.16);
    bench.time_step = 5.0e-4;
    bench.add_layers(300, (1.03, 0.55), &[1.0], (0.012, 0.3));
    bench
}

/// The same with three sizes of particles.
pub(crate) fn polydisperse_bed() -> Bench {
    let mut bench = vibrated_bed();
    bench.particles.clear();
    bench.add_layers(300, (1.2, 0.7), &[0.8, 1.0, 1.19], (0.0, 0.3));
    bench
}

/// The same of two species: of other friction, restitution and attraction for each pair, and at the plate.
pub(crate) fn bed_of_two_species() -> Bench {
    let mut bench = vibrated_bed();
    let model = |e: f64, mu: f64| -> ContactModel { law(2.0e4, e, mu).into() };
    let models = [[model(0.6, 0.3), model(0.5, 0.2)], [model(0.5, 0.2), model(0.8, 0.1)]];
    let strength = |one, other| 0.5 * (1 + one + other) as f64;
    bench.mixture = Some(Mixture {
        contact: ByPair::of_species(2, |one, other| models[one][other].clone()),
        at_walls: vec![BySpecies::of_species(vec![model(0.3, 0.1), model(0.9, 0.5)]).unwrap()],
        cohesion: Some(ByPair::of_species(2, |one, other| {
            let force = 5.0 * PI / 6.0 * strength(one, other);
            attraction((force, 2.0), 1.0, (1.0e-4, 0.01))
        })),
    });
    for particle in &mut bench.particles {
        particle.species = (particle.id % 3 / 2) as f64;
        particle.mass *= 1.0 + particle.species;
    }
    bench
}
