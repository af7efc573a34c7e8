//! The work of separating two bodies that are held together by adhesion.

use super::{Contact, ContactForceLaw, ContactLaw};
use crate::particles::ContactHistory;
use crate::rules::{ReducedBody, WorkOfParting};
use nalgebra::Vector3;

/// Points at which the force is evaluated while bodies are parted.
const POINTS: usize = 4000;

/// Attraction that is not part of a law.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AttractionInContact {
    /// The force of the attraction in contact.
    pub force: f64,
    /// The work of moving the bodies from contact out of the range of the attraction.
    pub work: f64,
}

/// The work of slowly separating two bodies that came together slowly under their own adhesion: from the overlap at
/// which the force of first loading balances the attraction, along the law's unloading, to separation; energy.
pub fn work_of_parting(
    law: &ContactLaw,
    bodies: ReducedBody,
    attraction: AttractionInContact,
) -> WorkOfParting {
    let slowly = Slowly { law, bodies };
    let (overlap, mut history) = slowly.held_by(attraction.force);
    let in_contact = slowly.work(overlap, 0.0, &mut history) + attraction.force * overlap;
    let neck = if history.largest_overlap > 0.0 {
        slowly.work(0.0, -law.contact_range(bodies.radius), &mut history)
    } else {
        0.0
    };
    WorkOfParting { surface: attraction.work, spring: in_contact + neck }
}

/// The overlap at which a law's force in slow first loading balances a force that presses two bodies together; length,
/// at most the reduced radius.
pub fn overlap_under(law: &ContactLaw, bodies: ReducedBody, force: f64) -> f64 {
    Slowly { law, bodies }.held_by(force).0
}

/// The force that slowly separates two bodies that came together slowly under their own adhesion: the largest tension
/// along the law's unloading. Positive; zero if they do not adhere.
pub fn pull_off_force(
    law: &ContactLaw,
    bodies: ReducedBody,
    attraction: AttractionInContact,
) -> f64 {
    let slowly = Slowly { law, bodies };
    let (overlap, mut history) = slowly.held_by(attraction.force);
    let lowest =
        if history.largest_overlap > 0.0 { -law.contact_range(bodies.radius) } else { 0.0 };
    let width = (overlap - lowest) / POINTS as f64;
    let overlaps = (0..=POINTS).map(|point| overlap - point as f64 * width);
    let tension = |overlap: f64| {
        let outside = if overlap < 0.0 { 0.0 } else { attraction.force };
        outside - slowly.force(overlap, &mut history)
    };
    overlaps.map(tension).fold(attraction.force, f64::max)
}

/// A law and two bodies that move so slowly that dashpots do not act.
struct Slowly<'a> {
    law: &'a ContactLaw,
    bodies: ReducedBody,
}

