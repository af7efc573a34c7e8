//! Evaluation of a contact law for the pairs of a block.
//!
//! The law is written for one contact and without branches; in the loop over lanes the compiler turns it into vector
//! instructions. Every operation is an IEEE operation, rounded once, so that the width of the vectors changes no bit.

use super::{ContactBlock, ReducedSizes, Sizes, vector};
use crate::contact::rolling::Rolling;
use crate::contact::{Contact, ContactForce, ContactForceLaw};
use crate::numbers::any_flagged;
use crate::particles::{AngleLanes, ContactHistory, LANES, Lanes, SpringLanes};
use nalgebra::Vector3;

/// Number of lanes that are checked together for sliding surfaces: in a bed at rest one contact in a hundred slides.
const SLIDING_GROUP: usize = 8;

/// The histories of the pairs of a block.
pub(crate) struct BlockHistories<'a> {
    pub(crate) tangential_springs: &'a mut SpringLanes,
    pub(crate) largest_overlaps: &'a mut Lanes,
    pub(crate) rolling_angles: &'a mut AngleLanes,
    pub(crate) twisting_angles: &'a mut Lanes,
}

/// The pairs of a block, and the other data that their law needs.
pub(crate) struct PairsOfBlock<'a, R, S> {
    pub(crate) rolling: R,
    pub(crate) sizes: &'a S,
    /// Time by which histories are advanced.
    pub(crate) dt: f64,
    pub(crate) block: &'a mut ContactBlock,
    pub(crate) histories: BlockHistories<'a>,
}

/// Sets forces and rolling torques of all lanes, and advances the histories. Lanes that only fill up the last block are
/// evaluated too; their results are not used. Sliding is computed only where surfaces slide.
#[inline(always)]
pub(crate) fn evaluate_lanes<L: ContactForceLaw, R: Rolling, S: Sizes>(
    law: &L,
    pairs: PairsOfBlock<'_, R, S>,
) {
    let PairsOfBlock { rolling, sizes, dt, block, histories } = pairs;
    let BlockHistories { tangential_springs, largest_overlaps, rolling_angles, twisting_angles } =
        histories;
    let mut slides = [0; LANES];
    for lane in 0..LANES {
        let contact = contact_of(block, sizes, lane);
        let mut history = history_of(tangential_springs, largest_overlaps, lane);
        let touches = law.touches(&contact, &history);
        let (force, slides_here) = law.sticking_force(&contact, &mut history, dt);
        // Bodies that are not in contact exert no force and have no history, whatever the law returned.
        let if_touching = |value: f64| if touches { value } else { 0.0 };
        block.normal_force[lane] = if_touching(force.normal);
        for axis in 0..3 {
            block.tangential_force[axis][lane] = if_touching(force.tangential[axis]);
        }
        block.friction_normal[lane] = if_touching(force.friction_normal);
        slides[lane] = u64::from(slides_here & touches);
        if R::ACTS {
            let mut angles = SpinAngles {
                rolling: vector(rolling_angles, lane),
                twisting: if R::TWISTS { twisting_angles[lane] } else { 0.0 },
            };
            let limiting = force.friction_normal;
            let torque = spin_torque(law, rolling, &contact, limiting, &mut angles, dt);
            for axis in 0..3 {
                block.rolling_torque[axis][lane] = if_touching(torque[axis]);
                rolling_angles[axis][lane] = if_touching(angles.rolling[axis]);
            }
            if R::TWISTS {
                twisting_angles[lane] = if_touching(angles.twisting);
            }
        }
        for (of_axis, spring) in tangential_springs.iter_mut().zip(&history.tangential_spring) {
            of_axis[lane] = if_touching(*spring);
        }
        largest_overlaps[lane] = if_touching(history.largest_overlap);
        block.touching[lane] = u64::from(touches);
    }
    for (group, slides) in slides.as_chunks::<SLIDING_GROUP>().0.iter().enumerate() {
        if any_flagged(slides) {
            let first = group * SLIDING_GROUP;
            slide_group(law, sizes, block, (first, tangential_springs, largest_overlaps));
        }
    }
}

/// Lets surfaces slide, where they do not stick, in the group of lanes that begins at `first`.
#[inline(always)]
fn slide_group<L: ContactForceLaw, S: Sizes>(
    law: &L,
    sizes: &S,
    block: &mut ContactBlock,
    (first, tangential_springs, largest_overlaps): (usize, &mut SpringLanes, &Lanes),
) {
    for lane in (0..SLIDING_GROUP).map(|lane| first + lane) {
        let contact = contact_of(block, sizes, lane);
        let mut history = history_of(tangential_springs, largest_overlaps, lane);
        let mut force = ContactForce {
            normal: block.normal_force[lane],
            tangential: vector(&block.tangential_force, lane),
            friction_normal: block.friction_normal[lane],
        };
        law.slide(&contact, &mut history, &mut force);
        for axis in 0..3 {
            block.tangential_force[axis][lane] = force.tangential[axis];
            tangential_springs[axis][lane] = history.tangential_spring[axis];
        }
    }
}

/// Deflections of the springs that resist spin, in a lane.
struct SpinAngles {
    rolling: Vector3<f64>,
    twisting: f64,
}

/// Torque on the second body due to resistance to rolling and twisting.
#[inline(always)]
fn spin_torque<L: ContactForceLaw, R: Rolling>(
    law: &L,
    rolling: R,
    contact: &Contact,
    friction_normal: f64,
    angles: &mut SpinAngles,
    dt: f64,
) -> Vector3<f64> {
    let stiffness = law.stiffness_over(contact, dt);
    let SpinAngles { rolling: angle, twisting } = angles;
    let torque = rolling.torque(contact, friction_normal, stiffness, angle, dt);
    if !R::TWISTS {
        return torque;
    }
    let along = rolling.twisting_torque(contact, friction_normal, stiffness, twisting, dt);
    torque + contact.normal * along
}

/// The history of the contact in a lane.
#[inline(always)]
fn history_of(springs: &SpringLanes, largest_overlaps: &Lanes, lane: usize) -> ContactHistory {
    ContactHistory {
        tangential_spring: vector(springs, lane),
        largest_overlap: largest_overlaps[lane],
    }
}

/// The contact in a lane.
#[inline(always)]
fn contact_of<S: Sizes>(block: &ContactBlock, sizes: &S, lane: usize) -> Contact {
    let ReducedSizes { mass, radius, inertia } = sizes.reduced(lane);
    Contact {
        overlap: block.overlap[lane],
        normal: vector(&block.normal, lane),
        relative_velocity: vector(&block.relative_velocity, lane),
        relative_spin: vector(&block.relative_spin, lane),
        reduced_mass: mass,
        reduced_radius: radius,
        reduced_inertia: inertia,
        cohesion: block.cohesion[lane],
    }
}
