//! The force over the overlap, point by point, and the work of closed loops: no contact creates energy.

use nalgebra::Vector3;
use proptest::prelude::*;
use std::f64::consts::PI;
use talcum::contact::{
    AdhesiveElasticPlastic, Contact, ContactForce, ContactForceLaw, ContactLaw, ContactModuli,
    ExampleScales, FrictionCap, HystereticParameters, Jkr, Reloading,
};
use talcum::particles::ContactHistory;

const F0: f64 = 0.3;
const PRIMARY: f64 = 0.5;

/// Stiffnesses 0.8 and 1 without dashpot.
fn parameters() -> HystereticParameters {
    HystereticParameters {
        loading_stiffness: 0.8,
        unloading_stiffness: 1.0,
        tangential_stiffness: 0.5,
        restitution: 1.0,
        friction: 0.4,
    }
}

fn adhesive(primary_diameter: f64) -> AdhesiveElasticPlastic {
    AdhesiveElasticPlastic::new(parameters(), F0, primary_diameter).unwrap()
}

const MODULI: ContactModuli = ContactModuli { normal: 1.0, shear: 0.3 };

/// Every law of the registry, without dashpots, for R* = 1 and overlaps of order 1.
fn laws() -> Vec<ContactLaw> {
    ContactLaw::examples(ExampleScales { stiffness: 1.0, overlap: 1.0, restitution: 1.0 })
}

#[test]
fn every_law_of_the_registry_gives_examples_of_itself() {
    for name in ContactLaw::NAMES {
        assert!(laws().iter().any(|law| law.name() == *name), "{name}");
    }
}

fn contact(overlap: f64, relative_velocity: Vector3<f64>) -> Contact {
    Contact {
        overlap,
        normal: Vector3::z(),
        relative_velocity,
        relative_spin: Vector3::zeros(),
        reduced_mass: 1.0,
        reduced_radius: 1.0,
        reduced_inertia: 0.4,
        cohesion: 0.0,
    }
}

/// Two bodies that are moved by hand.
struct Hand<'a> {
    law: &'a ContactLaw,
    history: ContactHistory,
    overlap: f64,
    /// Work done on the contact so far.
    work: f64,
    last: ContactForce,
}

impl<'a> Hand<'a> {
    fn new(law: &'a ContactLaw) -> Self {
        let (history, last) = (ContactHistory::default(), ContactForce::zero());
        Self { law, history, overlap: 0.0, work: 0.0, last }
    }

    /// At rest where it is.
    fn contact(&self) -> Contact {
        contact(self.overlap, Vector3::zeros())
    }

    /// A step to another overlap, with a slip on the way; in a time of 1.
    fn step(&mut self, overlap: f64, slip: [f64; 2]) -> ContactForce {
        let separation = self.overlap - overlap;
        let displacement = Vector3::new(slip[0], slip[1], separation);
        let contact = contact(overlap, displacement);
        let force = if self.law.touches(&contact, &self.history) {
            self.law.force(&contact, &mut self.history, 1.0)
        } else {
            self.history = ContactHistory::default();
            ContactForce::zero()
        };
        let total = |force: &ContactForce| Vector3::z() * force.normal + force.tangential;
        // Trapezoid; where a contact begins or ends, the force of the contact counts.
        let mean = match (self.last.normal, force.normal) {
            (0.0, _) => total(&force),
            (_, 0.0) => total(&self.last),
            _ => 0.5 * (total(&self.last) + total(&force)),
        };
        self.work -= mean.dot(&displacement);
        (self.overlap, self.last) = (overlap, force);
        force
    }

    /// Slowly, in many steps.
    fn go(&mut self, overlap: f64, slip: [f64; 2]) -> ContactForce {
        const STEPS: u32 = 2000;
        let begin = self.overlap;
        for step in 1..=STEPS {
            let part = f64::from(step) / f64::from(STEPS);
            self.step(
                begin + part * (overlap - begin),
                slip.map(|displacement| displacement / f64::from(STEPS)),
            );
        }
        self.last
    }
}

