//! The interface of a contact law.

use super::{Contact, ContactForce, ContactStep, ContactWork, StoredInContact};
use crate::particles::ContactHistory;

/// The force between two bodies in contact. A law may include adhesion of its own; van der Waals cohesion is added
/// outside the law.
///
/// A law must be **odd**: with the bodies exchanged (normal, relative velocity and tangential spring negated) it must
/// return the same normal force and exactly the negated tangential force, bit for bit. Sums and products of these
/// vectors are odd by themselves.
pub trait ContactForceLaw {
    /// Force on the second body, after the history has been advanced by `dt`.
    ///
    /// `dt` is zero when the forces of a new bed are evaluated. The force must also be finite if the bodies do not
    /// touch: it is then discarded.
    fn force(&self, contact: &Contact, history: &mut ContactHistory, dt: f64) -> ContactForce;

    /// The force if the surfaces stick to each other, and whether they slide instead. If they slide,
    /// [`ContactForceLaw::slide`] turns this force and the history into the results of [`ContactForceLaw::force`];
    /// otherwise it changes neither.
    ///
    /// Pairs are evaluated side by side, and few pairs of a bed at rest slide. If none of them does, the operations
    /// that only sliding needs, a square root and a division, are skipped. A law that does not distinguish the two is
    /// evaluated as a whole.
    #[inline(always)]
    fn sticking_force(
        &self,
        contact: &Contact,
        history: &mut ContactHistory,
        dt: f64,
    ) -> (ContactForce, bool) {
        (self.force(contact, history, dt), false)
    }

    /// Lets the surfaces slide if the tangential part of a [`ContactForceLaw::sticking_force`] exceeds the limit of
    /// friction: this part is reduced to the limit, and the spring to the corresponding length.
    #[inline(always)]
    fn slide(&self, _contact: &Contact, _history: &mut ContactHistory, _force: &mut ContactForce) {}

    /// Whether the bodies are in contact, given the history after the last step (all zero if they were not). If they
    /// are not, force and history are set to zero, whatever [`ContactForceLaw::force`] returned.
    #[inline(always)]
    fn touches(&self, contact: &Contact, _history: &ContactHistory) -> bool {
        contact.overlap > 0.0
    }

    /// Contact range: the largest separation of surfaces at which a contact can last, for reduced radii up to
    /// `_reduced_radius`; length.
    fn contact_range(&self, _reduced_radius: f64) -> f64 {
        0.0
    }

    /// Slope dF_n/d delta of a contact that is loaded for the first time; force per length. Rolling springs are
    /// proportional to it.
    fn stiffness(&self, overlap: f64, reduced_radius: f64) -> f64;

    /// The stiffness before the last step, in which the overlap changed by -v_n dt, and after it.
    #[inline(always)]
    fn stiffness_over(&self, contact: &Contact, dt: f64) -> [f64; 2] {
        let before = contact.overlap + contact.normal.dot(&contact.relative_velocity) * dt;
        [before, contact.overlap].map(|overlap| self.stiffness(overlap, contact.reduced_radius))
    }

    /// Duration of a collision of two bodies with these m* and R*, with which the time step is compared; time.
    fn contact_duration(&self, reduced_mass: f64, reduced_radius: f64) -> f64;

    /// Energy stored in a contact with this history, for the energy ledger. A law that does not give it leaves the
    /// ledger undefined.
    fn stored_energy(&self, _contact: &Contact, _history: &ContactHistory) -> StoredInContact {
        StoredInContact::UNKNOWN
    }

    /// Work of the contact on the bodies over a step, except for the part that springs store.
    fn work(&self, _step: &ContactStep<'_>) -> ContactWork {
        ContactWork::UNKNOWN
    }

    /// Largest normal force of an elastic contact up to an overlap, adhesion of the law included; it determines the
    /// range of forces.
    fn largest_force(&self, overlap: f64, reduced_radius: f64) -> f64;
}
