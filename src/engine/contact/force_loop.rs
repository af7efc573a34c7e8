//! Force loop of a contact law: the normal force over the overlap of two bodies that are slowly pressed together and
//! separated.

use super::{Contact, ContactForce, ContactForceLaw, ContactLaw};
use crate::particles::ContactHistory;
use nalgebra::Vector3;

/// One point of a force loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopPoint {
    /// Number of the part of the loop, from 0: loading to half the largest overlap, unloading to a twentieth of it,
    /// loading to the largest, and separation.
    pub part: usize,
    /// Overlap; a negative value is a separation.
    pub overlap: f64,
    /// Normal force, positive if it pushes the bodies apart.
    pub force: f64,
}

/// The force loop up to a largest overlap, with `points` points per part, so slow that dashpots do not act.
/// `attraction` is the cohesion, as a function of the separation, that is not part of the law, and `range` the
/// separation at which it ends.
pub fn force_loop(
    law: &ContactLaw,
    (reduced_mass, reduced_radius): (f64, f64),
    largest_overlap: f64,
    points: usize,
    (attraction, range): (&dyn Fn(f64) -> f64, f64),
) -> Vec<LoopPoint> {
    // The loop extends slightly beyond the range of the law, and beyond zero if the law has none.
    let apart = 1.02 * law.contact_range(reduced_radius).max(range).max(0.02 * largest_overlap);
    let turns = [0.5 * largest_overlap, 0.05 * largest_overlap, largest_overlap, -apart];
    let mut history = ContactHistory::default();
    let mut begin = -apart;
    let mut out = Vec::with_capacity(turns.len() * points);
    for (part, end) in turns.into_iter().enumerate() {
        for point in 1..=points {
            let overlap = begin + (end - begin) * point as f64 / points as f64;
            let contact = Contact {
                overlap,
                normal: Vector3::z(),
                relative_velocity: Vector3::zeros(),
                relative_spin: Vector3::zeros(),
                reduced_mass,
                reduced_radius,
                reduced_inertia: reduced_mass * reduced_radius * reduced_radius,
                cohesion: attraction(-overlap),
            };
            let force = if law.touches(&contact, &history) {
                law.force(&contact, &mut history, 0.0)
            } else {
                history = ContactHistory::default();
                ContactForce::zero()
            };
            out.push(LoopPoint { part, overlap, force: force.normal - contact.cohesion });
        }
        begin = end;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{HystereticParameters, LinearHysteretic};

    #[test]
    fn the_loop_encloses_the_dissipated_energy() {
        let parameters = HystereticParameters {
            loading_stiffness: 1.0,
            unloading_stiffness: 2.0,
            tangential_stiffness: 0.0,
            restitution: 1.0,
            friction: 0.0,
        };
        let lost = |adhesion: f64| {
            let law = LinearHysteretic::new(parameters, adhesion).unwrap();
            let law = ContactLaw::LinearHysteretic(law);
            let points = force_loop(&law, (1.0, 1.0), 1.0, 1000, (&|_| 0.0, 0.0));
            let work = |pair: &[LoopPoint]| {
                0.5 * (pair[0].force + pair[1].force) * (pair[1].overlap - pair[0].overlap)
            };
            points.windows(2).map(work).sum::<f64>()
        };
        // Pressed to 1/2: 1/8, of which 1/16 is returned; from 1/20 on along k_2, 1/400, and from 1/10 along k_1,
        // 0.495; k_1^2 / (2 k_2) = 1/4 is returned. Trapezoids of 1/1000 resolve the corners to 1e-6.
        let expected = 1.0 / 8.0 - 1.0 / 16.0 + 1.0 / 400.0 + 0.495 - 0.25;
        assert!((lost(0.0) - expected).abs() < 1.0e-5, "{}", lost(0.0));
        // Negative control: with adhesion more energy is lost.
        assert!(lost(0.5) > expected + 0.02);
    }
}
