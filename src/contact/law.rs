//! What every contact law must answer, and the list of laws.

use super::{
    AdhesiveElasticPlastic, Contact, ContactForce, HertzMindlin, Jkr, LinearHysteretic,
    LinearSpringDashpot, RollingFriction,
};
use crate::particles::ContactHistory;

/// The force between two bodies in contact; a law may bring its own adhesion, van der Waals cohesion is added
/// outside.
///
/// A law must be **odd**: with the bodies exchanged (normal, relative velocity and tangential spring
/// negated) it must give the same normal force and exactly the negated tangential force, bit for bit.
/// Sums and products of these vectors are odd by themselves.
pub trait ContactForceLaw {
    /// Force on the second body, after the memory has been carried on by `dt`.
    fn force(&self, contact: &Contact, history: &mut ContactHistory, dt: f64) -> ContactForce;

    /// Whether the bodies are in contact, given what the contact remembers of the last step (all zero if they
    /// were not). Where not, force and memory are zero whatever [`ContactForceLaw::force`] says.
    #[inline(always)]
    fn touches(&self, contact: &Contact, _memory: &ContactHistory) -> bool {
        contact.overlap > 0.0
    }

    /// The separation of surfaces up to which a contact can last, for R* up to this.
    fn reach(&self, _reduced_radius: f64) -> f64 {
        0.0
    }

    /// dF_n/d delta of a contact that is loaded for the first time, to which rolling springs are proportional.
    fn stiffness(&self, overlap: f64, reduced_radius: f64) -> f64;

    /// The stiffness before the last step, which changed the overlap by -v_n dt, and now.
    #[inline(always)]
    fn stiffness_over(&self, contact: &Contact, dt: f64) -> [f64; 2] {
        let before = contact.overlap + contact.normal.dot(&contact.relative_velocity) * dt;
        [before, contact.overlap].map(|overlap| self.stiffness(overlap, contact.reduced_radius))
    }

    /// How long a collision of two bodies of this m* and R* lasts, for the time step to be judged by.
    fn contact_duration(&self, reduced_mass: f64, reduced_radius: f64) -> f64;

    /// Largest normal force of an elastic contact up to an overlap, adhesion of the law included, to bound the
    /// range of forces.
    fn largest_force(&self, overlap: f64, reduced_radius: f64) -> f64;
}

/// The contact laws a case can choose.
#[derive(Clone, Debug, PartialEq)]
pub enum ContactLaw {
    /// Moon 2006 eqs (1)-(3).
    LinearSpringDashpot(LinearSpringDashpot),
    /// Liu 2016.
    AdhesiveElasticPlastic(AdhesiveElasticPlastic),
    /// Hertz; Mindlin & Deresiewicz 1953.
    HertzMindlin(HertzMindlin),
    /// Johnson, Kendall & Roberts 1971.
    Jkr(Jkr),
    /// Luding 2008.
    LinearHysteretic(LinearHysteretic),
}

/// What holds where two kinds of bodies touch: particles each other, or a wall.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactModel {
    /// Law of contact.
    pub law: ContactLaw,
    /// Resistance to rolling.
    pub rolling: Option<RollingFriction>,
}

impl ContactLaw {
    /// What the case file calls it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::LinearSpringDashpot(_) => "linear_spring_dashpot",
            Self::AdhesiveElasticPlastic(_) => "adhesive_elastic_plastic",
            Self::HertzMindlin(_) => "hertz_mindlin",
            Self::Jkr(_) => "jkr",
            Self::LinearHysteretic(_) => "linear_hysteretic",
        }
    }
}

/// Calls a function of whichever law it is.
macro_rules! each_law {
    ($model:expr, $law:ident => $call:expr) => {
        match $model {
            ContactLaw::LinearSpringDashpot($law) => $call,
            ContactLaw::AdhesiveElasticPlastic($law) => $call,
            ContactLaw::HertzMindlin($law) => $call,
            ContactLaw::Jkr($law) => $call,
            ContactLaw::LinearHysteretic($law) => $call,
        }
    };
}

impl ContactForceLaw for ContactLaw {
    #[inline(always)]
    fn force(&self, contact: &Contact, history: &mut ContactHistory, dt: f64) -> ContactForce {
        each_law!(self, law => law.force(contact, history, dt))
    }

    #[inline(always)]
    fn touches(&self, contact: &Contact, history: &ContactHistory) -> bool {
        each_law!(self, law => law.touches(contact, history))
    }

    fn reach(&self, reduced_radius: f64) -> f64 {
        each_law!(self, law => law.reach(reduced_radius))
    }

    fn stiffness(&self, overlap: f64, reduced_radius: f64) -> f64 {
        each_law!(self, law => law.stiffness(overlap, reduced_radius))
    }

    fn contact_duration(&self, reduced_mass: f64, reduced_radius: f64) -> f64 {
        each_law!(self, law => law.contact_duration(reduced_mass, reduced_radius))
    }

    fn largest_force(&self, overlap: f64, reduced_radius: f64) -> f64 {
        each_law!(self, law => law.largest_force(overlap, reduced_radius))
    }
}
