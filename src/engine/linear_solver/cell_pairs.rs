//! Pairs of cells of a grid along one axis, which form the cells of the next coarser grid.

use super::rows::{Rows, row_starts};
use crate::grid::LocalCells;
use std::ops::Range;

/// The cells 2m and 2m + 1 along an axis form a pair, which is the coarse cell m. It belongs to the owner of the first.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellPairs {
    pub(super) axis: usize,
    pub(super) fine: LocalCells,
    pub(super) coarse: LocalCells,
    pub(super) periodic: bool,
}

/// The positions of a row's cells in their pairs: first or second.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowPlaces {
    /// Index of the row's first cell along the axis of the pairs, in the whole grid.
    first: usize,
    along_rows: bool,
}

impl RowPlaces {
    /// Whether the i-th cell is the second of its pair.
    #[inline(always)]
    pub(super) fn is_second(self, i: usize) -> bool {
        let index = if self.along_rows { self.first + i } else { self.first };
        index % 2 == 1
    }
}

/// A row of pairs.
pub(super) enum PairRow {
    /// The pairs follow each other along their axis; the last may be a single cell.
    Along { last_is_single: bool },
    /// They lie side by side.
    Across,
    /// They lie side by side, and each is a single cell.
    Single,
}

impl CellPairs {
    /// Whether the pairs lie along the rows of cells.
    fn along_rows(&self) -> bool {
        self.axis == self.fine.order[0]
    }

    /// The places in their pairs of the cells of a row that begins with this cell.
    pub(super) fn row_places(&self, first: [isize; 3]) -> RowPlaces {
        RowPlaces { first: self.global_index(first), along_rows: self.along_rows() }
    }

    /// The first cells of the rows of owned fine cells, in the order of `Field::rows`.
    pub(super) fn fine_rows(&self) -> Rows<isize, 3> {
        row_starts(self.fine.count.map(|count| 0..count as isize), self.fine.order)
    }

    /// The first cells of the rows of owned pairs, in the order of `Field::rows`.
    pub(super) fn coarse_rows(&self) -> Rows<isize, 3> {
        row_starts(self.coarse.count.map(|count| 0..count as isize), self.coarse.order)
    }

    /// The index of a fine cell along the axis, in the whole grid.
    pub(super) fn global_index(&self, cell: [isize; 3]) -> usize {
        (self.fine.start[self.axis] as isize + cell[self.axis]) as usize
    }

    /// The first fine cell of a pair.
    pub(super) fn first_of(&self, pair: [isize; 3]) -> [isize; 3] {
        let global = 2 * (self.coarse.start[self.axis] as isize + pair[self.axis]);
        let mut cell = pair;
        cell[self.axis] = global - self.fine.start[self.axis] as isize;
        cell
    }

    /// The orientation, relative to the axis, of a row of `length` pairs that begins with this pair.
    pub(super) fn row(&self, first: [isize; 3], length: usize) -> PairRow {
        let first = self.coarse.start[self.axis] as isize + first[self.axis];
        if self.along_rows() {
            let last_is_single = self.is_single_before_wrap(first + length as isize - 1);
            return PairRow::Along { last_is_single };
        }
        if self.is_single_before_wrap(first) { PairRow::Single } else { PairRow::Across }
    }

    /// Whether the pair with a global index is a single cell at the end of a periodic axis.
    fn is_single_before_wrap(&self, pair: isize) -> bool {
        let (cells, pairs) = (self.fine.counts[self.axis], self.coarse.counts[self.axis]);
        self.periodic && cells % 2 == 1 && pair + 1 == pairs as isize
    }

    /// Pairs to which values are restricted: owned ones, and those in the halo across the axes before this one, along
    /// which restriction continues.
    pub(super) fn restricted(&self) -> [Range<isize>; 3] {
        [0, 1, 2].map(|axis| {
            let count = self.coarse.count[axis] as isize;
            if axis < self.axis { -2..count + 2 } else { 0..count }
        })
    }

    /// Cells to which values are prolonged: owned ones, and one layer of the halo across the axes after this one unless
    /// this is the last step.
    pub(super) fn prolonged(&self, last: bool) -> [Range<isize>; 3] {
        [0, 1, 2].map(|axis| {
            let count = self.fine.count[axis] as isize;
            if axis > self.axis && !last { -1..count + 1 } else { 0..count }
        })
    }
}
