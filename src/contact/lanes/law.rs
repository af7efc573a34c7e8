//! A contact law on the pairs of a block: compiled into the loop over blocks, or called through a table of functions.
//!
//! The law is written for one contact and without branches; in the loop over lanes the compiler turns it into vector
//! instructions. Every operation is an IEEE operation, rounded once, so that the width of the vectors changes no bit, nor
//! does how the law is called.

use super::{AnySizes, ContactBlock, Sizes, vector};
use crate::contact::rolling::{NoRolling, Rolling};
use crate::contact::{Contact, ContactForceLaw, RollingFriction};
use crate::numbers::{VectorWork, in_wide_vectors};
use crate::particles::{AngleLanes, ContactHistory, HISTORY_FIELDS, HistoryLanes, LANES};
use std::fmt::Debug;

/// The histories of the pairs of a block.
pub(crate) struct BlockHistories<'a> {
    pub(crate) contacts: &'a mut HistoryLanes,
    pub(crate) rolling_angles: &'a mut AngleLanes,
}

/// A law that evaluates the pairs of a block.
pub(crate) trait LawOnBlock {
    /// Sets forces and rolling torques of all lanes, and advances the histories by `dt`.
    fn evaluate<R: Rolling, S: Sizes>(
        &self,
        rolling: R,
        sizes: &S,
        dt: f64,
        block: &mut ContactBlock,
        histories: BlockHistories<'_>,
    );
}

/// Work that is given a law on blocks.
pub(crate) trait WithBlockLaw {
    /// What it returns.
    type Output;

    /// Does the work.
    fn with<L: LawOnBlock>(self, law: L) -> Self::Output;
}

/// A law that is compiled into the loop.
pub(crate) struct Inlined<'a, L>(pub(crate) &'a L);

impl<L: ContactForceLaw> LawOnBlock for Inlined<'_, L> {
    #[inline(always)]
    fn evaluate<R: Rolling, S: Sizes>(
        &self,
        rolling: R,
        sizes: &S,
        dt: f64,
        block: &mut ContactBlock,
        histories: BlockHistories<'_>,
    ) {
        evaluate_lanes((self.0, rolling), sizes, dt, block, histories);
    }
}

/// A law that is called once per block, through a table of functions.
pub(crate) struct Virtual<'a>(pub(crate) &'a dyn BlockLaw);

impl LawOnBlock for Virtual<'_> {
    #[inline(always)]
    fn evaluate<R: Rolling, S: Sizes>(
        &self,
        rolling: R,
        sizes: &S,
        dt: f64,
        block: &mut ContactBlock,
        histories: BlockHistories<'_>,
    ) {
        let (rolling, sizes) = (rolling.friction(), sizes.as_any_sizes());
        self.0.evaluate_block(PairsOfBlock { rolling, sizes, dt, block, histories });
    }
}

/// A contact law that can be called once per block of pairs: every [`ContactForceLaw`] whose type the compiler may send
/// between threads and print. It cannot be implemented otherwise.
pub trait BlockLaw: ContactForceLaw + Send + Sync + Debug {
    /// Evaluates the pairs of a block.
    #[doc(hidden)]
    fn evaluate_block(&self, pairs: PairsOfBlock<'_>);
}

impl<L: ContactForceLaw + Send + Sync + Debug> BlockLaw for L {
    fn evaluate_block(&self, pairs: PairsOfBlock<'_>) {
        in_wide_vectors(EvaluateBlock { law: self, pairs });
    }
}

/// The pairs of a block, and how rolling is resisted.
pub struct PairsOfBlock<'a> {
    rolling: Option<RollingFriction>,
    sizes: AnySizes<'a>,
    dt: f64,
    block: &'a mut ContactBlock,
    histories: BlockHistories<'a>,
}

struct EvaluateBlock<'a, L> {
    law: &'a L,
    pairs: PairsOfBlock<'a>,
}

impl<L: ContactForceLaw> VectorWork for EvaluateBlock<'_, L> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { law, pairs: PairsOfBlock { rolling, sizes, dt, block, histories } } = self;
        match (rolling, sizes) {
            (None, AnySizes::One(sizes)) => {
                evaluate_lanes((law, NoRolling), &sizes, dt, block, histories);
            }
            (None, AnySizes::Many(sizes)) => {
                evaluate_lanes((law, NoRolling), sizes, dt, block, histories);
            }
            (Some(rolling), AnySizes::One(sizes)) => {
                evaluate_lanes((law, rolling), &sizes, dt, block, histories);
            }
            (Some(rolling), AnySizes::Many(sizes)) => {
                evaluate_lanes((law, rolling), sizes, dt, block, histories);
            }
        }
    }
}

/// Evaluates all lanes, also those that only fill up the last block: their results are not used.
#[inline(always)]
fn evaluate_lanes<L: ContactForceLaw, R: Rolling, S: Sizes>(
    (law, rolling): (&L, R),
    sizes: &S,
    dt: f64,
    block: &mut ContactBlock,
    histories: BlockHistories<'_>,
) {
    let BlockHistories { contacts, rolling_angles } = histories;
    for lane in 0..LANES {
        let contact = contact_of(block, sizes, lane);
        let mut numbers = [0.0; HISTORY_FIELDS];
        for (number, field) in numbers.iter_mut().zip(&*contacts) {
            *number = field[lane];
        }
        let mut history: ContactHistory = bytemuck::cast(numbers);
        let touches = law.touches(&contact, &history);
        let force = law.force(&contact, &mut history, dt);
        // Whatever the law returned, bodies that are not in contact exert no force and have no history.
        let if_touching = |value: f64| if touches { value } else { 0.0 };
        block.normal_force[lane] = if_touching(force.normal);
        for axis in 0..3 {
            block.tangential_force[axis][lane] = if_touching(force.tangential[axis]);
        }
        if R::ACTS {
            let mut angle = vector(rolling_angles, lane);
            let stiffness = law.stiffness_over(&contact, dt);
            let torque = rolling.torque(&contact, force.friction_normal, stiffness, &mut angle, dt);
            for axis in 0..3 {
                block.rolling_torque[axis][lane] = if_touching(torque[axis]);
                rolling_angles[axis][lane] = if_touching(angle[axis]);
            }
        }
        let numbers: [f64; HISTORY_FIELDS] = bytemuck::cast(history);
        for (number, field) in numbers.into_iter().zip(&mut *contacts) {
            field[lane] = if_touching(number);
        }
        block.touching[lane] = u64::from(touches);
    }
}

/// The contact in a lane.
#[inline(always)]
fn contact_of<S: Sizes>(block: &ContactBlock, sizes: &S, lane: usize) -> Contact {
    let ([radius_i, radius_j], [mass_i, mass_j]) = (sizes.radii(lane), sizes.masses(lane));
    Contact {
        overlap: block.overlap[lane],
        normal: vector(&block.normal, lane),
        relative_velocity: vector(&block.relative_velocity, lane),
        relative_spin: vector(&block.relative_spin, lane),
        reduced_mass: mass_i * mass_j / (mass_i + mass_j),
        reduced_radius: radius_i * radius_j / (radius_i + radius_j),
        reduced_inertia: reduced_inertia([radius_i, radius_j], [mass_i, mass_j]),
        cohesion: block.cohesion[lane],
    }
}

/// Reduced moment of inertia I* of two solid spheres.
#[inline(always)]
fn reduced_inertia(radius: [f64; 2], mass: [f64; 2]) -> f64 {
    let one = 0.4 * mass[0] * radius[0] * radius[0];
    let other = 0.4 * mass[1] * radius[1] * radius[1];
    one * other / (one + other)
}
