//! The loops over pairs of particles: geometry, law, cohesion, and exact sums.

mod attraction;
mod contacts;
mod separated;

use super::energy_pass::work_of_pairs;
use super::force_laws::{ForceLaws, ForceOutOfRange};
use super::{CohesionExpression, ContactModel, ContactWork, VanDerWaalsNow};
use crate::numbers::with_simd;
use crate::particles::{Contacts, Particles};
use contacts::ContactLoop;
use separated::SeparatedLoop;

/// Adds the forces and torques of all pairs to both their particles.
///
/// With n the unit vector from particle i to j, delta the overlap and F_c the attraction at separation
/// -delta, particle j feels (F_n - F_c) n + F_t and the torque -r_j n x F_t, particle i the negative force and
/// -r_i n x F_t. Every contribution is rounded to a multiple of a quantum before it is added: the
/// sums are exact, so neither the order of pairs nor evaluating a pair on two ranks changes a bit.
///
/// Before: forces are sums of multiples of the quantum; ghosts are current. After: the forces of all pairs with an owned
/// particle have been added to it.
///
/// `work` is given the work of each contact over the step, if anybody keeps account of it.
///
/// # Errors
/// If a force exceeds the limit or is undefined; the first such pair of this rank.
pub(crate) fn add_pair_forces(
    particles: &mut Particles,
    contacts: &mut Contacts,
    laws: &ForceLaws,
    work: Option<&mut dyn FnMut(ContactWork)>,
) -> Result<(), ForceOutOfRange> {
    let ContactModel { rolling, twisting, .. } = laws.contact;
    contacts.inner.active.hold_angles(rolling.is_some(), twisting.is_some());
    contacts.update_inner_list(particles, laws.ranges);
    let inner = &mut contacts.inner;
    match laws.cohesion {
        None => inner.find_promotions(particles),
        Some(cohesion) => with_simd(SeparatedLoop { particles, inner, cohesion, laws })?,
    }
    inner.promote();
    if let Some(sink) = work {
        work_of_pairs(particles, contacts, laws, sink);
    }
    let inner = &mut contacts.inner;
    let is_rough = |cohesion: VanDerWaalsNow| {
        matches!(cohesion.expression(), CohesionExpression::Rough { .. })
    };
    let is_rough = laws.cohesion.is_some_and(is_rough);
    match twisting.is_some() || is_rough {
        true => with_simd(ContactLoop::<true> { particles, inner, laws }),
        false => with_simd(ContactLoop::<false> { particles, inner, laws }),
    }
}
