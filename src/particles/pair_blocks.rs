//! Pairs side by side in blocks, with their contact histories: the memory that the loop over forces streams through.

use super::contact_history::ContactHistory;
use nalgebra::Vector3;

/// Number of pairs in a block. With fewer than about 16 the compiler unrolls the loop over lanes before it has turned
/// it into vector instructions.
pub(crate) const LANES: usize = 32;

/// A number for each pair or particle of a block. A structure of these that lies on the stack is aligned to a cache line: where the
/// stack of a process lies differs from run to run, and in half of all runs every second vector of four numbers would lie in two lines.
pub(crate) type Lanes = [f64; LANES];

/// Tangential springs of the pairs of a block, axis by axis.
pub(crate) type SpringLanes = [Lanes; 3];

/// Deflection angles of rolling springs, axis by axis.
pub(crate) type AngleLanes = [Lanes; 3];

/// A block of pairs, contiguous in memory. It is aligned to a vector of four numbers, so that none lies in two cache lines; aligned to a
/// cache line, it would be 32 bytes longer.
#[derive(Clone, Debug)]
#[repr(C, align(32))]
pub(crate) struct PairBlock {
    /// Tangential springs, seen from the first particle.
    pub(crate) tangential_spring: SpringLanes,
    /// First particle of each pair, an owned one.
    pub(crate) first: [u32; LANES],
    /// Second particle, an owned one or a ghost.
    pub(crate) second: [u32; LANES],
    /// Particle that the force on the second is added to: the owned one that it is an image of, or itself.
    pub(crate) target: [u32; LANES],
    /// Whether they touched when the force was last evaluated.
    pub(crate) touching: [bool; LANES],
}

/// A pair: its first and its second particle, and the particle that the force on the second is added to.
pub(crate) type Pair = [u32; 3];

/// The history of a touching pair, seen from its first particle.
#[derive(Clone, Copy, Debug)]
pub(super) struct OrientedHistory {
    pub(super) history: ContactHistory,
    /// Zero without a rolling spring.
    pub(super) rolling_angle: Vector3<f64>,
    /// Zero without a twisting spring.
    pub(super) twisting_angle: f64,
}

/// What a contact remembers from the last step; all zero if the bodies did not touch.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Remembered {
    pub(crate) history: ContactHistory,
    pub(crate) rolling_angle: Vector3<f64>,
    pub(crate) twisting_angle: f64,
    /// Whether the bodies touched.
    pub(crate) touching: bool,
}

/// Pairs in blocks. Unused lanes of the last block hold a pair whose results are not used.
#[derive(Clone, Debug, Default)]
pub(crate) struct PairBlocks {
    /// The blocks.
    pub(crate) blocks: Vec<PairBlock>,
    /// Largest overlaps; empty while all are zero, as with a law that does not keep them.
    pub(crate) largest_overlap: Vec<[f64; LANES]>,
    /// Angles of rolling springs, seen from the first particle; empty without such springs.
    pub(crate) rolling_angle: Vec<AngleLanes>,
    /// Angles of twisting springs; empty without such springs.
    pub(crate) twisting_angle: Vec<[f64; LANES]>,
    /// Whether there are rolling springs, and twisting springs.
    holds: [bool; 2],
    count: usize,
}

impl PairBlock {
    /// A block filled with one pair, without history.
    fn of([first, second, target]: Pair) -> Self {
        Self {
            tangential_spring: [[0.0; LANES]; 3],
            first: [first; LANES],
            second: [second; LANES],
            target: [target; LANES],
            touching: [false; LANES],
        }
    }

    /// Number of pairs in block `index`, of `count` pairs in all.
    pub(crate) fn used(index: usize, count: usize) -> usize {
        (count - index * LANES).min(LANES)
    }
}

impl PairBlocks {
    /// Number of pairs.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Makes room for the angles of rolling and of twisting springs, all zero, or drops them: a spring that is switched off
    /// and on again starts without deflection.
    pub(crate) fn hold_angles(&mut self, rolling: bool, twisting: bool) {
        self.holds = [rolling, twisting];
        let blocks = |hold: bool| if hold { self.blocks.len() } else { 0 };
        let [of_rolling, of_twisting] = self.holds.map(blocks);
        self.rolling_angle.resize(of_rolling, [[0.0; LANES]; 3]);
        self.twisting_angle.resize(of_twisting, [0.0; LANES]);
    }

    /// Makes room for the largest overlaps, all zero before.
    fn hold_largest_overlaps(&mut self) {
        self.largest_overlap.resize(self.blocks.len(), [0.0; LANES]);
    }

    pub(super) fn clear(&mut self) {
        self.blocks.clear();
        self.largest_overlap.clear();
        self.rolling_angle.clear();
        self.twisting_angle.clear();
        self.count = 0;
    }