#[test]
fn the_loop_of_the_adhesive_law_goes_where_the_model_says() {
    let law = ContactLaw::AdhesiveElasticPlastic(adhesive(PRIMARY));
    let mut hand = Hand::new(&law);
    let near = |force: ContactForce, expected: f64| {
        assert!((force.normal - expected).abs() < 1.0e-12, "{} for {expected}", force.normal);
    };
    near(hand.go(2.0, [0.0; 2]), 0.8 * 2.0 - F0);
    let plastic = 0.2 * 2.0;
    near(hand.go(1.5, [0.0; 2]), 1.5 - plastic - F0);
    near(hand.go(1.8, [0.0; 2]), 1.8 - plastic - F0);
    // The limit of adhesion: at delta_ad = delta_p + (f_ad + F0) / k_unload.
    let limit = -(plastic / PRIMARY + 1.0) * F0;
    let at_limit = plastic + (limit + F0) / 1.0;
    near(hand.go(at_limit, [0.0; 2]), limit);
    // From there a straight line to -F0 at delta = 0.
    let x = 0.6;
    let on_line = x * at_limit;
    near(hand.go(on_line, [0.0; 2]), (1.0 - x) * -F0 + x * limit);
    // Pressed again, it climbs with k_unload from there, up to the loading line, and continues along that.
    let force = hand.last.normal;
    near(hand.go(on_line + 0.05, [0.0; 2]), force + 0.05);
    // With k_c = 0.3 / (0.5 - 0.3) the lines cross at (1 + 1.5) / 0.2 of the overlap where it turned.
    let crossing = on_line * 2.5 / 0.2;
    near(hand.go(crossing - 0.1, [0.0; 2]), 0.8 * crossing - 0.1 - F0);
    near(hand.go(crossing + 0.1, [0.0; 2]), 0.8 * (crossing + 0.1) - F0);
    // Parted, everything is forgotten.
    hand.go(-0.1, [0.0; 2]);
    assert_eq!(hand.history, ContactHistory::default());
    near(hand.go(0.1, [0.0; 2]), 0.08 - F0);
    // Negative control: with larger primary particles the limit lies higher.
    let other = ContactLaw::AdhesiveElasticPlastic(adhesive(2.0 * PRIMARY));
    let mut hand = Hand::new(&other);
    hand.go(2.0, [0.0; 2]);
    assert!((hand.go(at_limit, [0.0; 2]).normal - limit).abs() > 0.05);
}

#[test]
fn a_contact_on_the_limit_of_adhesion_goes_back_along_it_where_that_is_chosen() {
    let of =
        |reloading| ContactLaw::AdhesiveElasticPlastic(adhesive(PRIMARY).with_reloading(reloading));
    let along = of(Reloading::AlongLimit);
    let stored = |hand: &Hand| hand.law.stored_energy(&hand.contact(), &hand.history).normal;
    let (plastic, stiffness) = (0.2 * 2.0_f64, 1.5); // k_c = 0.3 / (0.5 - 0.3)
    let at_limit = plastic / (1.0 + stiffness);
    let mut hand = Hand::new(&along);
    hand.go(2.0, [0.0; 2]);
    let (work, energy) = (hand.work, stored(&hand));
    // Down the unloading line, onto the limit, back along it, and up the same unloading line.
    for overlap in [0.5 * at_limit, 0.8 * at_limit, 1.5] {
        let expected = (overlap - plastic).max(-stiffness * overlap) - F0;
        let found = hand.go(overlap, [0.0; 2]).normal;
        assert!((found - expected).abs() < 1.0e-12, "{found} for {expected}");
        // No energy is lost on the way. Where the lines meet within a step, trapezoids miss (1.5 + 1) / 8 of its square.
        let change = stored(&hand) - energy;
        assert!((hand.work - work - change).abs() < 1.0e-6, "{} {change}", hand.work - work);
    }
    // Negative control: with the unloading line through the present point the force is another, and energy is lost.
    let from = of(Reloading::FromLimit);
    let mut hand = Hand::new(&from);
    hand.go(2.0, [0.0; 2]);
    let (work, energy) = (hand.work, stored(&hand));
    hand.go(0.5 * at_limit, [0.0; 2]);
    hand.go(0.8 * at_limit, [0.0; 2]);
    assert!(hand.last.normal > -stiffness * 0.8 * at_limit - F0 + 0.05);
    assert!(hand.work - work > stored(&hand) - energy + 1.0e-3);
}

