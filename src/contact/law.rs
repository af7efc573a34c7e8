//! What every contact law must answer, and the list of laws.

use super::{Contact, ContactForce, LinearSpringDashpot};
use crate::particles::ContactMemory;

/// The force between two bodies in contact, without cohesion.
///
/// A law must be **odd**: with the bodies exchanged (normal, relative velocity and tangential spring
/// negated) it must give the same normal force and exactly the negated tangential force, bit for bit.
/// Sums and products of these vectors are odd by themselves.
pub trait ContactLaw {
    /// Force on the second body, after the memory has been carried on by `dt`.
    fn force(&self, contact: &Contact, memory: &mut ContactMemory, dt: f64) -> ContactForce;

    /// How long an elastic collision of two bodies of this reduced mass lasts.
    fn contact_duration(&self, reduced_mass: f64) -> f64;

    /// Elastic normal force at an overlap, to bound the range of forces.
    fn elastic_force(&self, overlap: f64) -> f64;
}

/// The contact laws a case can choose.
#[derive(Clone, Debug, PartialEq)]
pub enum ContactModel {
    /// Moon 2006 eqs (1)-(3).
    LinearSpringDashpot(LinearSpringDashpot),
}

impl ContactLaw for ContactModel {
    #[inline(always)]
    fn force(&self, contact: &Contact, memory: &mut ContactMemory, dt: f64) -> ContactForce {
        match self {
            Self::LinearSpringDashpot(law) => law.force(contact, memory, dt),
        }
    }

    fn contact_duration(&self, reduced_mass: f64) -> f64 {
        match self {
            Self::LinearSpringDashpot(law) => law.contact_duration(reduced_mass),
        }
    }

    fn elastic_force(&self, overlap: f64) -> f64 {
        match self {
            Self::LinearSpringDashpot(law) => law.elastic_force(overlap),
        }
    }
}
