//! Resistance to twisting, the relative spin about the normal of a contact, for any contact law.
//!
//! Reference: S. Luding, "Cohesive, frictional powders: contact models for tension", Granular Matter 10 (2008) 235-246,
//! <https://doi.org/10.1007/s10035-008-0099-x>, section on torsion.

use super::energy::SpringMotion;
use super::invalid_law::{InvalidContactLaw, require_in_range};
use super::{Contact, ContactWork, SpringStep};
use crate::schema::{Allowed, Key, Mixing, Word};
use nalgebra::Vector3;

const TWISTING_FRICTION: Key = Key::number(
    "twisting_friction",
    Allowed::NOT_NEGATIVE,
    "Coefficient mu_o: the torque is at most mu_o R* times the force that limits sliding at mu = 1",
)
.mixed(Mixing::Geometric);
const TWISTING_STIFFNESS: Key = Key::number(
    "twisting_stiffness",
    Allowed::POSITIVE,
    "Stiffness of the twisting spring over k_n R*^2",
);
const TWISTING_DAMPING: Key = Key::number(
    "twisting_damping",
    Allowed::between(0.0, 1.0),
    "Fraction eta_o of the critical damping in the twisting dashpot",
);

/// The words of `contact.twisting`, each with its keys.
pub const TWISTING: &[Word] = &[
    Word::new("none", ""),
    Word::with(
        "elastic_plastic",
        "a spring that yields, with a dashpot (Luding 2008)",
        &[TWISTING_FRICTION, TWISTING_STIFFNESS, TWISTING_DAMPING],
    ),
];

/// Twisting friction: a spring about the normal that yields, and a dashpot.
///
/// With omega_n the relative spin about the normal n and theta the angle twisted since the contact began, the torque on
/// the second body is
///
/// ```math
/// M = -(k_o \theta + \eta_o\, 2 \sqrt{I^* k_o}\, \omega_n)\, n, \qquad k_o = \kappa\, k_n R^{*2}, \qquad |M| \le \mu_o R^* F
/// ```
///
/// with F the normal force to which friction is proportional ([`super::ContactForce::friction_normal`]) and I* the
/// reduced moment of inertia; the spring yields at k_o |theta| = mu_o R* F. k_n is the law's stiffness at the overlap;
/// if it grows while the contact is loaded, the torque is kept and theta shrinks, as in rolling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwistingFriction {
    coefficient: f64,
    stiffness: f64,
    damping: f64,
}

impl TwistingFriction {
    /// Twisting friction with the dimensionless mu_o, kappa and eta_o.
    ///
    /// # Errors
    /// If mu_o or eta_o is negative, eta_o above 1, or kappa not positive.
    pub fn new(coefficient: f64, stiffness: f64, damping: f64) -> Result<Self, InvalidContactLaw> {
        require_in_range(&TWISTING_FRICTION, coefficient)?;
        require_in_range(&TWISTING_STIFFNESS, stiffness)?;
        require_in_range(&TWISTING_DAMPING, damping)?;
        Ok(Self { coefficient, stiffness, damping })
    }

    /// Torque on the second body along the normal, after `angle` has been advanced by `dt`. `stiffness` is that of the
    /// law before and after the step.
    #[inline(always)]
    pub(super) fn torque(
        &self,
        contact: &Contact,
        friction_normal: f64,
        stiffness: [f64; 2],
        angle: &mut f64,
        dt: f64,
    ) -> f64 {
        let rate = contact.normal.dot(&contact.relative_spin);
        let [before, now] = stiffness;
        let [spring, dashpot] = self.spring(contact, now);
        let limit = self.coefficient * contact.reduced_radius * friction_normal;
        let loading = if before < now { before / now } else { 1.0 };
        let theta = *angle * loading + rate * dt;
        // Selects are used instead of branches: contacts are evaluated side by side, in lanes.
        let within = |value: f64| if value.abs() > limit { limit.copysign(value) } else { value };
        let held = within(spring * theta);
        *angle = if spring > 0.0 { held / spring } else { 0.0 };
        -within(held + dashpot * rate)
    }

    /// Stiffness of the spring and coefficient of the dashpot.
    #[inline(always)]
    fn spring(&self, contact: &Contact, normal_stiffness: f64) -> [f64; 2] {
        let radius = contact.reduced_radius;
        let spring = self.stiffness * normal_stiffness * radius * radius;
        [spring, self.damping * 2.0 * (contact.reduced_inertia * spring).sqrt()]
    }

    /// Energy of the spring at a given stiffness of the law.
    pub(super) fn stored_energy(&self, contact: &Contact, stiffness: f64, angle: f64) -> f64 {
        0.5 * self.spring(contact, stiffness)[0] * angle * angle
    }

    /// Work of the resistance to twisting over a step in which the angle changed from `before` to `after` and which
    /// ended with this torque.
    pub(super) fn work(
        &self,
        contact: &Contact,
        stiffness: [f64; 2],
        [before, after]: [f64; 2],
        torque: f64,
        dt: f64,
    ) -> ContactWork {
        let loading_factor =
            if stiffness[0] < stiffness[1] { stiffness[0] / stiffness[1] } else { 1.0 };
        let [[spring_before, _], [spring, damping]] =
            stiffness.map(|stiffness| self.spring(contact, stiffness));
        let along = |value: f64| Vector3::x() * value;
        let motion = SpringMotion {
            before: along(before),
            turned: along(before * loading_factor),
            after: along(after),
            rate: along(contact.normal.dot(&contact.relative_spin)),
            force: along(torque),
        };
        let step = SpringStep { stiffness: [spring_before, spring], damping, loading_factor };
        step.work(&motion, dt)
    }
}
