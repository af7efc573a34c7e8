//! Pairs side by side in blocks, with their contact histories: the memory that the loop over forces streams through.

use super::contact_history::ContactHistory;
use nalgebra::Vector3;

/// Number of pairs in a block. With fewer than about 16 the compiler unrolls the loop over lanes before it has turned
/// it into vector instructions.
pub(crate) const LANES: usize = 32;

/// Numbers in a contact history.
pub(crate) const HISTORY_FIELDS: usize = size_of::<ContactHistory>() / size_of::<f64>();

/// The contact histories of the pairs of a block, number by number.
pub(crate) type HistoryLanes = [[f64; LANES]; HISTORY_FIELDS];

/// Deflection angles of rolling springs, axis by axis.
pub(crate) type AngleLanes = [[f64; LANES]; 3];

/// A block of pairs, contiguous in memory.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct PairBlock {
    /// Contact histories, seen from the first particle.
    pub(crate) history: HistoryLanes,
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
            history: [[0.0; LANES]; HISTORY_FIELDS],
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

    pub(super) fn clear(&mut self) {
        self.blocks.clear();
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
        block.touching[lane].then(|| OrientedHistory {
            history: bytemuck::cast(block.history.map(|field| field[lane])),
            rolling_angle: match self.rolling_angle.get(place / LANES) {
                Some(angle) => Vector3::from_fn(|axis, _| angle[axis][lane]),
                None => Vector3::zeros(),
            },
            twisting_angle: self.twisting_angle.get(place / LANES).map_or(0.0, |angle| angle[lane]),
        })
    }

    pub(super) fn push(&mut self, pair: Pair, history: Option<OrientedHistory>) {
        if self.count.is_multiple_of(LANES) {
            self.blocks.push(PairBlock::of(pair));
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
        let numbers: [f64; HISTORY_FIELDS] = bytemuck::cast(history);
        for (field, number) in block.history.iter_mut().zip(numbers) {
            field[lane] = number;
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
        assert!(pairs.pairs().eq((0..100).map(|k| [k, k + 1000])));
        for ([first, _], found) in pairs.touching() {
            assert_eq!(found.history, history(first).history);
            assert_eq!(found.rolling_angle, history(first).rolling_angle);
            assert_eq!(found.twisting_angle, history(first).twisting_angle);
        }
        assert_eq!(pairs.touching().count(), 34);
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
        assert!(last.history.iter().all(|field| field[used..] == [0.0; LANES][used..]));
        pairs.retain(|_| false);
        assert_eq!(pairs.count(), 34);
    }
}
