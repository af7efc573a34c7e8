//! The eight cells around a point and their weights in (tri)linear interpolation.

use super::{BoxGrid, LocalCells};
use nalgebra::Vector3;

/// Finds the cells of a rank around points in its subdomain or near it.
///
/// The cells are those whose centres surround the point. Along each axis their weight is 1 - |x - x_c| / dx. At a face
/// of the box that is not periodic the outer cell would lie outside: its weight is given to the inner one, so that the
/// weights add up to 1 everywhere.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CellLocator {
    cells: LocalCells,
    periodic: [bool; 3],
    spacing: Vector3<f64>,
}

/// The two cells around a point along each axis, by local indices, and the weight of the upper one; that of the lower
/// one is 1 minus it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CellWeights {
    /// Local indices of the cells below.
    pub(crate) lower: [isize; 3],
    /// Local indices of the cells above; equal to those below at a face of the box that is not periodic.
    pub(crate) upper: [isize; 3],
    /// Weights of the cells above.
    pub(crate) of_upper: [f64; 3],
}

impl CellLocator {
    /// Largest distance of a point from the subdomain, in cells, for which the cells around it are within a halo of two
    /// cells.
    pub(crate) const MARGIN: f64 = 1.5;

    /// A locator for the cells of a rank.
    pub(crate) fn new(grid: &BoxGrid, cells: LocalCells) -> Self {
        let spacing = grid.spacing();
        let periodic = std::array::from_fn(|axis| grid.is_periodic(axis));
        Self { cells, periodic, spacing }
    }

    /// The cells around a point, or around that one of its images, which is less than [`CellLocator::MARGIN`] cells
    /// outside the subdomain.
    ///
    /// `wrapped` is the point with its periodic coordinates in the box, so that all images have the same weights.
    #[inline(always)]
    pub(crate) fn weights(&self, wrapped: &Vector3<f64>) -> CellWeights {
        let mut weights = CellWeights { lower: [0; 3], upper: [0; 3], of_upper: [0.0; 3] };
        for axis in 0..3 {
            let centres = wrapped[axis] / self.spacing[axis] - 0.5;
            let below = centres.floor();
            let (start, all) = (self.cells.start[axis] as isize, self.cells.counts[axis] as isize);
            let mut lower = below as isize;
            let mut upper = lower + 1;
            if self.periodic[axis] {
                lower -= start;
                if lower > self.cells.count[axis] as isize {
                    lower -= all;
                } else if lower < -2 {
                    lower += all;
                }
                upper = lower + 1;
            } else {
                lower = lower.clamp(0, all - 1) - start;
                upper = upper.clamp(0, all - 1) - start;
            }
            weights.lower[axis] = lower;
            weights.upper[axis] = upper;
            weights.of_upper[axis] = centres - below;
        }
        weights
    }

    /// The cells of this rank.
    pub(crate) fn cells(&self) -> &LocalCells {
        &self.cells
    }
}

impl CellWeights {
    /// The eight cells and their weights, x fastest.
    #[inline(always)]
    pub(crate) fn corners(&self) -> [([isize; 3], f64); 8] {
        std::array::from_fn(|corner| {
            let mut cell = [0; 3];
            let mut weight = 1.0;
            for (axis, cell) in cell.iter_mut().enumerate() {
                let above = corner >> axis & 1 == 1;
                *cell = if above { self.upper[axis] } else { self.lower[axis] };
                let of_upper = self.of_upper[axis];
                weight *= if above { of_upper } else { 1.0 - of_upper };
            }
            (cell, weight)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::{Bounds, Face};
    use proptest::prelude::*;

    const COUNTS: [usize; 3] = [6, 1, 9];

    fn bounds() -> Bounds {
        let periodic = [Face::Periodic; 2];
        Bounds::new(Vector3::new(3.3, 0.7, 9.0), [periodic, periodic, [Face::Wall, Face::Open]])
    }

    proptest! {
        #[test]
        fn weights_add_up_to_one_and_interpolate_the_position(
            x in 0.0..3.3f64, y in 0.0..0.7f64, z in -0.2..9.1f64, start in 0usize..5,
        ) {
            let grid = BoxGrid::new(&bounds(), COUNTS);
            let position = Vector3::new(x, y, z);
            // Local cells in or near which the point lies, along x.
            let cell = ((x / 0.55) as usize).min(5);
            let start = cell.saturating_sub(start);
            let local = LocalCells { counts: COUNTS, start: [start, 0, 0], count: [cell + 1 - start, 1, 9], order: [0, 1, 2] };
            let weights = CellLocator::new(&grid, local).weights(&position);
            let mut sum = 0.0;
            let mut mean = Vector3::zeros();
            for (cell, weight) in weights.corners() {
                prop_assert!((0.0..=1.0).contains(&weight));
                for (cell, count) in cell.into_iter().zip(local.count) {
                    prop_assert!(cell >= -2 && cell <= count as isize + 1);
                }
                sum += weight;
                let centre = Vector3::from_fn(|axis, _| {
                    (cell[axis] as f64 + local.start[axis] as f64 + 0.5) * grid.spacing()[axis]
                });
                mean += weight * centre;
            }
            // Eight products of three factors: a few roundings of numbers up to 9.
            prop_assert!((sum - 1.0).abs() < 1.0e-15);
            let image = |distance: f64, length: f64| (distance - length * (distance / length).round()).abs();
            prop_assert!(image(mean.x - x, 3.3) < 1.0e-14);
            if (0.5..8.5).contains(&z) {
                prop_assert!((mean.z - z).abs() < 1.0e-14);
            }
        }
    }

    #[test]
    fn at_a_wall_the_inner_cell_has_all_the_weight() {
        let grid = BoxGrid::new(&bounds(), COUNTS);
        let locator = CellLocator::new(&grid, LocalCells::whole(COUNTS));
        for (z, cell) in [(0.2, 0), (-0.7, 0), (8.9, 8), (9.8, 8)] {
            let weights = locator.weights(&Vector3::new(1.0, 0.3, z));
            assert_eq!((weights.lower[2], weights.upper[2]), (cell, cell), "at {z}");
        }
    }

    #[test]
    fn the_image_nearest_to_the_subdomain_is_found() {
        let grid = BoxGrid::new(&bounds(), COUNTS);
        let local = |start, count| LocalCells {
            counts: COUNTS,
            start: [start, 0, 0],
            count: [count, 1, 9],
            order: [0, 1, 2],
        };
        let at =
            |local, x| CellLocator::new(&grid, local).weights(&Vector3::new(x, 0.3, 4.0)).lower[0];
        // x = 3.2 is in cell 5, its neighbour above is cell 0.
        assert_eq!(at(local(0, 3), 3.2), -1);
        assert_eq!(at(local(3, 3), 3.2), 2);
        assert_eq!(at(local(0, 6), 3.2), 5);
        // x = 0.1 is in cell 0: from the upper half, this is beyond its end.
        assert_eq!(at(local(3, 3), 0.1), 2);
        assert_eq!(at(local(3, 3), 0.5), 3);
    }
}
