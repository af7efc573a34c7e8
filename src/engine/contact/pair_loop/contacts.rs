//! The loop over pairs that may touch: blocks of pairs are gathered into lanes, evaluated, and added to the particles.

use super::attraction::attract;
use crate::contact::force_laws::{ForceOutOfRange, PairLaws, out_of_range};
use crate::contact::lanes::{
    BlockHistories, ComingBlocks, ContactBlock, ExcessForce, ManySizes, OneSize, PairsOfBlock,
    SizesOfPairs, evaluate_lanes,
};
use crate::contact::rolling::{
    ConstantTorque, ElasticPlastic, NoRolling, Rolling, RollingAndTwisting,
};
use crate::contact::{ContactForceLaw, ContactModel, RollingKind};
use crate::numbers::{F64x4, vectorised};
use crate::particles::{ContactColumns, LANES, PairBlock, PairBlocks, Particles};

/// Pairs that may touch, and the laws between them. With `EXTRAS`, resistance to twisting and asperities are included;
/// they have a loop of their own, so that the common one stays small.
pub struct ContactLoop<'a, const EXTRAS: bool> {
    pub(super) particles: &'a mut Particles,
    pub(super) pairs: &'a mut PairBlocks,
    /// Radius and mass, if they are the same for all particles.
    pub(super) one_size: Option<[f64; 2]>,
    pub(super) laws: PairLaws<'a>,
}

vectorised!(
    /// Adds the forces and torques of pairs that may touch. Selects the loop for the kind of resistance to rolling and
    /// twisting.
    ///
    /// # Errors
    /// If a force exceeds the limit or is undefined.
    pub(crate) fn add_contacts<Q: F64x4, L: ContactForceLaw, const EXTRAS: bool>(
        law: &L,
        contacts: ContactLoop<'_, EXTRAS>,
    ) -> Result<(), ForceOutOfRange> {
        let ContactModel { rolling, twisting, .. } = *contacts.laws.contact;
        match (rolling, twisting.filter(|_| EXTRAS)) {
            (rolling, Some(twisting)) => {
                let resistance = RollingAndTwisting { rolling, twisting };
                contacts.evaluate::<Q, _, _, _>(law, resistance, ManySizes::default())
            }
            (None, None) => contacts.with_sizes::<Q, _, _>(law, NoRolling),
            (Some(rolling), None) => match rolling.kind() {
                RollingKind::ConstantTorque => {
                    contacts.with_sizes::<Q, _, _>(law, ConstantTorque(rolling))
                }
                RollingKind::ElasticPlastic { damping } => {
                    contacts.with_sizes::<Q, _, _>(law, ElasticPlastic(rolling, damping))
                }
            },
        }
    }
);

impl<const EXTRAS: bool> ContactLoop<'_, EXTRAS> {
    /// Selects the loop for particles of one size or of different sizes.
    #[inline(always)]
    fn with_sizes<Q: F64x4, L: ContactForceLaw, R: Rolling>(
        self,
        law: &L,
        rolling: R,
    ) -> Result<(), ForceOutOfRange> {
        match self.one_size.filter(|_| !EXTRAS) {
            Some(size) => self.evaluate::<Q, _, _, _>(law, rolling, OneSize::new(size)),
            None => self.evaluate::<Q, _, _, _>(law, rolling, ManySizes::default()),
        }
    }

    #[inline(always)]
    fn evaluate<Q: F64x4, L: ContactForceLaw, R: Rolling, S: SizesOfPairs>(
        self,
        law: &L,
        rolling: R,
        mut sizes: S,
    ) -> Result<(), ForceOutOfRange> {
        let Self { particles, pairs, laws, .. } = self;
        let mut block = ContactBlock::default();
        let (mut no_angles, mut no_twist) = ([[0.0; LANES]; 3], [0.0; LANES]);
        let mut no_overlaps = [0.0; LANES];
        let count = pairs.count();
        let fetches = particles.exceed_caches();
        let PairBlocks { blocks, columns, .. } = pairs;
        let ContactColumns { largest_overlap, rolling_angle, twisting_angle, .. } = columns;
        for index in 0..blocks.len() {
            let (done, coming) = blocks.split_at_mut(index + 1);
            let pairs = &mut done[index];
            let ends = [&pairs.first, &pairs.second];
            let coming =
                if fetches { ComingBlocks::first_of(coming) } else { ComingBlocks::default() };
            block.gather::<Q, S>(&mut sizes, ends, (&particles.body, coming), R::ACTS);
            attract::<_, EXTRAS>(&mut block, &sizes, laws.cohesion);
            let rolling_angles = rolling_angle.get_mut(index).unwrap_or(&mut no_angles);
            let twisting_angles = twisting_angle.get_mut(index).unwrap_or(&mut no_twist);
            let histories = BlockHistories {
                tangential_springs: &mut pairs.tangential_spring,
                largest_overlaps: largest_overlap.get_mut(index).unwrap_or(&mut no_overlaps),
                rolling_angles,
                twisting_angles,
            };
            let (sizes_now, dt) = (&sizes, laws.dt);
            let of_block =
                PairsOfBlock { rolling, sizes: sizes_now, dt, block: &mut block, histories };
            evaluate_lanes(law, of_block);
            if any_is_set(&no_overlaps) {
                // The first contacts of a law that keeps largest overlaps need room for these.
                largest_overlap.resize(count.div_ceil(LANES), [0.0; LANES]);
                std::mem::swap(&mut largest_overlap[index], &mut no_overlaps);
            }
            block.copy_touching(&mut pairs.touching);
            let used = PairBlock::used(index, count);
            let targets = [ends[0], &pairs.target];
            let forces = (&mut particles.forces[..], coming);
            if let Err(excess) = block.scatter::<Q, R, S>((&sizes, &laws), targets, used, forces) {
                let ids = ends.map(|end| particles.id[end[excess.lane] as usize]);
                return Err(excess_force(&excess, &block, ids, laws.limit));
            }
        }
        Ok(())
    }
}

/// Whether a number has bits other than those of zero.
#[inline(always)]
fn any_is_set(numbers: &[f64; LANES]) -> bool {
    numbers.iter().fold(0, |bits, number| bits | number.to_bits()) != 0
}

/// The error of a pair whose force exceeds the limit.
#[cold]
fn excess_force(
    excess: &ExcessForce,
    block: &ContactBlock,
    [i, j]: [u64; 2],
    limit: f64,
) -> ForceOutOfRange {
    let ExcessForce { lane, force_on_j } = *excess;
    out_of_range(i, format!("particle {j}"), force_on_j, block.overlap[lane], limit)
}
