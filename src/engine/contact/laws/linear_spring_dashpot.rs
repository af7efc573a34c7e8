//! Linear spring and dashpot, with a tangential spring and slider.
//!
//! References:
//! * P. A. Cundall, O. D. L. Strack, "A discrete numerical model for granular assemblies", Géotechnique 29 (1979) 47-65,
//!   <https://doi.org/10.1680/geot.1979.29.1.47>
//! * S. J. Moon, I. G. Kevrekidis, S. Sundaresan, "Particle simulation of vibrated gas-fluidized beds of cohesive fine
//!   powders", Ind. Eng. Chem. Res. 45 (2006) 6966-6977, eqs (1)-(3)

use super::parts::{FrictionCap, friction_cap, stick_or_slide};
use super::{ContactLawValues, ExampleScales, FRICTION, RESTITUTION, RegisteredContactLaw};
use crate::contact::invalid_law::{InvalidContactLaw, require_in_range};
use crate::contact::{
    CoarseGraining, Contact, ContactForce, ContactForceLaw, ContactStep, ContactWork, SpringStep,
    StoredInContact,
};
use crate::particles::ContactHistory;
use crate::schema::{Allowed, Key, Mixing, Value};
use nalgebra::Vector3;
use std::f64::consts::PI;

const NORMAL_STIFFNESS: Key =
    Key::number("normal_stiffness", Allowed::POSITIVE, "Stiffness k_n of the normal spring")
        .mixed(Mixing::Springs)
        .unit("force/length");
const TANGENTIAL_STIFFNESS: Key = Key::number(
    "tangential_stiffness",
    Allowed::NOT_NEGATIVE,
    "Stiffness k_t of the tangential spring",
)
.unit("force/length")
.or(&["poisson_ratio"])
.mixed(Mixing::Springs);
const POISSON_RATIO: Key = Key::number(
    "poisson_ratio",
    Allowed::between(0.0, 0.5),
    "Poisson's ratio nu, which gives k_t = 2 k_n (1 - nu) / (2 - nu)",
)
.or(&["tangential_stiffness"]);
const FRICTION_CAP: Key =
    Key::word(friction_cap::FRICTION_CAP, FrictionCap::WORDS, friction_cap::MEANING)
        .printed(Value::Word("contact"), "without cohesion the same as \"net\"")
        .required_when("[cohesion] is on");

/// Linear spring and dashpot.
///
/// ```math
/// F_n = k_n \delta - \gamma_n v_n, \qquad \gamma_n = 2 \sqrt{k_n m^*} \frac{|\ln e|}{\sqrt{\pi^2 + \ln^2 e}}, \qquad
/// |F_s| = \min(k_t |\delta_s|, \mu |F_n|)
/// ```
///
/// F_n acts along the normal, delta is the overlap, v_n > 0 if the bodies separate, m* the reduced mass and e the
/// restitution; F_s acts against the tangential displacement delta_s since the contact began.
///
/// The spring is projected onto the tangent plane; when it slides, it is shortened to the length that gives exactly the
/// limit. The dashpot may pull just before separation: if it were clipped, the restitution would differ from the given
/// one.
///
/// There is no tangential dashpot, and only the elastic force is compared with the limit: this slider, and its
/// rounding, differ from those of the other laws.
///
/// ```
/// # use talcum_engine as talcum;
/// use nalgebra::Vector3;
/// use talcum::contact::{Contact, ContactForceLaw, FrictionCap, LinearSpringDashpot};
/// use talcum::particles::ContactHistory;
///
/// let law = LinearSpringDashpot::new(1.0e5, 0.8e5, 1.0, 0.1, FrictionCap::Contact)?;
/// let at_rest = Contact {
///     overlap: 1.0e-3,
///     normal: Vector3::z(),
///     relative_velocity: Vector3::zeros(),
///     relative_spin: Vector3::zeros(),
///     reduced_mass: 0.5,
///     reduced_radius: 0.25,
///     reduced_inertia: 0.05,
///     cohesion: 0.0,
/// };
/// let force = law.force(&at_rest, &mut ContactHistory::default(), 1.0e-5);
/// assert_eq!(force.normal, 100.0);
/// # Ok::<(), talcum::contact::InvalidContactLaw>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearSpringDashpot {
    normal_stiffness: f64,
    tangential_stiffness: f64,
    friction: f64,
    friction_cap: FrictionCap,
    /// gamma_n / sqrt(m*).
    damping_factor: f64,
}

