//! The cells around a point, and how much of it each takes.

use super::{BoxGrid, LocalCells};
use nalgebra::Vector3;

/// Finds the cells of a rank's part around points near it.
///
/// A point belongs to the cells whose centres lie around it, with the hat weight 1 - |x - x_c| / dx along each
/// axis. Where the box ends without repeating, the outer cell would lie beyond: its weight goes to the inner one,
/// so that weights add up to 1 everywhere.
#[derive(Clone, Debug, PartialEq)]
pub struct CellLocator {
    part: LocalCells,
    periodic: [bool; 3],
    spacing: Vector3<f64>,
}

/// The two cells around a point along each axis, counted from the part's first one, and the hat weight of the
/// upper; that of the lower is the rest to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellWeights {
    /// Cells below.
    pub lower: [isize; 3],
    /// Cells above; the same at the end of a box that does not repeat.
    pub upper: [isize; 3],
    /// Weights of the cells above.
    pub of_upper: [f64; 3],
}

impl CellLocator {
    /// Cells by which a point may lie beyond the part, so that those around it are in a halo of two.
    pub const STRAY: f64 = 1.5;

    /// For a rank's part of a grid.
    pub fn new(grid: &BoxGrid, part: LocalCells) -> Self {
        let spacing = grid.spacing();
        let periodic = std::array::from_fn(|axis| grid.is_periodic(axis));
        Self { part, periodic, spacing }
    }

    /// The cells around a point that lies less than [`CellLocator::STRAY`] cells beyond the part; in a periodic
    /// box it may be any image of it.
    ///
    /// `wrapped` is the point with its periodic coordinates in the box, so that all images have the same weights.
    #[inline(always)]
    pub fn weights(&self, wrapped: &Vector3<f64>) -> CellWeights {
        let mut weights = CellWeights { lower: [0; 3], upper: [0; 3], of_upper: [0.0; 3] };
        for axis in 0..3 {
            let centres = wrapped[axis] / self.spacing[axis] - 0.5;
            let below = centres.floor();
            let (start, all) = (self.part.start[axis] as isize, self.part.counts[axis] as isize);
            let mut lower = below as isize;
            let mut upper = lower + 1;
            if self.periodic[axis] {
                lower -= start;
                if lower > self.part.count[axis] as isize {
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

    /// The part.
    pub fn part(&self) -> &LocalCells {
        &self.part
    }
}

impl CellWeights {
    /// The eight cells and their weights: x fastest.
    #[inline(always)]
    pub fn corners(&self) -> [([isize; 3], f64); 8] {
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
        fn weights_add_up_and_give_the_place_back(
            x in 0.0..3.3f64, y in 0.0..0.7f64, z in -0.2..9.1f64, start in 0usize..5,
        ) {
            let grid = BoxGrid::new(&bounds(), COUNTS);
            let position = Vector3::new(x, y, z);
            // A part that the point lies in or near, along x.
            let cell = ((x / 0.55) as usize).min(5);
            let start = cell.saturating_sub(start);
            let part = LocalCells { counts: COUNTS, start: [start, 0, 0], count: [cell + 1 - start, 1, 9] };
            let weights = CellLocator::new(&grid, part).weights(&position);
            let mut sum = 0.0;
            let mut mean = Vector3::zeros();
            for (cell, weight) in weights.corners() {
                prop_assert!((0.0..=1.0).contains(&weight));
                for (cell, count) in cell.into_iter().zip(part.count) {
                    prop_assert!(cell >= -2 && cell <= count as isize + 1);
                }
                sum += weight;
                let centre = Vector3::from_fn(|axis, _| {
                    (cell[axis] as f64 + part.start[axis] as f64 + 0.5) * grid.spacing()[axis]
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
    fn at_a_wall_the_inner_cell_takes_all() {
        let grid = BoxGrid::new(&bounds(), COUNTS);
        let locator = CellLocator::new(&grid, LocalCells::whole(COUNTS));
        for (z, cell) in [(0.2, 0), (-0.7, 0), (8.9, 8), (9.8, 8)] {
            let weights = locator.weights(&Vector3::new(1.0, 0.3, z));
            assert_eq!((weights.lower[2], weights.upper[2]), (cell, cell), "at {z}");
        }
    }

    #[test]
    fn images_beyond_a_cut_are_near_the_part() {
        let grid = BoxGrid::new(&bounds(), COUNTS);
        let part = |start, count| LocalCells {
            counts: COUNTS,
            start: [start, 0, 0],
            count: [count, 1, 9],
        };
        let at =
            |part, x| CellLocator::new(&grid, part).weights(&Vector3::new(x, 0.3, 4.0)).lower[0];
        // x = 3.2 is in cell 5, its neighbour above is cell 0.
        assert_eq!(at(part(0, 3), 3.2), -1);
        assert_eq!(at(part(3, 3), 3.2), 2);
        assert_eq!(at(part(0, 6), 3.2), 5);
        // x = 0.1 is in cell 0: seen from the upper half, beyond its end.
        assert_eq!(at(part(3, 3), 0.1), 2);
        assert_eq!(at(part(3, 3), 0.5), 3);
    }
}
