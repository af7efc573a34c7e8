//! Pairs side by side in blocks, with their contact histories: the memory that the loop over forces streams through.

use super::contact_state::{ContactHistory, ContactState};

/// Number of pairs in a block. With fewer than about 16 the compiler unrolls the loop over lanes before it has turned
/// it into vector instructions.
pub(crate) const LANES: usize = 32;

/// A number for each pair or particle of a block. A structure of these on the stack is aligned to a cache line: the
/// address of the stack of a process differs from run to run, and in half of all runs every second vector of four
/// numbers would otherwise lie in two lines.
pub(crate) type Lanes = [f64; LANES];

/// Tangential springs of the pairs of a block, axis by axis.
pub(crate) type SpringLanes = [Lanes; 3];

/// Deflection angles of rolling springs, axis by axis.
pub(crate) type AngleLanes = [Lanes; 3];

/// A block of pairs, contiguous in memory. It is aligned to a vector of four numbers, so that no vector lies in two
/// cache lines; aligned to a cache line, it would be 32 bytes longer.
#[derive(Clone, Debug)]
#[repr(C, align(32))]
pub(crate) struct PairBlock {
    /// Tangential springs, seen from the first particle.
    pub(crate) tangential_spring: SpringLanes,
    /// First particle of each pair, an owned one.
    pub(crate) first: [u32; LANES],
    /// Second particle, an owned one or a ghost.
    pub(crate) second: [u32; LANES],
    /// Particle to which the force on the second is added: the owned particle of which it is an image, or itself.
    pub(crate) target: [u32; LANES],
    /// Whether the pairs touched when the force was last evaluated.
    pub(crate) touching: [bool; LANES],
}

/// A pair: its first and its second particle, and the particle to which the force on the second is added.
pub(crate) type Pair = [u32; 3];

/// Pairs in blocks. Unused lanes of the last block hold a pair whose results are not used.
#[derive(Clone, Debug, Default)]
pub(crate) struct PairBlocks {
    /// The blocks.
    pub(crate) blocks: Vec<PairBlock>,
    /// Further data of contacts.
    pub(crate) columns: ContactColumns,
    count: usize,
}

/// Data of contacts besides the tangential spring, seen from the first particle: a column for each further field of
/// [`ContactState`], block after block. A column takes no memory while all its numbers are zero and no law holds it.
/// The loop over pairs reads the columns in this form: each is a vector of blocks, whose address stays in a register.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactColumns {
    pub(crate) largest_overlap: Vec<Lanes>,
    pub(crate) rolling_angle: Vec<AngleLanes>,
    pub(crate) twisting_angle: Vec<Lanes>,
    /// Whether laws have rolling springs, and whether they have twisting springs.
    holds: [bool; 2],
}

impl ContactColumns {
    /// Makes room for the angles of springs in this number of blocks, all zero, or drops them.
    fn hold_angles(&mut self, holds: [bool; 2], blocks: usize) {
        self.holds = holds;
        let [rolling, twisting] = holds.map(|holds| if holds { blocks } else { 0 });
        self.rolling_angle.resize(rolling, [[0.0; LANES]; 3]);
        self.twisting_angle.resize(twisting, [0.0; LANES]);
    }

    /// Keeps the columns of this number of blocks, or makes room for more.
    fn resize(&mut self, blocks: usize) {
        if !self.largest_overlap.is_empty() {
            self.largest_overlap.resize(blocks, [0.0; LANES]);
        }
        self.hold_angles(self.holds, blocks);
    }

    fn clear(&mut self) {
        self.largest_overlap.clear();
        self.hold_angles([false; 2], 0);
    }

