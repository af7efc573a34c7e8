//! What a contact law is given, what it returns, and what it must answer.

use super::{ContactStep, ContactWork, StoredInContact};
use crate::particles::ContactHistory;
use nalgebra::Vector3;

/// A contact of two bodies: the first is a particle, the second another particle or a wall.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// Overlap delta; negative while a neck joins bodies whose surfaces are apart.
    pub overlap: f64,
    /// Unit vector n from the first body towards the second.
    pub normal: Vector3<f64>,
    /// Velocity of the second body's surface relative to the first's at the contact, rotation included. Its normal
    /// component v_n is positive if the bodies separate.
    pub relative_velocity: Vector3<f64>,
    /// Angular velocity of the second body less that of the first.
    pub relative_spin: Vector3<f64>,
    /// Reduced mass m* with 1/m* = 1/m_1 + 1/m_2; the particle's mass at a wall.
    pub reduced_mass: f64,
    /// Reduced radius R* with 1/R* = 1/r_1 + 1/r_2; the particle's radius at a wall.
    pub reduced_radius: f64,
    /// Reduced moment of inertia I* with 1/I* = 1/I_1 + 1/I_2, about the centres; the particle's at a wall.
    pub reduced_inertia: f64,
    /// Magnitude of the cohesive force at this contact that is not part of the law.
    pub cohesion: f64,
}

/// The force of a contact on its second body; the first body feels the opposite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactForce {
    /// Component along the normal; positive if it pushes the bodies apart.
    pub normal: f64,
    /// Component in the tangent plane.
    pub tangential: Vector3<f64>,
    /// Normal force that friction is proportional to, in sliding and in rolling; not negative.
    pub friction_normal: f64,
}

impl ContactForce {
    /// No force.
    pub fn zero() -> Self {
        Self { normal: 0.0, tangential: Vector3::zeros(), friction_normal: 0.0 }
    }
}

/// The force between two bodies in contact. A law may include adhesion of its own; van der Waals cohesion is added
/// outside.
///
/// A law must be **odd**: with the bodies exchanged (normal, relative velocity and tangential spring negated) it must
/// return the same normal force and exactly the negated tangential force, bit for bit. Sums and products of these
/// vectors are odd by themselves.
pub trait ContactForceLaw {
    /// Force on the second body, after the history has been advanced by `dt`.
    ///
    /// `dt` is zero when the forces of a new bed are evaluated. The force must be finite also where the bodies do not
    /// touch: it is then discarded.
    fn force(&self, contact: &Contact, history: &mut ContactHistory, dt: f64) -> ContactForce;

    /// Whether the bodies are in contact, given the history after the last step (all zero if they were not). If they
    /// are not, force and history are set to zero, whatever [`ContactForceLaw::force`] returned.
    #[inline(always)]
    fn touches(&self, contact: &Contact, _history: &ContactHistory) -> bool {
        contact.overlap > 0.0
    }

    /// Contact range: the largest separation of surfaces at which a contact can last, for R* up to this.
    fn contact_range(&self, _reduced_radius: f64) -> f64 {
        0.0
    }

    /// Slope dF_n/d delta of a contact that is loaded for the first time; rolling springs are proportional to it.
    fn stiffness(&self, overlap: f64, reduced_radius: f64) -> f64;

    /// The stiffness before the last step, in which the overlap changed by -v_n dt, and after it.
    #[inline(always)]
    fn stiffness_over(&self, contact: &Contact, dt: f64) -> [f64; 2] {
        let before = contact.overlap + contact.normal.dot(&contact.relative_velocity) * dt;
        [before, contact.overlap].map(|overlap| self.stiffness(overlap, contact.reduced_radius))
    }

    /// Duration of a collision of two bodies of this m* and R*, with which the time step is compared.
    fn contact_duration(&self, reduced_mass: f64, reduced_radius: f64) -> f64;

    /// Energy stored in a contact of this history, and work over a step: for the ledger of energies. A law that does not
    /// tell them leaves the ledger undefined.
    fn stored_energy(&self, _contact: &Contact, _history: &ContactHistory) -> StoredInContact {
        StoredInContact::UNKNOWN
    }

    /// Work of the contact on the bodies over a step, as far as no spring stores it.
    fn work(&self, _step: &ContactStep<'_>) -> ContactWork {
        ContactWork::UNKNOWN
    }

    /// Largest normal force of an elastic contact up to an overlap, adhesion of the law included; it bounds the range
    /// of forces.
    fn largest_force(&self, overlap: f64, reduced_radius: f64) -> f64;
}