impl LinearSpringDashpot {
    /// Makes a law from its stiffnesses (force per length), restitution coefficient e and friction coefficient mu.
    ///
    /// # Errors
    /// If a stiffness is not positive (tangential: negative), e is outside (0, 1] or mu is negative.
    pub fn new(
        normal_stiffness: f64,
        tangential_stiffness: f64,
        restitution: f64,
        friction: f64,
        friction_cap: FrictionCap,
    ) -> Result<Self, InvalidContactLaw> {
        require_in_range(&NORMAL_STIFFNESS, normal_stiffness)?;
        require_in_range(&TANGENTIAL_STIFFNESS, tangential_stiffness)?;
        require_in_range(&RESTITUTION, restitution)?;
        require_in_range(&FRICTION, friction)?;
        let log = libm::log(restitution);
        let damping_factor =
            2.0 * normal_stiffness.sqrt() * log.abs() / (PI * PI + log * log).sqrt();
        Ok(Self { normal_stiffness, tangential_stiffness, friction, friction_cap, damping_factor })
    }

    /// Tangential stiffness k_t = 2 k_n (1 - nu) / (2 - nu) of a body with Poisson's ratio nu.
    pub fn tangential_stiffness_of(normal_stiffness: f64, poisson_ratio: f64) -> f64 {
        2.0 * normal_stiffness * (1.0 - poisson_ratio) / (2.0 - poisson_ratio)
    }

    /// Normal stiffness k_n, force per overlap.
    pub fn normal_stiffness(&self) -> f64 {
        self.normal_stiffness
    }

    /// Square of the force of a tangential spring.
    #[inline(always)]
    fn pull_squared(&self, spring: &Vector3<f64>) -> f64 {
        self.tangential_stiffness.powi(2) * spring.norm_squared()
    }
}

impl ContactForceLaw for LinearSpringDashpot {
    #[inline(always)]
    fn force(&self, contact: &Contact, history: &mut ContactHistory, dt: f64) -> ContactForce {
        stick_or_slide(self, contact, history, dt)
    }

    #[inline(always)]
    fn sticking_force(
        &self,
        contact: &Contact,
        history: &mut ContactHistory,
        dt: f64,
    ) -> (ContactForce, bool) {
        let n = contact.normal;
        let separation_speed = n.dot(&contact.relative_velocity);
        let damping = self.damping_factor * contact.reduced_mass.sqrt();
        let normal = self.normal_stiffness * contact.overlap - damping * separation_speed;

        let slip = contact.relative_velocity - n * separation_speed;
        let spring = contact.tangential(&history.tangential_spring) + slip * dt;
        history.tangential_spring = spring;
        let friction_normal = match self.friction_cap {
            FrictionCap::Contact => normal.abs(),
            FrictionCap::Net => (normal - contact.cohesion).abs(),
        };
        let tangential = spring * -self.tangential_stiffness;
        let force = ContactForce { normal, tangential, friction_normal };
        let limit = self.friction * friction_normal;
        (force, self.pull_squared(&spring) > limit * limit)
    }

    #[inline(always)]
    fn slide(&self, _contact: &Contact, history: &mut ContactHistory, force: &mut ContactForce) {
        let mut spring = history.tangential_spring;
        let (limit, pull_squared) =
            (self.friction * force.friction_normal, self.pull_squared(&spring));
        // A factor of 1 is used instead of a branch: contacts are evaluated side by side in vector lanes.
        spring *= if pull_squared > limit * limit { limit / pull_squared.sqrt() } else { 1.0 };
        history.tangential_spring = spring;
        force.tangential = spring * -self.tangential_stiffness;
    }

    /// Energies (k_n / 2) delta^2 and (k_t / 2) s^2.
    fn stored_energy(&self, contact: &Contact, history: &ContactHistory) -> StoredInContact {
        StoredInContact {
            normal: 0.5 * self.normal_stiffness * contact.overlap.powi(2),
            tangential: 0.5 * self.tangential_stiffness * history.tangential_spring.norm_squared(),
        }
    }

    fn work(&self, step: &ContactStep<'_>) -> ContactWork {
        let damping = self.damping_factor * step.contact.reduced_mass.sqrt();
        let stiffness = [self.tangential_stiffness; 2];
        let spring = SpringStep { stiffness, damping: 0.0, loading_factor: 1.0 };
        let dashpot = step.dashpot_work(damping);
        step.tangential_work(&spring) + ContactWork { dashpot, ..ContactWork::default() }
    }

    fn stiffness(&self, _overlap: f64, _reduced_radius: f64) -> f64 {
        self.normal_stiffness
    }