impl Slowly<'_> {
    fn force(&self, overlap: f64, history: &mut ContactHistory) -> f64 {
        let ReducedBody { mass, radius } = self.bodies;
        let contact = Contact {
            overlap,
            normal: Vector3::z(),
            relative_velocity: Vector3::zeros(),
            relative_spin: Vector3::zeros(),
            reduced_mass: mass,
            reduced_radius: radius,
            reduced_inertia: mass * radius * radius,
            cohesion: 0.0,
        };
        self.law.force(&contact, history, 0.0).normal
    }

    /// The overlap at which first loading balances an attraction, and the history there; zero if nothing holds the
    /// bodies together, at most the reduced radius.
    fn held_by(&self, attraction: f64) -> (f64, ContactHistory) {
        let loaded = |overlap: f64| {
            let mut history = ContactHistory::default();
            (self.force(overlap, &mut history) - attraction, history)
        };
        let is_pulled = |overlap: f64| loaded(overlap).0 < 0.0;
        let mut high = 1.0e-15 * self.bodies.radius;
        if !is_pulled(high) {
            return (0.0, ContactHistory::default());
        }
        while is_pulled(high) && high < self.bodies.radius {
            high *= 2.0;
        }
        let mut low = 0.5 * high;
        // The number of halvings exceeds the number of bits.
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if is_pulled(middle) { low = middle } else { high = middle }
        }
        (high, loaded(high).1)
    }

    /// Work against the law's force from an overlap to a smaller one, by the midpoint rule.
    fn work(&self, from: f64, to: f64, history: &mut ContactHistory) -> f64 {
        let width = (from - to) / POINTS as f64;
        let middles = (0..POINTS).map(|point| from - (point as f64 + 0.5) * width);
        middles.map(|overlap| -self.force(overlap, history) * width).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{
        AdhesiveElasticPlastic, ContactModuli, FrictionCap, HertzMindlin, HystereticParameters,
        Jkr, LinearSpringDashpot,
    };
    use crate::rules::adhesion_factor;

    const BODIES: ReducedBody = ReducedBody { mass: 0.3, radius: 0.25 };

    fn linear(stiffness: f64) -> ContactLaw {
        let law = LinearSpringDashpot::new(stiffness, stiffness, 0.9, 0.1, FrictionCap::Contact);
        law.unwrap().into()
    }

    fn spring_work(law: &ContactLaw, force: f64) -> f64 {
        work_of_parting(law, BODIES, AttractionInContact { force, work: 0.0 }).spring
    }

    #[test]
    fn springs_add_what_the_closed_forms_say() {
        // F0^2 / (2 k), and Hertz's F0 delta - (2/5) F0 delta with F0 = (4/3) E* sqrt(R*) delta^(3/2). The midpoint
        // rule is exact for the first; for the second its error is 1 / (24 POINTS^2) of the second derivative, singular
        // at the end.
        let exact = 2.0 * 2.0 / (2.0 * 1.0e4);
        assert!((spring_work(&linear(1.0e4), 2.0) / exact - 1.0).abs() < 1.0e-9);
        let hertz = HertzMindlin::new(ContactModuli { normal: 1.0e5, shear: 1.0e4 }, 1.0, 0.0);
        let overlap = (2.0 / (4.0 / 3.0 * 1.0e5 * 0.5_f64)).powf(2.0 / 3.0);
        let found = spring_work(&hertz.unwrap().into(), 2.0);
        assert!((found / (0.6 * 2.0 * overlap) - 1.0).abs() < 1.0e-5, "{found}");
        // Negative control: another stiffness.
        assert!((spring_work(&linear(1.1e4), 2.0) / exact - 1.0).abs() > 0.05);
        assert_eq!(spring_work(&linear(1.0e4), 0.0), 0.0);
    }

    /// Integral of -F over delta from the equilibrium, s^3 = 3/2, to the break of the neck, s^3 = 1/4:
    /// 8 pi gamma c^4 [2 s^7 / 3 - s^4 / 4 - 4 s^10 / 15] between the two = 37.128 (gamma^5 R*^4 / E*^2)^(1/3). Between
    /// s = 1 and the break it is 22.516, the 7.09 of Thornton & Ning (1998) with their Gamma = 2 gamma.
    #[test]
    fn jkr_scales_with_surface_energy_and_modulus() {
        let of = |modulus: f64, energy: f64| {
            let moduli = ContactModuli { normal: modulus, shear: 1.0e5 };
            spring_work(&Jkr::new(moduli, energy, 1.0, 0.0).unwrap().into(), 0.0)
        };
        let scale = |modulus: f64, energy: f64| {
            (energy.powi(5) * BODIES.radius.powi(4) / (modulus * modulus)).cbrt()
        };
        for (modulus, energy) in [(1.0e6, 0.05), (1.0e8, 0.05), (1.0e6, 0.5)] {
            let constant = of(modulus, energy) / scale(modulus, energy);
            // The error of the midpoint rule near the vertical end of the neck: (1 / 4000)^(3/2).
            assert!((constant / 37.128 - 1.0).abs() < 1.0e-4, "{constant}");
        }
        // Negative control: the work from first touch on.
        assert!((of(1.0e6, 0.05) / scale(1.0e6, 0.05) / 22.516 - 1.0).abs() > 0.1);
    }

    #[test]
    fn laws_that_keep_the_work_have_that_of_the_stiffer_ones() {
        let parameters = HystereticParameters {
            loading_stiffness: 0.8e4,
            unloading_stiffness: 1.0e4,
            tangential_stiffness: 1.0e3,
            restitution: 0.9,
            friction: 0.3,
        };
        let adhesive: ContactLaw =
            AdhesiveElasticPlastic::new(parameters, 2.0, 1.0e-3).unwrap().into();
        let moduli = ContactModuli { normal: 1.0e6, shear: 1.0e5 };
        let jkr: ContactLaw = Jkr::new(moduli, 0.05, 0.9, 0.3).unwrap().into();
        for law in [adhesive, jkr] {
            let real = law.stiffened(100.0).unwrap();
            let soft = law.keeping_work(100.0);
            let ratio = |soft: &ContactLaw| spring_work(soft, 0.0) / spring_work(&real, 0.0);
            // Similar curves at similar points, up to rounding, including that of the equilibrium.
            assert!((ratio(&soft) - 1.0).abs() < 1.0e-9, "{}: {}", law.name(), ratio(&soft));
            // Negative control: adhesion is unchanged.
            assert!(ratio(&law) > 5.0, "{}: {}", law.name(), ratio(&law));
        }
        // With an attraction outside the law, the force falls by the factor of the law's exponent.
        for (law, exponent) in [(linear(1.0e4), 1.0), (hertz(), 1.5)] {
            assert_eq!(law.overlap_exponent(), exponent);
            let real = spring_work(&law.stiffened(100.0).unwrap(), 2.0);
            let soft = spring_work(&law, 2.0 * adhesion_factor(100.0, exponent));
            assert!((soft / real - 1.0).abs() < 1.0e-9);
        }
    }

    #[test]
    fn pull_off_forces_are_those_of_the_laws() {
        let moduli = ContactModuli { normal: 1.0e6, shear: 1.0e5 };
        let jkr: ContactLaw = Jkr::new(moduli, 0.05, 1.0, 0.0).unwrap().into();
        let none = AttractionInContact::default();
        // 3 pi gamma R*; the overlap at which the tension is largest lies between two of the points.
        let exact = 3.0 * std::f64::consts::PI * 0.05 * BODIES.radius;
        assert!((pull_off_force(&jkr, BODIES, none) / exact - 1.0).abs() < 1.0e-5);
        let attraction = AttractionInContact { force: 2.0, work: 0.1 };
        assert_eq!(pull_off_force(&linear(1.0e4), BODIES, attraction), 2.0);
        assert_eq!(pull_off_force(&hertz(), BODIES, attraction), 2.0);
        // Negative control: without adhesion there is no pull-off force.
        assert_eq!(pull_off_force(&linear(1.0e4), BODIES, none), 0.0);
    }

    #[test]
    fn overlaps_under_a_force_are_those_of_the_springs() {
        assert!((overlap_under(&linear(1.0e4), BODIES, 2.0) / 2.0e-4 - 1.0).abs() < 1.0e-12);
        let overlap = (2.0 / (4.0 / 3.0 * 1.0e5 * 0.5_f64)).powf(2.0 / 3.0);
        assert!((overlap_under(&hertz(), BODIES, 2.0) / overlap - 1.0).abs() < 1.0e-12);
        assert_eq!(overlap_under(&hertz(), BODIES, 0.0), 0.0);
    }

    fn hertz() -> ContactLaw {
        let moduli = ContactModuli { normal: 1.0e5, shear: 1.0e4 };
        HertzMindlin::new(moduli, 1.0, 0.0).unwrap().into()
    }
}