#[test]
fn adhesion_resists_sliding_unless_the_net_force_limits_friction() {
    // At the overlap where spring and attraction balance: mu F0, or nothing.
    let balance = F0 / 0.8;
    for (cap, expected) in [(FrictionCap::Contact, 0.4 * F0), (FrictionCap::Net, 0.0)] {
        let law = ContactLaw::AdhesiveElasticPlastic(adhesive(PRIMARY).with_friction_cap(cap));
        let mut hand = Hand::new(&law);
        hand.go(balance, [0.0; 2]);
        let found = hand.go(balance, [2.0, 0.0]).tangential.norm();
        assert!((found - expected).abs() < 1.0e-12, "{cap:?}: {found} for {expected}");
        // Pressed on, the cap follows: without dashpots F_n + F0 = 0.8 delta.
        let pressed = hand.go(2.0 * balance, [2.0, 0.0]);
        let limit = if cap == FrictionCap::Net { F0 } else { 2.0 * F0 };
        assert!((pressed.tangential.norm() - 0.4 * limit).abs() < 1.0e-12);
    }
}

#[test]
fn the_pull_of_jkr_is_8_9_at_zero_overlap_1_at_most_and_5_9_at_the_end() {
    let law = Jkr::new(MODULI, 0.05, 1.0, 0.4).unwrap();
    let (pull_off, range) = (3.0 * PI * 0.05, law.contact_range(1.0));
    let model = ContactLaw::Jkr(law);
    let mut hand = Hand::new(&model);
    // In the curve of the two formulas: delta of a, for the F of a.
    for a in [0.7, 0.9, 1.2, 2.0] {
        let delta = a * a - 2.0 * (PI * 0.05 * a / 1.0_f64).sqrt();
        let force = 4.0 * a.powi(3) / 3.0 - 4.0 * (PI * 0.05 * a.powi(3)).sqrt();
        hand.step(1.0e-9, [0.0; 2]); // a neck to begin with
        let found = hand.step(delta, [0.0; 2]).normal;
        assert!((found - force).abs() < 1.0e-13 * (1.0 + force.abs()), "{found} for {force}");
        // Negative control: the force of Hertz alone.
        assert!((found - 4.0 / 3.0 * delta.max(0.0).powf(1.5)).abs() > 0.05);
    }
    hand.step(1.0e-14, [0.0; 2]);
    assert!((hand.last.normal / pull_off + 8.0 / 9.0).abs() < 1.0e-12);
    let mut most = 0.0_f64;
    for step in 0..4000 {
        let overlap = -range * f64::from(step) / 4000.0;
        most = most.max(-hand.step(overlap, [0.0; 2]).normal);
    }
    // The maximum is quadratic in the steps of 1/4000.
    assert!((most / pull_off - 1.0).abs() < 1.0e-6, "{most}");
    // At the end the slope is infinite: sqrt(1e-9) of what is left.
    let end = hand.step(-range * (1.0 - 1.0e-9), [0.0; 2]).normal;
    assert!((end / pull_off + 5.0 / 9.0).abs() < 1.0e-4, "{}", end / pull_off);
    assert_eq!(hand.step(-range * (1.0 + 1.0e-12), [0.0; 2]), ContactForce::zero());
    // The neck is torn: coming back, nothing acts until the spheres overlap.
    assert_eq!(hand.step(-0.5 * range, [0.0; 2]), ContactForce::zero());
    assert!(hand.step(1.0e-9, [0.0; 2]).normal < 0.0);
}

