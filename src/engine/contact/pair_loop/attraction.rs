//! Attraction of the pairs of a block.

use crate::contact::lanes::{ContactBlock, SizesOfPairs};
use crate::contact::van_der_waals::{Attraction, Full, NearContact, Rough};
use crate::contact::{CohesionExpression, VanDerWaalsNow};
use crate::particles::{LANES, Lanes};

/// Sets the attraction of all pairs, if there is any; the attraction of rough particles only with `EXTRAS`.
#[inline(always)]
pub(super) fn attract<S: SizesOfPairs, const EXTRAS: bool>(
    block: &mut ContactBlock,
    sizes: &S,
    cohesion: Option<VanDerWaalsNow>,
) {
    let Some(cohesion) = cohesion else { return };
    match cohesion.expression() {
        CohesionExpression::NearContact => attract_by(NearContact(cohesion), block, sizes),
        CohesionExpression::Full => attract_by(Full(cohesion), block, sizes),
        CohesionExpression::Rough { asperity_radius } if EXTRAS => {
            let smooth = NearContact(cohesion);
            attract_by(Rough { smooth, asperity_radius }, block, sizes);
        }
        // `add_contact_forces` chooses the other loop; an undefined force ends the run.
        CohesionExpression::Rough { .. } => block.cohesion = [f64::NAN; LANES],
    }
}

#[inline(always)]
fn attract_by<A: Attraction, S: SizesOfPairs>(attraction: A, block: &mut ContactBlock, sizes: &S) {
    // Nearly all pairs of a dense bed touch. Below the cut-off the attraction is the same for all pairs of equal
    // particles.
    if S::EQUAL && none_beyond(attraction.cut_off(), &block.overlap) {
        let [radius_i, radius_j] = sizes.radii(0);
        block.cohesion = [attraction.between(radius_i, radius_j, 0.0); LANES];
        return;
    }
    for lane in 0..LANES {
        let [radius_i, radius_j] = sizes.radii(lane);
        block.cohesion[lane] = attraction.between(radius_i, radius_j, -block.overlap[lane]);
    }
}

/// Whether no separation exceeds a limit.
#[inline(always)]
fn none_beyond(limit: f64, overlap: &Lanes) -> bool {
    let mut beyond = 0;
    for overlap in overlap {
        beyond |= u64::from(-overlap > limit);
    }
    beyond == 0
}
