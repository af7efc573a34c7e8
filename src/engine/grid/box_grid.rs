//! The cells of the box, and those owned by a rank.

use crate::domain::{Bounds, Decomposition, Subdomain};
use nalgebra::Vector3;

/// Equal cells that fill the box. Cell (i, j, k) extends from i dx to (i + 1) dx along x, and so on.
#[derive(Clone, Debug, PartialEq)]
pub struct BoxGrid {
    counts: [usize; 3],
    spacing: Vector3<f64>,
    periodic: [bool; 3],
}

/// The block of cells that one rank owns, within the whole grid.
///
/// Local indices count from its first cell; a global index is a local one plus `start`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LocalCells {
    /// Cells of the whole grid along x, y, z.
    pub counts: [usize; 3],
    /// First owned cell along each axis.
    pub start: [usize; 3],
    /// Number of owned cells along each axis.
    pub count: [usize; 3],
    /// Order of the cells in memory: those of a row are neighbours along the first of these axes, the rows of a layer
    /// along the second, the layers along the third. It changes no result.
    pub order: [usize; 3],
}

impl BoxGrid {
    /// A grid with `counts` cells along x, y and z.
    pub fn new(bounds: &Bounds, counts: [usize; 3]) -> Self {
        let spacing = Vector3::from_fn(|axis, _| bounds.lengths()[axis] / counts[axis] as f64);
        let periodic = std::array::from_fn(|axis| bounds.is_periodic(axis));
        Self { counts, spacing, periodic }
    }

    /// This grid with each cell divided into `factor` cells along each axis.
    pub fn refined(&self, factor: usize) -> Self {
        Self {
            counts: self.counts.map(|count| count * factor),
            spacing: self.spacing / factor as f64,
            periodic: self.periodic,
        }
    }

    /// Cells along x, y and z.
    pub fn counts(&self) -> [usize; 3] {
        self.counts
    }

    /// Edge lengths of a cell: dx, dy, dz.
    pub fn spacing(&self) -> Vector3<f64> {
        self.spacing
    }

    /// Whether the last cell along an axis has the first as its neighbour.
    pub fn is_periodic(&self, axis: usize) -> bool {
        self.periodic[axis]
    }

    /// Volume of a cell.
    pub fn cell_volume(&self) -> f64 {
        self.spacing.x * self.spacing.y * self.spacing.z
    }

    /// The cell face nearest to a plane at `coordinate`: face i is the lower face of cell i.
    pub fn nearest_face(&self, axis: usize, coordinate: f64) -> usize {
        ((coordinate / self.spacing[axis]).round() as usize).min(self.counts[axis])
    }

    /// The decomposition with every cut plane moved to a cell face. Along the divided axes each rank owns at least
    /// `least` cells, which is given for each axis.
    ///
    /// Returns `None` if the grid has too few cells for that.
    pub fn aligned(
        &self,
        decomposition: &Decomposition,
        least: [usize; 3],
    ) -> Option<Decomposition> {
        let mut cut_planes: [Vec<f64>; 3] = Default::default();
        for (axis, planes) in cut_planes.iter_mut().enumerate() {
            let (ranks, cells, least) =
                (decomposition.grid().0[axis], self.counts[axis], least[axis]);
            if ranks > 1 && ranks * least > cells {
                return None;
            }
            let mut face = 0;
            for (plane, &wanted) in decomposition.cut_planes(axis).iter().enumerate() {
                face = match plane {
                    0 => 0,
                    last if last == ranks => cells,
                    _ => {
                        let highest = cells - least * (ranks - plane);
                        self.nearest_face(axis, wanted).clamp(face + least, highest)
                    }
                };
                let ends = plane == 0 || plane == ranks;
                planes.push(if ends { wanted } else { face as f64 * self.spacing[axis] });
            }
        }
        Some(decomposition.with_cut_planes(cut_planes))
    }

    /// The cells of a subdomain, whose faces lie on cell faces.
    pub fn local_cells(&self, subdomain: Subdomain) -> LocalCells {
        let Subdomain { decomposition, rank, .. } = subdomain;
        let coordinates = decomposition.grid().coordinates_of(rank);
        let face = |axis: usize, plane: usize| {
            self.nearest_face(axis, decomposition.cut_planes(axis)[plane])
        };
        let start = std::array::from_fn(|axis| face(axis, coordinates[axis]));
        let count = std::array::from_fn(|axis| face(axis, coordinates[axis] + 1) - start[axis]);
        LocalCells { counts: self.counts, start, count, order: self.memory_order(decomposition) }
    }

    /// Order of the cells in memory, equal on all ranks: see [`LocalCells::order`].
    pub fn memory_order(&self, decomposition: &Decomposition) -> [usize; 3] {
        let ranks = decomposition.grid().0;
        order_of([0, 1, 2].map(|axis| self.counts[axis] / ranks[axis]))
    }
}

/// The orders of [`LocalCells::order`] with rows along x, y and z.
pub(crate) const MEMORY_ORDERS: [[usize; 3]; 3] = [[0, 1, 2], [1, 0, 2], [2, 0, 1]];

