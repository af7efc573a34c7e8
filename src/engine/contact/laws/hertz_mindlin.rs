//! Elastic spheres: Hertz's normal force, Mindlin's tangential stiffness without slip, and dashpots of a constant
//! restitution coefficient.
//!
//! References:
//! * H. Hertz, "Ueber die Berührung fester elastischer Körper", J. reine angew. Math. 92 (1882) 156-171,
//!   <https://doi.org/10.1515/crll.1882.92.156>
//! * R. D. Mindlin, H. Deresiewicz, "Elastic spheres in contact under varying oblique forces", J. Appl. Mech. 20 (1953)
//!   327-344, <https://doi.org/10.1115/1.4010702>
//! * Y. Tsuji, T. Tanaka, T. Ishida, "Lagrangian numerical simulation of plug flow of cohesionless particles in a
//!   horizontal pipe", Powder Technol. 71 (1992) 239-250, <https://doi.org/10.1016/0032-5910(92)88030-L>
//! * D. Antypov, J. A. Elliott, "On an analytical solution for the damped Hertzian spring", Europhys. Lett. 94 (2011)
//!   50004, <https://doi.org/10.1209/0295-5075/94/50004>

use super::parts::{
    ContactModuli, Elastic, ElasticParameters, Elasticity, SliderStep, loading_factor,
};
use super::{ContactLawValues, ExampleScales, RegisteredContactLaw};
use crate::contact::{
    CoarseGraining, Contact, ContactForce, ContactForceLaw, ContactStep, ContactWork,
    InvalidContactLaw, StoredInContact,
};
use crate::particles::ContactHistory;
use crate::schema::Key;

/// Law of Hertz and Mindlin.
///
/// ```math
/// \begin{aligned}
/// F_n &= \tfrac{4}{3} E^* \sqrt{R^*}\, \delta^{3/2} - \eta_n v_n, & F_t &= -S_t s - \eta_t v_t, \quad |F_t| \le \mu |F_n| \\
/// \eta &= 2 \sqrt{\tfrac{5}{6}}\, \frac{|\ln e|}{\sqrt{\pi^2 + \ln^2 e}} \sqrt{S m^*}, & S_n &= 2 E^* a, \quad S_t = 8 G^* a
/// \end{aligned}
/// ```
///
/// with a = sqrt(R* delta) the radius of contact, s the tangential displacement, and S the stiffness S_n or S_t. While
/// a contact is loaded, the tangential force of its spring is kept; while it is unloaded, that force falls with S_t, so
/// that no cycle creates energy.
///
/// ```
/// # use talcum_engine as talcum;
/// use nalgebra::Vector3;
/// use talcum::contact::{Contact, ContactForceLaw, ContactModuli, HertzMindlin};
/// use talcum::particles::ContactHistory;
///
/// let law = HertzMindlin::new(ContactModuli { normal: 0.75e9, shear: 0.2e9 }, 1.0, 0.3)?;
/// let at_rest = Contact {
///     overlap: 1.0e-4,
///     normal: Vector3::z(),
///     relative_velocity: Vector3::zeros(),
///     relative_spin: Vector3::zeros(),
///     reduced_mass: 0.5,
///     reduced_radius: 0.01,
///     reduced_inertia: 0.05,
///     cohesion: 0.0,
/// };
/// let force = law.force(&at_rest, &mut ContactHistory::default(), 0.0);
/// assert!((force.normal - 1.0e9 * 0.1 * 1.0e-6).abs() < 1.0e-10);
/// # Ok::<(), talcum::contact::InvalidContactLaw>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HertzMindlin {
    elastic: Elastic,
}

impl HertzMindlin {
    /// Makes a law from the moduli of the contact, the restitution coefficient e and the friction coefficient mu.
    ///
    /// # Errors
    /// If a modulus is not positive, e not within (0, 1], or mu negative.
    pub fn new(
        moduli: ContactModuli,
        restitution: f64,
        friction: f64,
    ) -> Result<Self, InvalidContactLaw> {
        Ok(Self { elastic: Elastic::new(moduli, restitution, friction)? })
    }
}

