//! Laws of parcels: at l times the overlap all forces are multiplied by one factor.

use nalgebra::Vector3;
use talcum::contact::{CoarseGraining, Contact, ContactForceLaw, ContactLaw, ExampleScales, Kept};
use talcum::particles::ContactHistory;

const FACTOR: f64 = 3.0;
const SCALES: ExampleScales = ExampleScales { stiffness: 2.0, overlap: 0.01, restitution: 0.7 };
const RADIUS: f64 = 0.5;
const MASS: f64 = 0.3;
const TIME_STEP: f64 = 0.01;

/// By which lengths and times are multiplied.
#[derive(Clone, Copy)]
struct Scale {
    length: f64,
    time: f64,
}

/// Normal forces and the sizes of tangential ones of a contact that is loaded, unloaded and pulled apart while it slides.
fn forces(law: &ContactLaw, scale: Scale) -> Vec<[f64; 2]> {
    let mut history = ContactHistory::default();
    let path = (0..=40).map(|step| 0.01 * (1.0 - (f64::from(step) / 20.0 - 1.0).powi(2)) + 1.0e-4);
    let overlaps: Vec<f64> = path.collect();
    let Scale { length, time } = scale;
    let force = |pair: &[f64]| {
        let rate = (pair[0] - pair[1]) / TIME_STEP;
        let contact = Contact {
            overlap: length * pair[1],
            normal: Vector3::z(),
            relative_velocity: length / time * Vector3::new(0.05, 0.0, rate),
            relative_spin: Vector3::zeros(),
            reduced_mass: length.powi(3) * MASS,
            reduced_radius: length * RADIUS,
            reduced_inertia: length.powi(5) * 0.4 * MASS * RADIUS * RADIUS,
            cohesion: 0.0,
        };
        let force = law.force(&contact, &mut history, time * TIME_STEP);
        [force.normal, force.tangential.norm()]
    };
    overlaps.windows(2).map(force).collect()
}

/// The largest difference between forces of parcels and `times` those of particles, over the largest force.
fn difference(law: &ContactLaw, parcels: &CoarseGraining, [times, time]: [f64; 2]) -> f64 {
    let small = forces(law, Scale { length: 1.0, time: 1.0 });
    let large = forces(&law.coarse_grained(parcels), Scale { length: FACTOR, time });
    assert!(small.iter().chain(&large).flatten().all(|force| force.is_finite()), "{law:?}");
    let largest = small.iter().flatten().fold(0.0, |largest: f64, force| largest.max(force.abs()));
    let pairs = small.iter().flatten().zip(large.iter().flatten());
    let differences = pairs.map(|(small, large)| (large / times - small).abs());
    differences.fold(0.0, f64::max) / largest
}

#[test]
fn forces_of_parcels_are_those_of_particles_times_one_factor() {
    for law in ContactLaw::examples(SCALES) {
        let rules = [(Kept::Strength, 2, FACTOR), (Kept::BondNumber, 3, FACTOR.sqrt())];
        for (keeps, power, time) in rules {
            let (parcels, times) = (CoarseGraining { factor: FACTOR, keeps }, FACTOR.powi(power));
            // Rounding of some ten operations.
            let found = difference(&law, &parcels, [times, time]);
            assert!(found < 1.0e-13, "{law:?}: {found}");
            // The control: the factor of the other rule.
            let found = difference(&law, &parcels, [FACTOR.powi(5 - power), time]);
            assert!(found > 0.1, "{law:?}: {found}");
        }
    }
}
