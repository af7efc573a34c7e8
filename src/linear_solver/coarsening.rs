//! Which cells are left on the coarser grids. Follows from the whole grid alone.

use crate::domain::{Decomposition, RankGrid, Subdomain};
use crate::grid::{BoxGrid, LocalCells};
use crate::parallel::FieldHalo;

/// Axes along which cells are at most this much wider than along the narrowest are coarsened with it: beyond, the
/// coupling along them, which goes with the inverse square, is below half of the strongest.
const EQUALLY_WIDE: f64 = 1.5;

/// Levels up to this many cells are held whole by every rank: messages would take longer than the work.
const HELD_WHOLE: usize = 1024;

/// Halos on levels that are cut are two cells wide.
const NARROWEST: usize = 2;

/// The whole grid of a level, and how it is cut.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LevelGrid {
    counts: [usize; 3],
    spacing: [f64; 3],
    periodic: [bool; 3],
    /// First cells of the blocks along each axis, and the number of cells.
    blocks: [Vec<usize>; 3],
}

impl LevelGrid {
    pub(super) fn finest(grid: &BoxGrid, decomposition: &Decomposition) -> Self {
        let counts = grid.counts();
        let blocks = [0, 1, 2].map(|axis| {
            decomposition
                .cut_planes(axis)
                .iter()
                .map(|&plane| grid.nearest_face(axis, plane))
                .collect()
        });
        let periodic = [0, 1, 2].map(|axis| grid.is_periodic(axis));
        Self { counts, spacing: grid.spacing().into(), periodic, blocks }
    }

    pub(super) fn cells(&self) -> usize {
        self.counts.iter().product()
    }

    pub(super) fn periodic(&self) -> [bool; 3] {
        self.periodic
    }

    /// Axes along which every other cell is left out next: those with the narrowest cells, and with more than one.
    pub(super) fn axes_to_coarsen(&self) -> Vec<usize> {
        let divisible = |axis: &usize| self.counts[*axis] > 1;
        let narrowest =
            (0..3).filter(divisible).map(|axis| self.spacing[axis]).fold(f64::INFINITY, f64::min);
        (0..3)
            .filter(divisible)
            .filter(|&axis| self.spacing[axis] <= EQUALLY_WIDE * narrowest)
            .collect()
    }

    /// The grid of the cells with even numbers along an axis. A cell belongs to the owner of the one it was.
    pub(super) fn coarsened(&self, axis: usize) -> Self {
        let mut coarse = self.clone();
        coarse.counts[axis] = self.counts[axis].div_ceil(2);
        coarse.spacing[axis] *= 2.0;
        coarse.blocks[axis].iter_mut().for_each(|first| *first = first.div_ceil(2));
        coarse
    }

    /// The same grid, held whole by everyone.
    pub(super) fn whole(&self) -> Self {
        let blocks = self.counts.map(|count| vec![0, count]);
        Self { blocks, ..self.clone() }
    }

    /// Whether every rank holds the whole level: it is small, or too narrow on some rank.
    pub(super) fn is_held_whole(&self) -> bool {
        let narrow = |blocks: &Vec<usize>| {
            blocks.len() > 2 && blocks.windows(2).any(|pair| pair[1] - pair[0] < NARROWEST)
        };
        self.cells() <= HELD_WHOLE || self.blocks.iter().any(narrow)
    }

    /// The cells that a rank holds: those of its subdomain, or all of a level that every rank holds whole.
    pub(super) fn local_cells(&self, subdomain: Subdomain) -> LocalCells {
        let block = subdomain.decomposition.grid().block_of(subdomain.rank);
        let block = [0, 1, 2].map(|axis| block[axis].min(self.blocks[axis].len() - 2));
        let start = [0, 1, 2].map(|axis| self.blocks[axis][block[axis]]);
        let count = [0, 1, 2].map(|axis| self.blocks[axis][block[axis] + 1] - start[axis]);
        LocalCells { counts: self.counts, start, count }
    }
}

/// The halo of fields that every rank holds whole: its only neighbour is itself, through periodic faces.
pub(super) fn undivided_halo(subdomain: Subdomain) -> FieldHalo {
    let undivided = Decomposition::even(RankGrid([1; 3]), subdomain.bounds);
    FieldHalo::new(undivided.subdomain(subdomain.bounds, 0))
}