/// Contact radius a = sqrt(R* delta), 0 if the spheres are separated; length.
#[inline(always)]
fn contact_radius(overlap: f64, reduced_radius: f64) -> f64 {
    (reduced_radius * if overlap > 0.0 { overlap } else { 0.0 }).sqrt()
}

impl ContactForceLaw for HertzMindlin {
    #[inline(always)]
    fn force(&self, contact: &Contact, history: &mut ContactHistory, dt: f64) -> ContactForce {
        let Contact { overlap, reduced_mass, reduced_radius, .. } = *contact;
        let separation_speed = contact.normal.dot(&contact.relative_velocity);
        let radius = contact_radius(overlap, reduced_radius);
        let before = contact_radius(overlap + separation_speed * dt, reduced_radius);
        let stiffness = self.elastic.normal_stiffness(radius);
        let dashpot = self.elastic.dashpot(stiffness, reduced_mass);
        let normal = 2.0 / 3.0 * stiffness * overlap - dashpot * separation_speed;
        let friction_normal = normal.abs();
        let slider = self.elastic.slider(radius, friction_normal);
        let step = SliderStep {
            damping: self.elastic.dashpot(slider.stiffness, reduced_mass),
            loading_factor: loading_factor(before, radius),
            dt,
        };
        let tangential = slider.force(contact, history, step);
        ContactForce { normal, tangential, friction_normal }
    }

    /// Energies (2/5) F_n delta of the elastic force and (S_t / 2) s^2 of the tangential spring.
    fn stored_energy(&self, contact: &Contact, history: &ContactHistory) -> StoredInContact {
        let Contact { overlap, reduced_radius, .. } = *contact;
        let radius = contact_radius(overlap, reduced_radius);
        let normal = 0.4 * self.elastic.hertz_force(overlap.max(0.0), reduced_radius) * overlap;
        StoredInContact { normal, tangential: self.elastic.tangential_energy(radius, history) }
    }

    fn work(&self, step: &ContactStep<'_>) -> ContactWork {
        let reduced_radius = step.contact.reduced_radius;
        let overlaps = [step.overlap_before(), step.contact.overlap];
        self.elastic.work(step, overlaps.map(|overlap| contact_radius(overlap, reduced_radius)))
    }

    #[inline(always)]
    fn stiffness(&self, overlap: f64, reduced_radius: f64) -> f64 {
        self.elastic.normal_stiffness(contact_radius(overlap, reduced_radius))
    }

    fn contact_duration(&self, reduced_mass: f64, reduced_radius: f64) -> f64 {
        self.elastic.contact_duration(reduced_mass, reduced_radius)
    }

    fn largest_force(&self, overlap: f64, reduced_radius: f64) -> f64 {
        self.elastic.hertz_force(overlap, reduced_radius)
    }
}

impl RegisteredContactLaw for HertzMindlin {
    const MEANING: &'static str = "elastic spheres";
    const KEYS: &'static [Key] = &Elasticity::KEYS;

    fn from_keys(values: &dyn ContactLawValues) -> Option<Result<Self, InvalidContactLaw>> {
        let parameters = ElasticParameters::from_keys(values)?;
        Some(parameters.and_then(|of| Self::new(of.moduli, of.restitution, of.friction)))
    }

    const OVERLAP_EXPONENT: f64 = 1.5;

    fn stiffened(&self, factor: f64) -> Self {
        Self { elastic: self.elastic.stiffened(factor) }
    }

    fn keeping_work(&self, _reduction: f64) -> Self {
        *self
    }

    fn coarse_grained(&self, parcels: &CoarseGraining) -> Self {
        self.stiffened(parcels.stress())
    }

    fn examples(scales: ExampleScales) -> Vec<Self> {
        let law = Self::new(ContactModuli::example(scales), scales.restitution, 0.4);
        law.into_iter().collect()
    }
}
