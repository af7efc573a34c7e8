//! Numbers handed between cells and the pairs that they form along one axis.

use super::transfer::Transfer;
use crate::grid::{Field, LocalCells};
use crate::numbers::{VectorWork, in_wide_vectors};
use std::ops::Range;

/// Which cells are paired. The pair of the cells 2m and 2m + 1 belongs to the owner of the first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pairs {
    pub(super) axis: usize,
    pub(super) fine: LocalCells,
    pub(super) coarse: LocalCells,
    pub(super) periodic: bool,
}

/// Fine cells at equal distances along x.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    /// The first.
    pub(super) place: [isize; 3],
    /// Its number along the axis of the pairs, in the whole grid.
    pub(super) number: usize,
    distance: usize,
    length: usize,
}

impl Run {
    /// Places in memory, from that of the first cell.
    #[inline(always)]
    pub(super) fn cells(self, first: usize) -> impl Iterator<Item = usize> {
        (0..self.length).map(move |i| first + i * self.distance)
    }
}

impl Pairs {
    /// Owned fine cells, in pieces of rows along x in which all numbers along the axis are even, or all odd.
    pub(super) fn runs(&self) -> impl Iterator<Item = Run> + use<> {
        let pairs = *self;
        let [nx, ny, nz] = self.fine.count.map(|count| count as isize);
        let (phases, distance) = if self.axis == 0 { (nx.min(2), 2) } else { (1, 1) };
        starts([0..1, 0..ny, 0..nz]).flat_map(move |[_, j, k]| {
            (0..phases).map(move |i| {
                let place = [i, j, k];
                let length = ((nx - i) as usize).div_ceil(distance);
                Run { place, number: pairs.number(place), distance, length }
            })
        })
    }

    /// Places where the rows of owned pairs begin, in the order of [`Field::rows`].
    pub(super) fn coarse_rows(&self) -> impl Iterator<Item = [isize; 3]> + use<> {
        let [_, ny, nz] = self.coarse.count.map(|count| count as isize);
        starts([0..1, 0..ny, 0..nz])
    }

    /// Number along the axis, in the whole grid, of a fine cell.
    pub(super) fn number(&self, place: [isize; 3]) -> usize {
        (self.fine.start[self.axis] as isize + place[self.axis]) as usize
    }

    /// The first fine cell of a pair.
    pub(super) fn first_of(&self, mut place: [isize; 3]) -> [isize; 3] {
        let number = 2 * (self.coarse.start[self.axis] as isize + place[self.axis]);
        place[self.axis] = number - self.fine.start[self.axis] as isize;
        place
    }

    /// Whether the pair of this number is a single cell with the first cell of the grid above it.
    pub(super) fn wraps_alone(&self, number: isize) -> bool {
        let (cells, pairs) = (self.fine.counts[self.axis], self.coarse.counts[self.axis]);
        self.periodic && cells % 2 == 1 && number + 1 == pairs as isize
    }

    /// Owned pairs; across axes before this one the halo too, for going on along those.
    fn restricted(&self) -> [Range<isize>; 3] {
        [0, 1, 2].map(|axis| {
            let count = self.coarse.count[axis] as isize;
            if axis < self.axis { -2..count + 2 } else { 0..count }
        })
    }

    /// Owned cells; across axes after this one one cell of the halo too, unless this axis is the last.
    fn prolonged(&self, last: bool) -> [Range<isize>; 3] {
        [0, 1, 2].map(|axis| {
            let count = self.fine.count[axis] as isize;
            if axis > self.axis && !last { -1..count + 1 } else { 0..count }
        })
    }
}

impl Transfer {
    /// Sums over cells their weights times their numbers. Before: the halo of `fine`, two cells, is current.
    pub(super) fn restrict(&self, fine: &Field, coarse: &mut Field) {
        in_wide_vectors(Restrict { transfer: self, fine, coarse });
    }

    /// Interpolates between pairs. Before: the halo of `coarse` is current, along axes after this one too.
    pub(super) fn prolong(&self, coarse: &Field, fine: &mut Field) {
        in_wide_vectors(Prolong::<false> { transfer: self, coarse, fine });
    }

    /// Adds what is interpolated to owned cells.
    pub(super) fn correct(&self, coarse: &Field, fine: &mut Field) {
        in_wide_vectors(Prolong::<true> { transfer: self, coarse, fine });
    }
}

/// Cells at which rows along x begin.
#[inline(always)]
fn starts([x, y, z]: [Range<isize>; 3]) -> impl Iterator<Item = [isize; 3]> {
    let start = x.start;
    z.flat_map(move |k| y.clone().map(move |j| [start, j, k]))
}

struct Restrict<'a> {
    transfer: &'a Transfer,
    fine: &'a Field,
    coarse: &'a mut Field,
}

impl VectorWork for Restrict<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { transfer: Transfer { pairs, lean, .. }, fine, coarse } = self;
        let ranges = pairs.restricted();
        let length = ranges[0].len();
        let along = fine.strides()[pairs.axis];
        let (lean, numbers) = (lean.values(), fine.values());
        for place in starts(ranges) {
            let first = fine.index(pairs.first_of(place));
            let to = coarse.index(place);
            let sums = &mut coarse.values_mut()[to..][..length];
            let number = pairs.coarse.start[pairs.axis] as isize + place[pairs.axis];
            if pairs.axis == 0 {
                gather_along_x(&lean[first - 1..], &numbers[first - 1..], sums);
                let last = length - 1;
                if pairs.wraps_alone(number + last as isize) {
                    sums[last] = alone(lean, numbers, first + 2 * last, 1);
                }
            } else if pairs.wraps_alone(number) {
                for (i, sum) in sums.iter_mut().enumerate() {
                    *sum = alone(lean, numbers, first + i, along);
                }
            } else {
                let places = [first - along, first, first + along, first + 2 * along];
                gather_across(places.map(|at| [&lean[at..], &numbers[at..]]), sums);
            }
        }
    }
}