    /// First and second particle of each pair.
    pub(super) fn pairs(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        (0..self.count).map(|pair| {
            let (block, lane) = (&self.blocks[pair / LANES], pair % LANES);
            [block.first[lane], block.second[lane]]
        })
    }

    /// All pairs, first and second particle, and what they remember.
    pub(crate) fn all(&self) -> impl Iterator<Item = ([u32; 2], Remembered)> + '_ {
        self.pairs().enumerate().map(|(place, pair)| {
            let known = self.history(place);
            let OrientedHistory { history, rolling_angle, twisting_angle } =
                known.unwrap_or(OrientedHistory::ZERO);
            let touching = known.is_some();
            (pair, Remembered { history, rolling_angle, twisting_angle, touching })
        })
    }

    /// The touching pairs, first and second particle, and their histories.
    pub(super) fn touching(&self) -> impl Iterator<Item = ([u32; 2], OrientedHistory)> + '_ {
        let pairs = self.pairs().enumerate();
        pairs.filter_map(|(place, pair)| self.history(place).map(|history| (pair, history)))
    }

    /// First and second particle of the touching pairs.
    pub(super) fn touching_indices(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        let blocks = self.blocks.iter().enumerate();
        blocks.flat_map(|(index, block)| {
            let lanes = 0..PairBlock::used(index, self.count);
            let touching = lanes.filter(|&lane| block.touching[lane]);
            touching.map(|lane| [block.first[lane], block.second[lane]])
        })
    }

    /// All pairs, and the histories of those that touch, without angles of rolling.
    pub(super) fn with_histories(
        &self,
    ) -> impl Iterator<Item = ([u32; 2], Option<ContactHistory>)> + '_ {
        self.pairs()
            .enumerate()
            .map(|(place, pair)| (pair, self.history(place).map(|oriented| oriented.history)))
    }

    /// The history of the pair at a place, if it touches.
    fn history(&self, place: usize) -> Option<OrientedHistory> {
        let (block, lane) = (&self.blocks[place / LANES], place % LANES);
        let number = |column: &[[f64; LANES]]| column.get(place / LANES).map_or(0.0, |of| of[lane]);
        block.touching[lane].then(|| OrientedHistory {
            history: ContactHistory {
                tangential_spring: block.tangential_spring.map(|axis| axis[lane]).into(),
                largest_overlap: number(&self.largest_overlap),
            },
            rolling_angle: match self.rolling_angle.get(place / LANES) {
                Some(angle) => Vector3::from_fn(|axis, _| angle[axis][lane]),
                None => Vector3::zeros(),
            },
            twisting_angle: number(&self.twisting_angle),
        })
    }

    pub(super) fn push(&mut self, pair: Pair, history: Option<OrientedHistory>) {
        if self.count.is_multiple_of(LANES) {
            self.blocks.push(PairBlock::of(pair));
            if !self.largest_overlap.is_empty() {
                self.largest_overlap.push([0.0; LANES]);
            }
            let [rolling, twisting] = self.holds;
            if rolling {
                self.rolling_angle.push([[0.0; LANES]; 3]);
            }
            if twisting {
                self.twisting_angle.push([0.0; LANES]);
            }
        }
        self.count += 1;
        self.put(self.count - 1, pair, history);
    }

    fn put(&mut self, place: usize, pair: Pair, history: Option<OrientedHistory>) {
        let (index, lane) = (place / LANES, place % LANES);
        let block = &mut self.blocks[index];
        [block.first[lane], block.second[lane], block.target[lane]] = pair;
        block.touching[lane] = history.is_some();
        let OrientedHistory { history, rolling_angle, twisting_angle } =
            history.unwrap_or(OrientedHistory::ZERO);
        let ContactHistory { tangential_spring, largest_overlap } = history;
        (0..3).for_each(|axis| block.tangential_spring[axis][lane] = tangential_spring[axis]);
        if largest_overlap != 0.0 {
            self.hold_largest_overlaps();
        }
        if let Some(overlaps) = self.largest_overlap.get_mut(index) {
            overlaps[lane] = largest_overlap;
        }
        let [rolling, twisting] = self.holds;
        if rolling_angle != Vector3::zeros() || twisting_angle != 0.0 {
            let bent = rolling_angle != Vector3::zeros();
            self.hold_angles(rolling || bent, twisting || twisting_angle != 0.0);
        }
        if let Some(angles) = self.rolling_angle.get_mut(index) {
            (0..3).for_each(|axis| angles[axis][lane] = rolling_angle[axis]);
        }
        if let Some(angles) = self.twisting_angle.get_mut(index) {
            angles[lane] = twisting_angle;
        }
    }

    /// Drops the pairs that do not touch and for which `keep` does not hold; the others stay in their order.
    pub(super) fn retain(&mut self, keep: impl Fn([u32; 2]) -> bool) {
        let mut kept = 0;
        for place in 0..self.count {
            let (block, lane) = (&self.blocks[place / LANES], place % LANES);
            let pair = [block.first[lane], block.second[lane], block.target[lane]];
            if block.touching[lane] || keep([pair[0], pair[1]]) {
                if kept != place {
                    self.put(kept, pair, self.history(place));
                }
                kept += 1;
            }
        }
        self.truncate(kept);
    }

    /// Keeps the first pairs; the rest of their last block is filled up.
    fn truncate(&mut self, count: usize) {
        let blocks = count.div_ceil(LANES);
        self.blocks.truncate(blocks);
        self.largest_overlap.truncate(blocks);
        self.rolling_angle.truncate(blocks);
        self.twisting_angle.truncate(blocks);
        self.count = count;
        if let Some(block) = self.blocks.last() {
            let filling = [block.first[0], block.second[0], block.target[0]];
            (count..blocks * LANES).for_each(|place| self.put(place, filling, None));
        }
    }
}