    /// Puts the numbers of a contact into a lane.
    fn put(&mut self, blocks: usize, (index, lane): (usize, usize), state: &ContactState) {
        if state.largest_overlap != 0.0 {
            self.largest_overlap.resize(blocks, [0.0; LANES]);
        }
        let bent = [state.rolling_angle != [0.0; 3], state.twisting_angle != 0.0];
        if bent != [false; 2] {
            self.hold_angles([self.holds[0] || bent[0], self.holds[1] || bent[1]], blocks);
        }
        if let Some(overlaps) = self.largest_overlap.get_mut(index) {
            overlaps[lane] = state.largest_overlap;
        }
        if let Some(angles) = self.rolling_angle.get_mut(index) {
            (0..3).for_each(|axis| angles[axis][lane] = state.rolling_angle[axis]);
        }
        if let Some(angles) = self.twisting_angle.get_mut(index) {
            angles[lane] = state.twisting_angle;
        }
    }

    /// Takes the numbers of a contact from a lane.
    fn get(&self, (index, lane): (usize, usize), state: &mut ContactState) {
        let number = |column: &[Lanes]| column.get(index).map_or(0.0, |lanes| lanes[lane]);
        state.largest_overlap = number(&self.largest_overlap);
        state.twisting_angle = number(&self.twisting_angle);
        if let Some(angles) = self.rolling_angle.get(index) {
            state.rolling_angle = angles.map(|axis| axis[lane]);
        }
    }
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

    /// Makes room for the angles of rolling and of twisting springs, all zero, or drops them: a spring that is switched
    /// off and on again starts without deflection.
    pub(crate) fn hold_angles(&mut self, rolling: bool, twisting: bool) {
        self.columns.hold_angles([rolling, twisting], self.blocks.len());
    }

    pub(super) fn clear(&mut self) {
        self.blocks.clear();
        self.columns.clear();
        self.count = 0;
    }

    /// First and second particle of each pair.
    pub(super) fn pairs(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        (0..self.count).map(|pair| {
            let (block, lane) = (&self.blocks[pair / LANES], pair % LANES);
            [block.first[lane], block.second[lane]]
        })
    }