/// Length from which rows are long. The overhead of a row equals the work on some ten cells: a step of the gas on
/// 32,000 cells took 1.6, 1.05, 0.79 and 0.75 us per cell with rows of 8, 16, 32 and 64 (AMD EPYC with AVX2).
const LONG_ROW: usize = 32;

/// Rows lie along the first axis along which they are long, or else along the longest axis. With layers across z, a bed
/// below a large volume of gas takes one short range of memory.
fn order_of(counts: [usize; 3]) -> [usize; 3] {
    let long = counts.iter().position(|&count| count >= LONG_ROW);
    let longest = || (0..3).rev().max_by_key(|&axis| counts[axis]);
    MEMORY_ORDERS[long.or_else(longest).unwrap_or(0)]
}

impl LocalCells {
    /// All cells of a grid, owned by one rank.
    pub fn whole(counts: [usize; 3]) -> Self {
        Self { counts, start: [0; 3], count: counts, order: order_of(counts) }
    }

    /// One past the last owned cell.
    pub fn end(&self, axis: usize) -> usize {
        self.start[axis] + self.count[axis]
    }

    /// Number of owned cells.
    pub fn cells(&self) -> usize {
        self.count.iter().product()
    }

    /// Number of a cell, counted from the first owned one, in the whole grid: x fastest, then y, then z.
    pub fn number_of(&self, cell: [isize; 3]) -> u64 {
        let [i, j, k] = [0, 1, 2].map(|axis| self.start[axis] + cell[axis] as usize);
        (i + self.counts[0] * (j + self.counts[1] * k)) as u64
    }

    /// The owned cells, counted from the first one; x fastest, then y, then z.
    pub fn owned(&self) -> impl Iterator<Item = [isize; 3]> + use<> {
        let [nx, ny, nz] = self.count.map(|count| count as isize);
        (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])))
    }

    /// Whether the owned cells extend to the lower and to the upper end of the grid.
    pub fn at_ends(&self, axis: usize) -> [bool; 2] {
        [self.start[axis] == 0, self.end(axis) == self.counts[axis]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::{Face, RankGrid};
    use proptest::prelude::*;

    fn bounds() -> Bounds {
        let periodic = [Face::Periodic; 2];
        Bounds::new(Vector3::new(2.1, 3.0, 10.3), [periodic, periodic, [Face::Wall, Face::Open]])
    }

    proptest! {
        #[test]
        fn every_cell_has_one_owner_and_every_rank_enough_cells(
            ranks in 1usize..5, cells in 9usize..40, planes in prop::collection::vec(0.0..10.3f64, 4),
        ) {
            let grid = BoxGrid::new(&bounds(), [3, 4, cells]);
            let even = Decomposition::even(RankGrid::slabs(2, ranks), &bounds());
            let mut wanted = vec![0.0];
            wanted.extend_from_slice(&planes[..ranks - 1]);
            wanted.push(bounds().lengths().z);
            wanted.sort_by(f64::total_cmp);
            let decomposition = even.with_cut_planes([even.cut_planes(0).to_vec(), even.cut_planes(1).to_vec(), wanted]);
            let decomposition = grid.aligned(&decomposition, [2; 3]).expect("there are enough cells");
            let (bounds, mut next) = (bounds(), 0);
            for rank in 0..ranks {
                let local = grid.local_cells(decomposition.subdomain(&bounds, rank));
                prop_assert_eq!(local.start, [0, 0, next]);
                prop_assert!(local.count[2] >= 2);
                next = local.end(2);
            }
            prop_assert_eq!(next, cells);
        }
    }

    #[test]
    fn rows_lie_along_x_unless_they_would_be_short_on_a_rank() {
        let order = |counts, ranks| {
            let decomposition = Decomposition::even(RankGrid(ranks), &bounds());
            BoxGrid::new(&bounds(), counts).memory_order(&decomposition)
        };
        assert_eq!(order([32, 64, 80], [1; 3]), [0, 1, 2]);
        assert_eq!(order([32, 64, 80], [2, 1, 1]), [1, 0, 2]);
        assert_eq!(order([32, 64, 80], [2, 4, 2]), [2, 0, 1]);
        assert_eq!(order([16, 16, 16], [1; 3]), [0, 1, 2]);
        assert_eq!(order([3, 12, 10], [1; 3]), [1, 0, 2]);
    }

    #[test]
    fn a_grid_with_too_few_cells_for_the_ranks_is_refused() {
        let grid = BoxGrid::new(&bounds(), [3, 4, 5]);
        let decomposition = Decomposition::even(RankGrid::slabs(2, 3), &bounds());
        assert_eq!(grid.aligned(&decomposition, [2; 3]), None);
    }

    #[test]
    fn the_least_number_of_cells_counts_along_divided_axes_only() {
        let grid = BoxGrid::new(&bounds(), [3, 4, 9]);
        let even = Decomposition::even(RankGrid([1, 2, 3]), &bounds());
        assert!(grid.aligned(&even, [9, 2, 3]).is_some());
        assert_eq!(grid.aligned(&even, [1, 3, 3]), None, "two blocks of three cells among four");
        assert_eq!(grid.aligned(&even, [1, 2, 4]), None, "three blocks of four cells among nine");
    }
}