impl OrientedHistory {
    const ZERO: Self = Self {
        history: ContactHistory {
            tangential_spring: Vector3::new(0.0, 0.0, 0.0),
            largest_overlap: 0.0,
        },
        rolling_angle: Vector3::new(0.0, 0.0, 0.0),
        twisting_angle: 0.0,
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    fn history(number: u32) -> OrientedHistory {
        let number = f64::from(number);
        let history = ContactHistory {
            tangential_spring: Vector3::new(number, 2.0 * number, 0.0),
            largest_overlap: 0.5 * number,
        };
        let (rolling_angle, twisting_angle) = (Vector3::x() * number, 3.0 * number);
        OrientedHistory { history, rolling_angle, twisting_angle }
    }

    /// Pairs (k, k + 1000), each third of them touching.
    fn blocks(count: u32) -> PairBlocks {
        let mut pairs = PairBlocks::default();
        for k in 0..count {
            pairs.push([k, k + 1000, k + 2000], k.is_multiple_of(3).then(|| history(k)));
        }
        pairs
    }

    #[test]
    fn pushed_pairs_are_found_again() {
        let pairs = blocks(100);
        assert_eq!((pairs.count(), pairs.blocks.len(), pairs.rolling_angle.len()), (100, 4, 4));
        assert_eq!(pairs.largest_overlap.len(), 4);
        assert!(pairs.pairs().eq((0..100).map(|k| [k, k + 1000])));
        for ([first, _], found) in pairs.touching() {
            assert_eq!(found.history, history(first).history);
            assert_eq!(found.rolling_angle, history(first).rolling_angle);
            assert_eq!(found.twisting_angle, history(first).twisting_angle);
        }
        assert_eq!(pairs.touching().count(), 34);
    }

    #[test]
    fn largest_overlaps_take_memory_only_once_one_is_not_zero() {
        let mut pairs = PairBlocks::default();
        let elastic = |number: u32| {
            let tangential_spring = history(number).history.tangential_spring;
            let history = ContactHistory { tangential_spring, largest_overlap: 0.0 };
            OrientedHistory { history, ..OrientedHistory::ZERO }
        };
        (0..40).for_each(|k| pairs.push([k, k, k], Some(elastic(k))));
        assert!(pairs.largest_overlap.is_empty());
        assert!(pairs.touching().all(|(_, found)| found.history.largest_overlap == 0.0));
        pairs.push([40, 40, 40], Some(history(40)));
        let overlaps: Vec<f64> =
            pairs.touching().map(|(_, found)| found.history.largest_overlap).collect();
        assert_eq!((overlaps[39], overlaps[40]), (0.0, 20.0));
        assert_eq!(pairs.largest_overlap.len(), pairs.blocks.len());
    }

    #[test]
    fn touching_pairs_and_those_wanted_are_retained_in_their_order() {
        let mut pairs = blocks(100);
        pairs.retain(|[first, second]| first.is_multiple_of(7) && second == first + 1000);
        let expected = (0..100).filter(|k| k % 3 == 0 || k % 7 == 0);
        assert!(pairs.pairs().map(|[first, _]| first).eq(expected));
        assert!(pairs.touching().all(|([k, _], found)| found.history == history(k).history));
        assert_eq!(pairs.touching().count(), 34);
        let last = pairs.blocks.last().unwrap();
        let used = PairBlock::used(pairs.blocks.len() - 1, pairs.count());
        assert!(last.touching[used..].iter().all(|touching| !touching));
        assert!(last.tangential_spring.iter().all(|axis| axis[used..] == [0.0; LANES][used..]));
        assert_eq!(pairs.largest_overlap.last().unwrap()[used..], [0.0; LANES][used..]);
        pairs.retain(|_| false);
        assert_eq!(pairs.count(), 34);
    }
}