    /// All pairs, as first and second particle; touching ones with the state of their contact.
    pub(crate) fn all(&self) -> impl Iterator<Item = ([u32; 2], Option<ContactState>)> + '_ {
        self.pairs().enumerate().map(|(place, pair)| (pair, self.state(place)))
    }

    /// The touching pairs, as first and second particle, and the states of their contacts.
    pub(super) fn touching(&self) -> impl Iterator<Item = ([u32; 2], ContactState)> + '_ {
        self.all().filter_map(|(pair, state)| state.map(|state| (pair, state)))
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

    /// All pairs; touching ones with the history that their law sees.
    pub(super) fn with_histories(
        &self,
    ) -> impl Iterator<Item = ([u32; 2], Option<ContactHistory>)> + '_ {
        self.all().map(|(pair, state)| (pair, state.map(|state| state.history())))
    }

    /// The state of the contact of the pair at a place, if it touches.
    fn state(&self, place: usize) -> Option<ContactState> {
        let (block, lane) = (&self.blocks[place / LANES], place % LANES);
        block.touching[lane].then(|| {
            let tangential_spring = block.tangential_spring.map(|axis| axis[lane]);
            let mut state = ContactState { tangential_spring, ..ContactState::default() };
            self.columns.get((place / LANES, lane), &mut state);
            state
        })
    }

    pub(super) fn push(&mut self, pair: Pair, state: Option<ContactState>) {
        if self.count.is_multiple_of(LANES) {
            self.blocks.push(PairBlock::of(pair));
            self.columns.resize(self.blocks.len());
        }
        self.count += 1;
        self.put(self.count - 1, pair, state);
    }

    fn put(&mut self, place: usize, pair: Pair, state: Option<ContactState>) {
        let (index, lane) = (place / LANES, place % LANES);
        let blocks = self.blocks.len();
        let block = &mut self.blocks[index];
        [block.first[lane], block.second[lane], block.target[lane]] = pair;
        block.touching[lane] = state.is_some();
        let state = state.unwrap_or_default();
        (0..3).for_each(|axis| block.tangential_spring[axis][lane] = state.tangential_spring[axis]);
        self.columns.put(blocks, (index, lane), &state);
    }

    /// Drops the pairs that do not touch and for which `keep` does not hold; the others stay in their order.
    pub(super) fn retain(&mut self, keep: impl Fn([u32; 2]) -> bool) {
        let mut kept = 0;
        for place in 0..self.count {
            let (block, lane) = (&self.blocks[place / LANES], place % LANES);
            let pair = [block.first[lane], block.second[lane], block.target[lane]];
            if block.touching[lane] || keep([pair[0], pair[1]]) {
                if kept != place {
                    self.put(kept, pair, self.state(place));
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
        self.columns.resize(blocks);
        self.count = count;
        if let Some(block) = self.blocks.last() {
            let filling = [block.first[0], block.second[0], block.target[0]];
            (count..blocks * LANES).for_each(|place| self.put(place, filling, None));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(number: u32) -> ContactState {
        let number = f64::from(number);
        ContactState {
            tangential_spring: [number, 2.0 * number, 0.0],
            largest_overlap: 0.5 * number,
            rolling_angle: [number, 0.0, 0.0],
            twisting_angle: 3.0 * number,
        }
    }

    /// Number of blocks for which each column has room.
    fn held_blocks(pairs: &PairBlocks) -> [usize; 3] {
        let ContactColumns { largest_overlap, rolling_angle, twisting_angle, .. } = &pairs.columns;
        [largest_overlap.len(), rolling_angle.len(), twisting_angle.len()]
    }

    /// Pairs (k, k + 1000), every third of which touches.
    fn blocks(count: u32) -> PairBlocks {
        let mut pairs = PairBlocks::default();
        for k in 0..count {
            pairs.push([k, k + 1000, k + 2000], k.is_multiple_of(3).then(|| state(k)));
        }
        pairs
    }

    #[test]
    fn pushed_pairs_are_found_again() {
        let pairs = blocks(100);
        assert_eq!((pairs.count(), pairs.blocks.len()), (100, 4));
        assert_eq!(held_blocks(&pairs), [4; 3]);
        assert!(pairs.pairs().eq((0..100).map(|k| [k, k + 1000])));
        for ([first, _], found) in pairs.touching() {
            assert_eq!(found, state(first));
        }
        assert_eq!(pairs.touching().count(), 34);
    }

    #[test]
    fn columns_take_memory_only_once_a_number_is_not_zero() {
        let mut pairs = PairBlocks::default();
        let elastic = |number: u32| {
            let tangential_spring = state(number).tangential_spring;
            ContactState { tangential_spring, ..ContactState::default() }
        };
        (0..40).for_each(|k| pairs.push([k, k, k], Some(elastic(k))));
        assert_eq!(held_blocks(&pairs), [0; 3]);
        assert!(pairs.touching().all(|(_, found)| found.largest_overlap == 0.0));
        pairs.push([40, 40, 40], Some(state(40)));
        let overlaps: Vec<f64> = pairs.touching().map(|(_, found)| found.largest_overlap).collect();
        assert_eq!((overlaps[39], overlaps[40]), (0.0, 20.0));
        assert_eq!(held_blocks(&pairs), [pairs.blocks.len(); 3]);
    }

    #[test]
    fn touching_pairs_and_those_wanted_are_retained_in_their_order() {
        let mut pairs = blocks(100);
        pairs.retain(|[first, second]| first.is_multiple_of(7) && second == first + 1000);
        let expected = (0..100).filter(|k| k % 3 == 0 || k % 7 == 0);
        assert!(pairs.pairs().map(|[first, _]| first).eq(expected));
        assert!(pairs.touching().all(|([k, _], found)| found == state(k)));
        assert_eq!(pairs.touching().count(), 34);
        let last = pairs.blocks.last().unwrap();
        let used = PairBlock::used(pairs.blocks.len() - 1, pairs.count());
        assert!(last.touching[used..].iter().all(|touching| !touching));
        assert!(last.tangential_spring.iter().all(|axis| axis[used..] == [0.0; LANES][used..]));
        let overlaps = pairs.columns.largest_overlap.last().unwrap();
        assert_eq!(overlaps[used..], [0.0; LANES][used..]);
        pairs.retain(|_| false);
        assert_eq!(pairs.count(), 34);
    }
}