/// What the pair of a single cell receives from it and from the cells below and above.
#[inline(always)]
fn alone(lean: &[f64], numbers: &[f64], cell: usize, along: usize) -> f64 {
    let own = (1.0 - lean[cell]) * numbers[cell];
    let next = |cell: usize| lean[cell] * numbers[cell];
    own + (next(cell - along) + next(cell + along))
}

/// What pairs along x receive; the slices begin one cell below the first pair.
#[inline(always)]
fn gather_along_x(lean: &[f64], numbers: &[f64], sums: &mut [f64]) {
    let cells = 2 * sums.len() + 2;
    let (lean, numbers) = (&lean[..cells], &numbers[..cells]);
    for (m, sum) in sums.iter_mut().enumerate() {
        let own = |cell: usize| (1.0 - lean[cell]) * numbers[cell];
        let next = |cell: usize| lean[cell] * numbers[cell];
        let below = 2 * m;
        *sum = (own(below + 1) + own(below + 2)) + (next(below) + next(below + 3));
    }
}

/// What pairs across x receive from four rows, each of weights and numbers: the one below, two own, the one above.
#[inline(always)]
fn gather_across(rows: [[&[f64]; 2]; 4], sums: &mut [f64]) {
    let length = sums.len();
    let [below, first, second, above] = rows.map(|row| row.map(|values| &values[..length]));
    for (i, sum) in sums.iter_mut().enumerate() {
        let own = |[lean, numbers]: [&[f64]; 2]| (1.0 - lean[i]) * numbers[i];
        let next = |[lean, numbers]: [&[f64]; 2]| lean[i] * numbers[i];
        *sum = (own(first) + own(second)) + (next(below) + next(above));
    }
}

struct Prolong<'a, const CORRECT: bool> {
    transfer: &'a Transfer,
    coarse: &'a Field,
    fine: &'a mut Field,
}

impl<const CORRECT: bool> VectorWork for Prolong<'_, CORRECT> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { transfer: Transfer { pairs, lean, .. }, coarse, fine } = self;
        let axis = pairs.axis;
        let ranges = pairs.prolonged(CORRECT);
        let length = ranges[0].len();
        let along = coarse.strides()[axis];
        for place in starts(ranges) {
            let number = pairs.number(place);
            let mut own = place;
            own[axis] = (number / 2) as isize - pairs.coarse.start[axis] as isize;
            let own = coarse.index(own);
            let numbers = coarse.values();
            let to = fine.index(place);
            let lean = &lean.values()[lean.index(place)..][..length];
            let values = &mut fine.values_mut()[to..][..length];
            if axis == 0 {
                spread_along_x::<CORRECT>(lean, &numbers[own - 1..], number, values);
            } else {
                let next = if number % 2 == 1 { own + along } else { own - along };
                let numbers = [&numbers[own..], &numbers[next..]];
                spread_across::<CORRECT>(lean, numbers, values);
            }
        }
    }
}

#[inline(always)]
fn put<const CORRECT: bool>(value: &mut f64, lean: f64, own: f64, next: f64) {
    let interpolated = (1.0 - lean) * own + lean * next;
    *value = if CORRECT { *value + interpolated } else { interpolated };
}

/// Cells along x from the one of this number; pairs begin with the one below that of the first cell.
#[inline(always)]
fn spread_along_x<const CORRECT: bool>(
    lean: &[f64],
    pairs: &[f64],
    number: usize,
    values: &mut [f64],
) {
    let odd = number % 2;
    let (single, doubles) = values.split_at_mut(odd.min(values.len()));
    for value in single {
        put::<CORRECT>(value, lean[0], pairs[1], pairs[2]);
    }
    let (lean, pairs) = (&lean[odd..], &pairs[odd..]);
    let half = doubles.len() / 2;
    let windows = &pairs[..half + 2];
    for (m, (two, lean)) in doubles.chunks_exact_mut(2).zip(lean.chunks_exact(2)).enumerate() {
        let [below, own, above] = [windows[m], windows[m + 1], windows[m + 2]];
        put::<CORRECT>(&mut two[0], lean[0], own, below);
        put::<CORRECT>(&mut two[1], lean[1], own, above);
    }
    if doubles.len() % 2 == 1 {
        let last = doubles.len() - 1;
        put::<CORRECT>(&mut doubles[last], lean[last], pairs[half + 1], pairs[half]);
    }
}

/// Cells of a row across x: numbers of their own pairs and of the next.
#[inline(always)]
fn spread_across<const CORRECT: bool>(lean: &[f64], numbers: [&[f64]; 2], values: &mut [f64]) {
    let [own, next] = numbers.map(|numbers| &numbers[..values.len()]);
    for (i, value) in values.iter_mut().enumerate() {
        put::<CORRECT>(value, lean[i], own[i], next[i]);
    }
}
