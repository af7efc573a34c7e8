//! A law that overrides every method of its trait is used with its own methods wherever forces are evaluated: through
//! the enum of laws, in the loops over pairs and walls, where single contacts are read, and in the energy ledger.

use crate::beds::{Bench, PERIODIC, PLATE, Reading};
use nalgebra::Vector3;
use talcum::contact::{
    Contact, ContactForce, ContactForceLaw, ContactLaw, ContactModel, ContactStep, ContactWork,
    RollingFriction, RollingKind, StoredInContact,
};
use talcum::instruments::View;
use talcum::particles::ContactHistory;
use talcum::state::Mechanism;

/// Every method returns a number of its own, the third column of [`ANSWERS`].
#[derive(Debug)]
struct Marked;

impl ContactForceLaw for Marked {
    fn force(&self, _: &Contact, _: &mut ContactHistory, _: f64) -> ContactForce {
        ContactForce { normal: 1.0, friction_normal: 1000.0, ..ContactForce::zero() }
    }

    fn sticking_force(&self, _: &Contact, _: &mut ContactHistory, _: f64) -> (ContactForce, bool) {
        (ContactForce { normal: 2.0, friction_normal: 1000.0, ..ContactForce::zero() }, true)
    }

    fn slide(&self, _: &Contact, _: &mut ContactHistory, force: &mut ContactForce) {
        force.tangential = Vector3::new(0.0, 3.0, 0.0);
    }

    fn touches(&self, contact: &Contact, _: &ContactHistory) -> bool {
        contact.overlap > -0.1
    }

    fn contact_range(&self, _: f64) -> f64 {
        0.1
    }

    fn stiffness(&self, _: f64, _: f64) -> f64 {
        100.0
    }

    fn stiffness_over(&self, _: &Contact, _: f64) -> [f64; 2] {
        [4.0; 2]
    }

    fn contact_duration(&self, _: f64, _: f64) -> f64 {
        5.0
    }

    fn stored_energy(&self, _: &Contact, _: &ContactHistory) -> StoredInContact {
        StoredInContact { normal: 6.0, tangential: 7.0 }
    }

    fn work(&self, _: &ContactStep<'_>) -> ContactWork {
        ContactWork { plasticity: 8.0, ..ContactWork::default() }
    }

    fn largest_force(&self, _: f64, _: f64) -> f64 {
        1.0e4
    }
}

/// A contact of two unit spheres whose surfaces are 0.05 apart.
const APART: Contact = Contact {
    overlap: -0.05,
    normal: Vector3::new(1.0, 0.0, 0.0),
    relative_velocity: Vector3::new(0.0, 0.0, 0.0),
    relative_spin: Vector3::new(0.0, 0.0, 0.0),
    reduced_mass: 0.5,
    reduced_radius: 0.25,
    reduced_inertia: 0.05,
    cohesion: 0.0,
};

