//! Cells that a line passes.

use nalgebra::Vector3;

/// Equal cells of a box. Bins of height are cells with a count of 1 along x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellGrid {
    /// The lowest corner.
    pub origin: Vector3<f64>,
    /// Edge lengths of a cell.
    pub spacing: Vector3<f64>,
    /// Number of cells by axis.
    pub counts: [usize; 3],
    /// Along which axes the grid repeats.
    pub periodic: [bool; 3],
}

/// A part of a line inside of one cell, from `first` to `last` in units of the line's length from its start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece {
    /// None outside of the grid.
    pub(super) cell: Option<u64>,
    pub(super) first: f64,
    pub(super) last: f64,
}

/// A line that passes more planes than this along an axis is a mistake.
const MOST_PLANES: f64 = 1.0e6;

impl CellGrid {
    /// Volume of a cell.
    pub fn cell_volume(&self) -> f64 {
        self.spacing.x * self.spacing.y * self.spacing.z
    }

    /// Centre of a cell.
    pub fn centre_of(&self, cell: u64) -> Vector3<f64> {
        let [nx, ny, _] = self.counts.map(|count| count as u64);
        let index = [cell % nx, cell / nx % ny, cell / (nx * ny)];
        Vector3::from_fn(|axis, _| {
            self.origin[axis] + (index[axis] as f64 + 0.5) * self.spacing[axis]
        })
    }

    /// The cell of a point: x fastest, then y. None outside of the grid.
    pub fn cell_of(&self, point: &Vector3<f64>) -> Option<u64> {
        self.cell_at(&self.coordinates(point))
    }

    /// A point in units of cells.
    fn coordinates(&self, point: &Vector3<f64>) -> Vector3<f64> {
        (point - self.origin).component_div(&self.spacing)
    }

    fn cell_at(&self, coordinates: &Vector3<f64>) -> Option<u64> {
        let mut cell = 0;
        for axis in (0..3).rev() {
            let count = self.counts[axis] as f64;
            let mut index = coordinates[axis].floor();
            if self.periodic[axis] {
                index = index.rem_euclid(count);
            }
            if !(0.0..count).contains(&index) {
                return None;
            }
            cell = cell * self.counts[axis] as u64 + index as u64;
        }
        Some(cell)
    }

    /// Where a line lies, in order. The pieces' ends meet exactly, from 0 to 1. None if the line is undefined.
    pub(super) fn pieces(&self, start: &Vector3<f64>, line: &Vector3<f64>) -> Option<Vec<Piece>> {
        let (from, along) = (self.coordinates(start), line.component_div(&self.spacing));
        let mut ends = vec![0.0, 1.0];
        for axis in 0..3 {
            let (low, high) = {
                let (a, b) = (from[axis], from[axis] + along[axis]);
                (a.min(b), a.max(b))
            };
            let usable = low.is_finite() && along[axis].is_finite() && low.abs() < 1.0e15;
            if !usable || high - low > MOST_PLANES {
                return None;
            }
            let mut plane = low.floor() + 1.0;
            while plane < high {
                ends.push(((plane - from[axis]) / along[axis]).clamp(0.0, 1.0));
                plane += 1.0;
            }
        }
        ends.sort_by(f64::total_cmp);
        let piece = |pair: &[f64]| {
            let [first, last] = [pair[0], pair[1]];
            let middle = from + 0.5 * (first + last) * along;
            Piece { cell: self.cell_at(&middle), first, last }
        };
        Some(ends.windows(2).map(piece).filter(|piece| piece.last > piece.first).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const GRID: CellGrid = CellGrid {
        origin: Vector3::new(-1.0, 0.0, 0.5),
        spacing: Vector3::new(0.5, 1.0, 0.25),
        counts: [4, 3, 10],
        periodic: [true, false, false],
    };

    proptest! {
        #[test]
        fn pieces_cover_a_line_once(
            start in prop::array::uniform3(-3.0..3.0f64),
            line in prop::array::uniform3(-2.0..2.0f64),
        ) {
            let (start, line) = (Vector3::from(start), Vector3::from(line));
            let pieces = GRID.pieces(&start, &line).unwrap();
            prop_assert_eq!(pieces[0].first, 0.0);
            prop_assert_eq!(pieces[pieces.len() - 1].last, 1.0);
            for pair in pieces.windows(2) {
                prop_assert_eq!(pair[0].last, pair[1].first);
            }
            for piece in pieces {
                let inside = piece.first + 0.37 * (piece.last - piece.first);
                prop_assert_eq!(GRID.cell_of(&(start + inside * line)), piece.cell);
            }
        }
    }

    #[test]
    fn cells_are_numbered_along_x_first() {
        assert_eq!(GRID.cell_of(&Vector3::new(-0.9, 0.1, 0.6)), Some(0));
        assert_eq!(GRID.cell_of(&Vector3::new(1.1, 0.1, 0.6)), Some(0)); // periodic
        assert_eq!(GRID.cell_of(&Vector3::new(-0.4, 1.1, 0.8)), Some(1 + 4 + 12));
        assert_eq!(GRID.cell_of(&Vector3::new(0.0, -0.1, 0.6)), None);
        for cell in 0..120 {
            assert_eq!(GRID.cell_of(&GRID.centre_of(cell)), Some(cell));
        }
    }

    #[test]
    fn undefined_lines_have_no_pieces() {
        let start = Vector3::zeros();
        assert_eq!(GRID.pieces(&start, &Vector3::new(f64::NAN, 0.0, 0.0)), None);
        assert_eq!(GRID.pieces(&start, &Vector3::new(0.0, 0.0, f64::INFINITY)), None);
    }
}
