//! The contact model: a law, and resistance to rolling and twisting.

use super::{CoarseGraining, ContactLaw, RollingFriction, Softening, TwistingFriction};

/// Interaction of two kinds of bodies in contact: two particles, or a particle and a wall.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactModel {
    /// Law of contact.
    pub law: ContactLaw,
    /// Resistance to rolling.
    pub rolling: Option<RollingFriction>,
    /// Resistance to twisting.
    pub twisting: Option<TwistingFriction>,
    /// Factor by which the law is softer than the real particles, if it is given. It has no effect of its own: only the
    /// law acts.
    pub softening: Option<Softening>,
}

impl ContactModel {
    /// This model with another law.
    #[must_use]
    pub fn with_law(&self, law: &ContactLaw) -> Self {
        Self { law: law.clone(), ..self.clone() }
    }

    /// The model of parcels; resistance to rolling and twisting scales with the law and the radius.
    #[must_use]
    pub fn coarse_grained(&self, parcels: &CoarseGraining) -> Self {
        self.with_law(&self.law.coarse_grained(parcels))
    }
}

/// A law without resistance to rolling and twisting.
impl<L: Into<ContactLaw>> From<L> for ContactModel {
    fn from(law: L) -> Self {
        Self { law: law.into(), rolling: None, twisting: None, softening: None }
    }
}
