//! The loops over pairs of particles: geometry, law, cohesion, and exact sums.

mod attraction;
mod contacts;
mod separated;

use super::force_laws::{ForceLaws, ForceOutOfRange, PairLaws};
use super::{CohesionExpression, ContactModel, VanDerWaalsNow};
use crate::particles::{Contacts, InnerList, PairGroup, Particles};
pub(crate) use contacts::{ContactLoop, add_contacts};
use separated::{SeparatedPairs, SeparatedReach, attract_candidates};

/// Ensures that all pairs within the ranges of the laws are known, before those of one group or of both are evaluated.
///
/// Before: ghosts are current, unless the inner list is valid.
pub(crate) fn prepare_pairs(particles: &Particles, contacts: &mut Contacts, laws: &ForceLaws) {
    PairGroup::ALL.iter().for_each(|&group| hold_angles(&mut contacts.inner, laws, group));
    contacts.update_inner_list(particles, laws.ranges);
}

/// Finds the pairs of a group that are in contact now, and adds the attraction of the others, if there is any, to both
/// their particles.
///
/// # Errors
/// The errors of [`add_contact_forces`].
pub(crate) fn find_contacts(
    particles: &mut Particles,
    contacts: &mut Contacts,
    laws: &ForceLaws,
    group: PairGroup,
) -> Result<(), ForceOutOfRange> {
    let inner = &mut contacts.inner;
    match &laws.cohesion {
        None => inner.find_promotions(particles, group),
        Some(_) => attract_separated(particles, inner, laws, group)?,
    }
    inner.promote(group);
    Ok(())
}

/// Adds the forces and torques of the contacts of a group to both their particles.
///
/// With n the unit vector from particle i to j, delta the overlap and F_c the attraction at separation -delta, the
/// force on particle j is (F_n - F_c) n + F_t and its torque -r_j n x F_t; particle i receives the negative force and
/// -r_i n x F_t. Every contribution is rounded to a multiple of a quantum before it is added: the sums are exact, so
/// neither the order of pairs nor the rank that evaluates one changes a bit.
///
/// Before: forces are sums of multiples of the quantum; ghosts of the group are current.
///
/// # Errors
/// If a force exceeds the limit or is undefined; the error names the first such pair of this rank.
pub(crate) fn add_contact_forces(
    particles: &mut Particles,
    contacts: &mut Contacts,
    laws: &ForceLaws,
    group: PairGroup,
) -> Result<(), ForceOutOfRange> {
    let one_size = contacts.inner.one_size;
    for (kind, pairs) in contacts.inner.kinds_mut(group).iter_mut().enumerate() {
        let (pairs, laws) = (&mut pairs.active, laws.of_kind(kind));
        let law = laws.contact.law.as_block_law();
        if needs_extras(&laws) {
            law.add_contacts_with_extras(ContactLoop { particles, pairs, one_size, laws })?;
        } else {
            law.add_contacts(ContactLoop { particles, pairs, one_size, laws })?;
        }
    }
    Ok(())
}

/// Makes room for the angles of the springs that the laws have.
fn hold_angles(inner: &mut InnerList, laws: &ForceLaws, group: PairGroup) {
    for (kind, pairs) in inner.kinds_mut(group).iter_mut().enumerate() {
        let ContactModel { rolling, twisting, .. } = laws.contact.of_kind(kind);
        pairs.active.hold_angles(rolling.is_some(), twisting.is_some());
    }
}

/// Adds the attraction of the pairs that do not touch, and finds those that have come within the range of contacts.
fn attract_separated(
    particles: &mut Particles,
    inner: &mut InnerList,
    laws: &ForceLaws,
    group: PairGroup,
) -> Result<(), ForceOutOfRange> {
    let InnerList { one_size, contact_range, .. } = *inner;
    for (kind, pairs) in inner.kinds_mut(group).iter_mut().enumerate() {
        let laws = laws.of_kind(kind);
        let Some(cohesion) = laws.cohesion else { continue };
        let reach = SeparatedReach { cohesion, contact_range };
        attract_candidates(SeparatedPairs { particles, pairs, one_size, reach, laws })?;
    }
    Ok(())
}

/// Whether twisting or asperities act.
fn needs_extras(laws: &PairLaws) -> bool {
    let is_rough = |cohesion: VanDerWaalsNow| {
        matches!(cohesion.expression(), CohesionExpression::Rough { .. })
    };
    laws.contact.twisting.is_some() || laws.cohesion.is_some_and(is_rough)
}

#[cfg(test)]
mod tests;
