//! Pair lists that last for many steps give the forces of lists rebuilt at each step, and loops for one size give those
//! of loops for many.

use super::*;
use crate::contact::{
    ByPair, ContactLaw, ContactModel, ExampleScales, Exchanges, RollingFriction, RollingKind,
    VanDerWaals,
};
use crate::numbers::{Quantum, Schedule, random_of, uniform};
use crate::particles::{ForceTorque, InteractionRanges, PairCounts};
use nalgebra::Vector3;

const COUNT: u32 = 40;
const SCALES: ExampleScales = ExampleScales { stiffness: 100.0, overlap: 0.1, restitution: 0.8 };

/// Spheres of radius 0.3 in a cube of side 3.5, with velocities.
fn particles() -> Particles {
    let mut random = random_of(1, 0, "attraction");
    let mut number = |width: f64| width * (uniform(&mut random) - 0.5);
    let mut particles = Particles::default();
    for id in 0..u64::from(COUNT) {
        let position = Vector3::from_fn(|_, _| 1.75 + number(3.5));
        let velocity = Vector3::from_fn(|_, _| number(0.0003)); // lists live for some ten steps
        particles.push(id, position, velocity, 0.3, 1.0);
    }
    particles
}

/// All pairs, without histories.
fn all_pairs() -> Contacts {
    let row_start = (0..=COUNT).map(|i| i * (COUNT - 1) - i * i.saturating_sub(1) / 2).collect();
    let partner = (0..COUNT).flat_map(|i| i + 1..COUNT).collect();
    Contacts { row_start, partner, ..Contacts::default() }
}

fn forces(
    particles: &mut Particles,
    contacts: &mut Contacts,
    laws: &ForceLaws,
) -> Vec<ForceTorque> {
    particles.forces.iter_mut().for_each(|load| *load = ForceTorque::default());
    prepare_pairs(particles, contacts, laws);
    find_contacts(particles, contacts, laws, PairGroup::Own).unwrap();
    add_contact_forces(particles, contacts, laws, PairGroup::Own).unwrap();
    particles.forces.clone()
}

/// The first of 3000 steps at which a long-lived list, given this share of the actual displacements, leads to other
/// forces than a rebuilt one; `None` if it never does.
fn first_difference(share: f64) -> Option<usize> {
    let attraction =
        VanDerWaals::square(&Schedule::Constant(10.0), &Schedule::Constant(0.0), 0.3, 0.02);
    let cohesion = ByPair::of_all(attraction.at(0.0));
    let range = cohesion.first().range();
    let mut laws = ContactLaw::examples(SCALES).into_iter();
    let law = laws.find(|law| matches!(law, ContactLaw::LinearSpringDashpot(_))).unwrap();
    let contact = ByPair::of_all(ContactModel::from(law));
    let laws = ForceLaws {
        contact: &contact,
        at_walls: &[],
        exchanges: &Exchanges::default(),
        cohesion: Some(cohesion),
        ranges: InteractionRanges { contact: 0.0, any: range, diameter: 0.6 },
        dt: 0.0, // no history
        limit: 1.0e6,
        force_quantum: Quantum::spanning(1.0e6),
        torque_quantum: Quantum::spanning(1.0e6),
    };
    let (mut particles, mut contacts) = (particles(), all_pairs());
    (0..3000).find(|_| {
        particles.body.iter_mut().for_each(|body| body.position += body.velocity);
        let largest = particles.body.iter().map(|body| body.velocity.norm()).fold(0.0, f64::max);
        contacts.moved(share * largest, PairCounts::default());
        let found = forces(&mut particles, &mut contacts, &laws);
        found != forces(&mut particles, &mut all_pairs(), &laws)
    })
}

#[test]
fn a_list_that_lives_for_many_steps_gives_the_forces_of_a_new_one() {
    assert_eq!(first_difference(1.0), None);
    assert!(first_difference(0.2).is_some(), "a control: displacements must be given");
}

/// Forces of some steps in which spheres move and spin, by the loop for one size or by the loop for many.
fn forces_of_steps(model: &ContactModel, one_size: bool) -> Vec<Vec<ForceTorque>> {
    let contact = ByPair::of_all(model.clone());
    let laws = ForceLaws {
        contact: &contact,
        at_walls: &[],
        exchanges: &Exchanges::default(),
        cohesion: None,
        ranges: InteractionRanges { contact: 0.0, any: 0.0, diameter: 0.6 },
        dt: 1.0e-2,
        limit: 1.0e6,
        force_quantum: Quantum::spanning(1.0e6),
        torque_quantum: Quantum::spanning(1.0e6),
    };
    let (mut particles, mut contacts) = (particles(), all_pairs());
    let step = |_| {
        for body in &mut particles.body {
            body.angular_velocity = body.velocity * 1.0e3;
            body.position += body.velocity;
        }
        particles.forces.iter_mut().for_each(|load| *load = ForceTorque::default());
        prepare_pairs(&particles, &mut contacts, &laws);
        contacts.inner.one_size = contacts.inner.one_size.filter(|_| one_size);
        find_contacts(&mut particles, &mut contacts, &laws, PairGroup::Own).unwrap();
        add_contact_forces(&mut particles, &mut contacts, &laws, PairGroup::Own).unwrap();
        assert_eq!(contacts.inner.one_size.is_some(), one_size);
        particles.forces.clone()
    };
    (0..10).map(step).collect()
}

#[test]
fn equal_particles_have_the_forces_that_a_loop_for_many_sizes_gives_them() {
    let rolling = [RollingKind::ConstantTorque, RollingKind::ElasticPlastic { damping: 0.3 }];
    let rolling = rolling.map(|kind| Some(RollingFriction::new(kind, 0.1).unwrap()));
    for law in ContactLaw::examples(SCALES) {
        let [none, constant, elastic] = [None, rolling[0], rolling[1]].map(|rolling| {
            let model = ContactModel { rolling, ..ContactModel::from(law.clone()) };
            let forces = forces_of_steps(&model, true);
            assert_eq!(forces, forces_of_steps(&model, false), "{model:?}");
            forces
        });
        assert!(none != constant && constant != elastic, "a control: rolling is resisted");
    }
}