fn path() -> impl Strategy<Value = Vec<(f64, [f64; 2])>> {
    let turn = (-0.1..2.0f64, prop::array::uniform2(-2.0..2.0f64));
    prop::collection::vec(turn, 2..8)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(30))]

    /// Overlap and slip go from place to place, and at the end the bodies part: what is stored is lost.
    #[test]
    fn no_contact_makes_energy(path in path()) {
        for law in laws() {
            let mut hand = Hand::new(&law);
            let mut wrong = Hand::new(&law);
            for (overlap, slip) in &path {
                hand.go(*overlap, *slip);
                wrong.go(*overlap, *slip);
            }
            hand.go(-2.0, [0.0; 2]);
            // Forces of order 3 over ways of order 2 in steps of 1/2000: each turn and each end of a contact
            // is known to one step.
            let tolerance = 3.0 * 2.0 * 2.0 / 2000.0 * (path.len() + 1) as f64;
            prop_assert!(hand.work > -tolerance, "{law:?}: {}", hand.work);
        }
    }

    #[test]
    fn every_law_is_odd_bit_for_bit(
        direction in prop::array::uniform3(-1.0..1.0f64), velocity in prop::array::uniform3(-1.0..1.0f64),
        spring in prop::array::uniform3(-0.1..0.1f64), overlap in -0.05..1.0f64, largest in 0.0..1.5f64,
    ) {
        let direction = Vector3::from(direction);
        prop_assume!(direction.norm() > 0.1);
        for law in laws() {
            let contact = Contact {
                overlap, normal: direction.normalize(), relative_velocity: velocity.into(),
                relative_spin: Vector3::zeros(), reduced_mass: 0.3, reduced_radius: 0.4,
                reduced_inertia: 0.02, cohesion: 0.0,
            };
            let mirrored = Contact {
                normal: -contact.normal, relative_velocity: -contact.relative_velocity, ..contact
            };
            let mut here = ContactHistory { tangential_spring: spring.into(), largest_overlap: largest };
            let mut there = ContactHistory { tangential_spring: -here.tangential_spring, ..here };
            prop_assert_eq!(law.touches(&contact, &here), law.touches(&mirrored, &there));
            if !law.touches(&contact, &here) {
                continue;
            }
            let first = law.force(&contact, &mut here, 1.0e-2);
            let second = law.force(&mirrored, &mut there, 1.0e-2);
            prop_assert_eq!((first.normal, first.friction_normal), (second.normal, second.friction_normal));
            prop_assert_eq!(first.tangential, -second.tangential);
            prop_assert_eq!(here.tangential_spring, -there.tangential_spring);
            prop_assert_eq!(here.largest_overlap, there.largest_overlap);
        }
    }
}

/// A contact and a history that differ from number to number.
fn nth_contact(number: u32) -> (Contact, ContactHistory) {
    // Numbers from -1 to 1 of low-discrepancy sequences.
    let drawn = |stream: u32| {
        let steps = f64::from(number) * (0.754_877_666 + 0.1 * f64::from(stream)).fract();
        2.0 * steps.fract() - 1.0
    };
    let vector = |first: u32| Vector3::new(drawn(first), drawn(first + 1), drawn(first + 2));
    let contact = Contact {
        normal: vector(0).normalize(),
        reduced_mass: 0.3,
        ..contact(0.6 + 0.4 * drawn(3), vector(4))
    };
    let tangential_spring = 0.4 * vector(7);
    (contact, ContactHistory { tangential_spring, largest_overlap: 1.0 + drawn(10) })
}

#[test]
fn the_sticking_force_of_a_law_becomes_its_force_by_sliding_and_stays_where_surfaces_stick() {
    let dt = 1.0e-2;
    for law in laws() {
        let (mut sticking, mut sliding) = (0, 0);
        for number in 1..1000 {
            let (contact, start) = nth_contact(number);
            let [mut history, mut expected_history] = [start; 2];
            let expected = law.force(&contact, &mut expected_history, dt);
            let (mut force, slides) = law.sticking_force(&contact, &mut history, dt);
            if slides {
                sliding += 1;
                assert_ne!(force.tangential, expected.tangential, "a control");
            } else {
                sticking += 1;
                assert_eq!((force, history), (expected, expected_history), "{law:?}");
            }
            law.slide(&contact, &mut history, &mut force);
            assert_eq!((force, history), (expected, expected_history), "{law:?}");
        }
        // Laws whose tangential stiffness follows from the overlap are evaluated as a whole.
        let separates = !["hertz_mindlin", "jkr"].contains(&law.name());
        assert!(sticking > 100 && (sliding > 100) == separates, "{law:?}: {sticking}, {sliding}");
    }
}

/// Negative control of the energy test: a law that forgets its plastic overlap at the turn gives work back.
#[test]
fn a_law_that_makes_energy_is_seen() {
    let law = ContactLaw::AdhesiveElasticPlastic(adhesive(1.0e9));
    let mut hand = Hand::new(&law);
    hand.go(0.5, [0.0; 2]);
    // Unloads along k_unload through the point of loading of a deeper past.
    hand.history.largest_overlap = 0.0;
    hand.step(1.5, [0.0; 2]);
    hand.work = 0.5 * hand.law.stiffness(0.0, 1.0) * 0.25 - F0 * 0.5;
    hand.go(-0.1, [0.0; 2]);
    assert!(hand.work < -0.1, "{}", hand.work);
}
