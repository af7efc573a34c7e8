//! The loop over pairs that may touch: blocks of pairs are gathered into lanes, evaluated, and added to the particles.

use super::attraction::attract;
use crate::contact::force_laws::{ForceOutOfRange, PairLaws, out_of_range};
use crate::contact::lanes::{
    BlockHistories, ComingBlocks, ContactBlock, ExcessForce, LawOnBlock, LoopOverBlocks, ManySizes,
    OneSize, PairsOfBlock, SizesOfPairs, WithRegisters,
};
use crate::contact::rolling::{
    ConstantTorque, ElasticPlastic, NoRolling, Rolling, RollingAndTwisting,
};
use crate::contact::{ContactModel, RollingKind};
use crate::numbers::{F64x4, vectorised};
use crate::particles::{ContactColumns, LANES, PairBlock, PairBlocks, Part, Particles};

/// Pairs that may touch, and what acts between them. With `EXTRAS`, resistance to twisting and asperities are known too: they
/// have a loop of their own, so that the common one stays small.
pub(super) struct ContactLoop<'a, const EXTRAS: bool> {
    pub(super) particles: &'a mut Particles,
    pub(super) pairs: &'a mut PairBlocks,
    pub(super) part: Part,
    /// Radius and mass, if all particles have the same.
    pub(super) one_size: Option<[f64; 2]>,
    pub(super) laws: PairLaws<'a>,
}

vectorised!(
    /// Adds the forces and torques of pairs that may touch. Chooses the law once, for all pairs.
    ///
    /// # Errors
    /// If a force exceeds the limit or is undefined.
    pub(super) fn add_contacts<Q: F64x4, const EXTRAS: bool>(
        contacts: ContactLoop<'_, EXTRAS>,
    ) -> Result<(), ForceOutOfRange> {
        let law = &contacts.laws.contact.law;
        law.dispatch(WithRegisters::<_, Q>::new(contacts))
    }
);

impl<const EXTRAS: bool> LoopOverBlocks for ContactLoop<'_, EXTRAS> {
    type Output = Result<(), ForceOutOfRange>;

    /// Chooses how rolling and twisting are resisted.
    #[inline(always)]
    fn run<Q: F64x4, L: LawOnBlock>(self, law: &L) -> Self::Output {
        let ContactModel { rolling, twisting, .. } = self.laws.contact;
        let (rolling, twisting) = (*rolling, twisting.filter(|_| EXTRAS));
        if let Some(twisting) = twisting {
            let resistance = RollingAndTwisting { rolling, twisting };
            return self.evaluate::<Q, _, _, _>(law, resistance, ManySizes::default());
        }
        let Some(rolling) = rolling else { return self.with_sizes::<Q, _, _>(law, NoRolling) };
        match rolling.kind() {
            RollingKind::ConstantTorque => self.with_sizes::<Q, _, _>(law, ConstantTorque(rolling)),
            RollingKind::ElasticPlastic { damping } => {
                self.with_sizes::<Q, _, _>(law, ElasticPlastic(rolling, damping))
            }
        }
    }
}

impl<const EXTRAS: bool> ContactLoop<'_, EXTRAS> {
    /// Chooses whether all particles have one size.
    #[inline(always)]
    fn with_sizes<Q: F64x4, L: LawOnBlock, R: Rolling>(
        self,
        law: &L,
        rolling: R,
    ) -> Result<(), ForceOutOfRange> {
        match self.one_size.filter(|_| !EXTRAS) {
            Some([radius, mass]) => {
                self.evaluate::<Q, _, _, _>(law, rolling, OneSize { radius, mass })
            }
            None => self.evaluate::<Q, _, _, _>(law, rolling, ManySizes::default()),
        }
    }

    #[inline(always)]
    fn evaluate<Q: F64x4, L: LawOnBlock, R: Rolling, S: SizesOfPairs>(
        self,
        law: &L,
        rolling: R,
        mut sizes: S,
    ) -> Result<(), ForceOutOfRange> {
        let Self { particles, pairs, part, laws, .. } = self;
        let mut block = ContactBlock::default();
        let (mut no_angles, mut no_twist) = ([[0.0; LANES]; 3], [0.0; LANES]);
        let mut no_overlaps = [0.0; LANES];
        let count = pairs.count();
        let fetches = particles.exceed_caches();
        let PairBlocks { blocks, columns, .. } = pairs;
        let ContactColumns { largest_overlap, rolling_angle, twisting_angle, .. } = columns;
        let range = part.of(blocks.len());
        let (first, blocks) = (range.start, &mut blocks[range]);
        for number in 0..blocks.len() {
            let index = first + number;
            let (done, coming) = blocks.split_at_mut(number + 1);
            let pairs = &mut done[number];
            let ends = [&pairs.first, &pairs.second];
            let coming = match fetches {
                true => ComingBlocks::first_of(coming),
                false => ComingBlocks::default(),
            };
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
            law.evaluate(PairsOfBlock {
                rolling,
                sizes: &sizes,
                dt: laws.dt,
                block: &mut block,
                histories,
            });
            if any_is_set(&no_overlaps) {
                // The first contacts of a law that keeps largest overlaps.
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

/// Whether a number has other bits than zero.
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