    /// Half a period of the damped oscillator: pi / sqrt(k_n/m* - (gamma_n / 2 m*)^2).
    fn contact_duration(&self, reduced_mass: f64, _reduced_radius: f64) -> f64 {
        let decay = 0.5 * self.damping_factor / reduced_mass.sqrt();
        PI / (self.normal_stiffness / reduced_mass - decay * decay).sqrt()
    }

    fn largest_force(&self, overlap: f64, _reduced_radius: f64) -> f64 {
        self.normal_stiffness * overlap
    }
}

impl RegisteredContactLaw for LinearSpringDashpot {
    const MEANING: &'static str = "linear springs and dashpots (Moon 2006)";
    const KEYS: &'static [Key] =
        &[NORMAL_STIFFNESS, TANGENTIAL_STIFFNESS, POISSON_RATIO, FRICTION_CAP];

    fn from_keys(values: &dyn ContactLawValues) -> Option<Result<Self, InvalidContactLaw>> {
        if values.is_cohesive() {
            values.require(FRICTION_CAP.name)
        } else {
            values.note_default(FRICTION_CAP.name)
        }
        let normal = values.number("normal_stiffness")?;
        let tangential = match values.given(&["tangential_stiffness", "poisson_ratio"])? {
            "poisson_ratio" => {
                Self::tangential_stiffness_of(normal, values.number("poisson_ratio")?)
            }
            key => values.number(key)?,
        };
        let cap = FrictionCap::from_keys(values)?;
        let (restitution, friction) = (values.number("restitution")?, values.number("friction")?);
        Some(Self::new(normal, tangential, restitution, friction, cap))
    }

    fn stiffened(&self, factor: f64) -> Self {
        Self {
            normal_stiffness: factor * self.normal_stiffness,
            tangential_stiffness: factor * self.tangential_stiffness,
            damping_factor: factor.sqrt() * self.damping_factor,
            ..*self
        }
    }

    fn keeping_work(&self, _reduction: f64) -> Self {
        *self
    }

    fn coarse_grained(&self, parcels: &CoarseGraining) -> Self {
        self.stiffened(parcels.stiffness())
    }

    fn examples(scales: ExampleScales) -> Vec<Self> {
        let k = scales.stiffness;
        let law = Self::new(k, 0.8 * k, scales.restitution, 0.4, FrictionCap::Contact);
        law.into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use proptest::prelude::*;

    fn law() -> LinearSpringDashpot {
        LinearSpringDashpot::new(2.0e5, 1.6e5, 0.9, 0.1, FrictionCap::Contact).unwrap()
    }

    fn contact(overlap: f64, normal: Vector3<f64>, relative_velocity: Vector3<f64>) -> Contact {
        Contact {
            overlap,
            normal,
            relative_velocity,
            relative_spin: Vector3::zeros(),
            reduced_mass: 0.26,
            reduced_radius: 0.25,
            reduced_inertia: 0.026,
            cohesion: 0.0,
        }
    }

    fn vector() -> impl Strategy<Value = Vector3<f64>> {
        prop::array::uniform3(-1.0..1.0f64).prop_map(|[x, y, z]| Vector3::new(x, y, z))
    }

    proptest! {
        #[test]
        fn friction_stays_in_the_tangent_plane_and_below_its_limit(
            velocity in vector(), spring in vector(), overlap in 1.0e-6..1.0e-2f64,
        ) {
            let contact = contact(overlap, Vector3::z(), velocity);
            let mut history = ContactHistory { tangential_spring: spring, largest_overlap: 0.0 };
            let force = law().force(&contact, &mut history, 1.0e-4);
            prop_assert_eq!(force.tangential.z, 0.0);
            // The shortened spring is rounded a few times.
            prop_assert!(force.tangential.norm() <= 0.1 * force.normal.abs() * (1.0 + 1.0e-14));
        }
    }

    #[test]
    fn parameters_without_meaning_are_refused() {
        let make = |kn, kt, e, mu| LinearSpringDashpot::new(kn, kt, e, mu, FrictionCap::Contact);
        assert!(make(0.0, 1.0, 0.9, 0.1).is_err());
        assert!(make(1.0, -1.0, 0.9, 0.1).is_err());
        assert!(make(1.0, 1.0, 1.1, 0.1).is_err());
        assert!(make(1.0, 1.0, 0.0, 0.1).is_err());
        assert_eq!(make(1.0, 1.0, 0.9, -0.1).unwrap_err().parameter, "friction");
    }
}