/// A method, a number that is read off what it returns, and that of [`Marked`].
type Answer = (&'static str, fn(&ContactLaw) -> f64, f64);

/// All methods of the trait.
const ANSWERS: [Answer; 11] = [
    ("force", |law| law.force(&APART, &mut ContactHistory::default(), 0.0).normal, 1.0),
    (
        "sticking_force",
        |law| law.sticking_force(&APART, &mut ContactHistory::default(), 0.0).0.normal,
        2.0,
    ),
    (
        "slide",
        |law| {
            let mut force = ContactForce::zero();
            law.slide(&APART, &mut ContactHistory::default(), &mut force);
            force.tangential.y
        },
        3.0,
    ),
    ("touches", |law| f64::from(u8::from(law.touches(&APART, &ContactHistory::default()))), 1.0),
    ("contact_range", |law| law.contact_range(0.25), 0.1),
    ("stiffness", |law| law.stiffness(0.01, 0.25), 100.0),
    ("stiffness_over", |law| law.stiffness_over(&APART, 0.0)[0], 4.0),
    ("contact_duration", |law| law.contact_duration(0.5, 0.25), 5.0),
    ("stored_energy", |law| law.stored_energy(&APART, &ContactHistory::default()).tangential, 7.0),
    (
        "work",
        |law| {
            let (history, force) = (ContactHistory::default(), ContactForce::zero());
            let (before, after) = (&history, &history);
            let contact = &APART;
            law.work(&ContactStep { contact, before, after, force: &force, began: true, dt: 0.0 })
                .plasticity
        },
        8.0,
    ),
    ("largest_force", |law| law.largest_force(0.01, 0.25), 1.0e4),
];

#[test]
fn enum_of_laws_forwards_every_method_of_the_trait() {
    let source = include_str!("../../../src/engine/contact/law.rs");
    let (_, methods) = source.split_once("pub trait ContactForceLaw").unwrap();
    let signatures = methods.lines().filter_map(|line| line.trim().strip_prefix("fn "));
    let mut declared: Vec<&str> = signatures.filter_map(|line| line.split('(').next()).collect();
    let mut answered: Vec<&str> = ANSWERS.iter().map(|(method, ..)| *method).collect();
    declared.sort_unstable();
    answered.sort_unstable();
    assert_eq!(declared, answered, "a new method needs its answer in this test");

    let law = ContactLaw::custom("marked", Marked);
    for (method, answer, expected) in ANSWERS {
        assert_eq!(answer(&law), expected, "{method}");
    }
}

const STEP: f64 = 1.0e-3;
const SPIN: f64 = 10.0;
const ROLLING_COEFFICIENT: f64 = 0.2;
const ROLLING_DAMPING: f64 = 0.3;
/// Moment of inertia of a sphere of diameter and density 1 about its centre.
const INERTIA: f64 = 0.1 * std::f64::consts::PI / 6.0;

/// Two spheres along x, the second of which spins about y, and one above the plate, which spins likewise: surfaces are 0.05
/// apart, where only [`Marked`] has contacts.
fn bench() -> Bench {
    let mut bench = Bench::new([8.0; 3], [PERIODIC, PERIODIC, PLATE]);
    let springs = RollingKind::ElasticPlastic { damping: ROLLING_DAMPING };
    let rolling = Some(RollingFriction::new(springs, ROLLING_COEFFICIENT).unwrap());
    let law = ContactLaw::custom("marked", Marked);
    bench.interface = Some(ContactModel { rolling, ..law.into() });
    bench.time_step = STEP;
    bench.skin = Some(0.3);
    bench.add([2.0, 2.0, 5.0], [0.0; 3], 0.5);
    bench.add([3.05, 2.0, 5.0], [0.0; 3], 0.5);
    bench.add([6.0, 6.0, 0.55], [0.0; 3], 0.5);
    for particle in &mut bench.particles[1..] {
        particle.angular_velocity = [0.0, SPIN, 0.0];
    }
    bench
}

/// Stiffness of the rolling spring and coefficient of its dashpot, from the stiffness of the law.
fn rolling_spring(stiffness: f64, reduced_radius: f64, reduced_inertia: f64) -> [f64; 2] {
    let spring = 2.25 * stiffness * (ROLLING_COEFFICIENT * reduced_radius).powi(2);
    [spring, 2.0 * ROLLING_DAMPING * (3.5 * reduced_inertia * spring).sqrt()]
}

/// Spring and dashpot of the pair and of the particle at the wall.
fn rolling_springs(stiffness: f64) -> [[f64; 2]; 2] {
    [rolling_spring(stiffness, 0.25, 0.5 * INERTIA), rolling_spring(stiffness, 0.5, INERTIA)]
}

fn is_close(found: f64, expected: f64) -> bool {
    // The torque of the start changes the spin by up to 8e-4 before the middle of the step, and its square twice as much.
    (found / expected - 1.0).abs() < 2.0e-3
}

#[test]
fn loops_over_pairs_and_walls_use_every_override() {
    let mut run = bench().alone();
    run.steps(1);
    let [first, second, at_wall] = [0, 1, 2].map(|id| run.particle(id));
    // `sticking_force` and then `slide`, of bodies that only `touches` and `contact_range` hold for being in contact.
    let tolerance = 1.0e-3; // the normal turns by the drift of a step
    let is_near = |found: [f64; 3], expected: [f64; 3]| {
        (Vector3::from(found) - Vector3::from(expected)).norm() < tolerance
    };
    assert!(is_near(first.force, [-2.0, -3.0, 0.0]), "{first:?}");
    assert!(is_near(second.force, [2.0, 3.0, 0.0]), "{second:?}");
    assert!(is_near(at_wall.force, [0.0, -3.0, 2.0]), "{at_wall:?}");
    // `stiffness_over`, which the torque against rolling follows from.
    for (particle, [spring, dashpot]) in [second, at_wall].iter().zip(rolling_springs(4.0)) {
        let expected = -(spring * STEP + dashpot) * SPIN;
        assert!(is_close(particle.torque[1], expected), "{particle:?} {expected}");
    }
    // Negative control: that of `stiffness` would be seen.
    let [spring, dashpot] = rolling_springs(100.0)[0];
    assert!(!is_close(second.torque[1], -(spring * STEP + dashpot) * SPIN));
}

#[test]
fn ledger_of_energies_uses_every_override() {
    let mut run = bench().alone();
    run.keep_energy_ledger();
    run.steps(1);
    let balance = run.energy_balance().unwrap();
    assert_eq!(balance.of(Mechanism::Plasticity), 2.0 * 8.0);
    let dashpots = |stiffness: f64| -> f64 {
        rolling_springs(stiffness).map(|[_, dashpot]| -dashpot * SPIN * SPIN * STEP).iter().sum()
    };
    assert!(is_close(balance.of(Mechanism::Dashpot), dashpots(4.0)), "{balance:?}");
    // Negative control.
    assert!(!is_close(balance.of(Mechanism::Dashpot), dashpots(100.0)));
    // Springs of the law, and those that resist rolling: these hold what `stiffness` says.
    let of_rolling = |[spring, _]: [f64; 2]| 0.5 * spring * (STEP * SPIN).powi(2);
    let rolling: f64 = rolling_springs(100.0).map(of_rolling).iter().sum();
    let elastic = run.stored_energy().elastic;
    assert!((elastic - 2.0 * (6.0 + 7.0) - rolling).abs() < 0.02 * rolling, "{elastic} {rolling}");
}

#[test]
fn single_contacts_are_read_by_the_override() {
    let mut run = bench().alone();
    run.steps(1);
    let (mut pairs, mut walls) = (Vec::new(), Vec::new());
    let read = |view: &View<'_>| {
        view.for_each_pair_force(|pair| pairs.push(pair.normal));
        walls = view.wall_pair_forces().iter().map(|pair| pair.contact.z).collect();
    };
    run.look(&mut Reading(read)).unwrap();
    assert_eq!((pairs, walls), (vec![1.0], vec![1.0]));
}
