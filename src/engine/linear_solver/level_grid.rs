//! The grid of a level. The cells that a coarser grid keeps follow from the whole grid alone, so that the solution does
//! not depend on the decomposition.

use crate::domain::{Decomposition, RankGrid, Subdomain};
use crate::grid::{BoxGrid, LocalCells};
use crate::parallel::FieldHalo;

/// Largest ratio of the width of cells along an axis to that along the narrowest axis for which the axis is coarsened.
/// The coupling varies as the inverse square of the width: along wider cells it is below half of the strongest.
const LARGEST_ASPECT: f64 = 1.5;

/// Largest number of cells of a level that every rank holds completely: messages would take longer than the work.
const LARGEST_REPLICATED: usize = 1024;

/// Smallest width of a rank's part along an axis: halos of distributed levels are two cells wide.
const NARROWEST: usize = 2;

/// The whole grid of a level, with the owner of each cell.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LevelGrid {
    counts: [usize; 3],
    spacing: [f64; 3],
    periodic: [bool; 3],
    /// Order of the cells in memory: see [`LocalCells::order`].
    order: [usize; 3],
    /// Whether every rank holds all cells regardless of their number.
    replicated: bool,
    /// First cells of the subdomains along each axis, and the number of cells.
    starts: [Vec<usize>; 3],
}

impl LevelGrid {
    pub(super) fn finest(grid: &BoxGrid, decomposition: &Decomposition) -> Self {
        let counts = grid.counts();
        let starts = [0, 1, 2].map(|axis| {
            decomposition
                .cut_planes(axis)
                .iter()
                .map(|&plane| grid.nearest_face(axis, plane))
                .collect()
        });
        let periodic = [0, 1, 2].map(|axis| grid.is_periodic(axis));
        let (spacing, order) = (grid.spacing().into(), grid.memory_order(decomposition));
        Self { counts, spacing, periodic, order, replicated: false, starts }
    }

    pub(super) fn cells(&self) -> usize {
        self.counts.iter().product()
    }

    pub(super) fn periodic(&self) -> [bool; 3] {
        self.periodic
    }

    /// Axes along which the next level keeps every other cell: those with the narrowest cells, and with more than one.
    pub(super) fn axes_to_coarsen(&self) -> Vec<usize> {
        let divisible = |axis: &usize| self.counts[*axis] > 1;
        let narrowest =
            (0..3).filter(divisible).map(|axis| self.spacing[axis]).fold(f64::INFINITY, f64::min);
        (0..3)
            .filter(divisible)
            .filter(|&axis| self.spacing[axis] <= LARGEST_ASPECT * narrowest)
            .collect()
    }

    /// The grid of the cells with even indices along an axis. Each keeps its owner.
    pub(super) fn coarsened(&self, axis: usize) -> Self {
        let mut coarse = self.clone();
        coarse.counts[axis] = self.counts[axis].div_ceil(2);
        coarse.spacing[axis] *= 2.0;
        coarse.starts[axis].iter_mut().for_each(|first| *first = first.div_ceil(2));
        coarse
    }

    /// This grid, with all cells on every rank.
    pub(super) fn replicated(&self) -> Self {
        let starts = self.counts.map(|count| vec![0, count]);
        Self { starts, replicated: true, ..self.clone() }
    }

    /// Whether every rank holds the whole level: it is small, too narrow on some rank, or coarser than a level for
    /// which this holds.
    pub(super) fn is_replicated(&self) -> bool {
        let narrow = |starts: &Vec<usize>| {
            starts.len() > 2 && starts.windows(2).any(|pair| pair[1] - pair[0] < NARROWEST)
        };
        self.replicated || self.cells() <= LARGEST_REPLICATED || self.starts.iter().any(narrow)
    }

    /// The cells that a rank holds: those of its subdomain, or all cells of a replicated level.
    pub(super) fn local_cells(&self, subdomain: Subdomain) -> LocalCells {
        let coordinates = subdomain.decomposition.grid().coordinates_of(subdomain.rank);
        // On a replicated level there is one entry along each axis.
        let at = [0, 1, 2].map(|axis| coordinates[axis].min(self.starts[axis].len() - 2));
        let start = [0, 1, 2].map(|axis| self.starts[axis][at[axis]]);
        let count = [0, 1, 2].map(|axis| self.starts[axis][at[axis] + 1] - start[axis]);
        LocalCells { counts: self.counts, start, count, order: self.order }
    }
}

/// The halo of fields on a replicated level, where a rank is its own neighbour through periodic faces.
pub(super) fn replicated_halo(subdomain: Subdomain) -> FieldHalo {
    let undivided = Decomposition::even(RankGrid([1; 3]), subdomain.bounds);
    FieldHalo::new(undivided.subdomain(subdomain.bounds, 0))
}
