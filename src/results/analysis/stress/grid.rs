//! Cells through which a line passes.

use nalgebra::Vector3;

/// Equal cells of a box. Bins over height are cells with a count of 1 along x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellGrid {
    /// The lowest corner.
    pub origin: Vector3<f64>,
    /// Edge lengths of a cell.
    pub spacing: Vector3<f64>,
    /// Number of cells by axis.
    pub counts: [usize; 3],
    /// Whether the grid is periodic, by axis.
    pub periodic: [bool; 3],
}

/// A part of a line inside one cell, from `first` to `last` in units of the line's length from its start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece {
    /// Cell that contains the part; `None` outside the grid.
    pub(super) cell: Option<u64>,
    pub(super) first: f64,
    pub(super) last: f64,
}

/// Largest number of planes that a line passes along an axis: a larger number is a mistake.
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

    /// The cell of a point: x fastest, then y. `None` outside the grid.
    #[inline]
    pub fn cell_of(&self, point: &Vector3<f64>) -> Option<u64> {
        self.ruler().cell_of(point)
    }

    /// The grid in a form for finding the cells of many points.
    #[inline(always)]
    pub(super) fn ruler(&self) -> Ruler<'_> {
        // Along a periodic axis with one cell every point lies in this cell: its coordinate there is 0.
        let is_whole = |axis: usize| self.counts[axis] == 1 && self.periodic[axis];
        let per_length = |axis: usize| if is_whole(axis) { 0.0 } else { 1.0 / self.spacing[axis] };
        Ruler {
            grid: self,
            per_length: Vector3::new(per_length(0), per_length(1), per_length(2)),
            is_whole: [is_whole(0), is_whole(1), is_whole(2)],
        }
    }

    /// The cell of an index along each axis.
    #[inline(always)]
    fn cell_of_index(&self, index: [i64; 3]) -> Option<u64> {
        let mut cell = 0;
        for axis in (0..3).rev() {
            let count = self.counts[axis] as i64;
            let mut index = index[axis];
            if !(0..count).contains(&index) {
                if !self.periodic[axis] {
                    return None;
                }
                index = index.rem_euclid(count);
            }
            cell = cell * count + index;
        }
        Some(cell as u64)
    }

    /// Number of cells.
    pub(super) fn cells(&self) -> usize {
        self.counts.iter().product()
    }
}

/// A grid with the reciprocals of its spacing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ruler<'a> {
    grid: &'a CellGrid,
    per_length: Vector3<f64>,
    /// Whether every point lies in the one cell, by axis.
    is_whole: [bool; 3],
}

impl Ruler<'_> {
    /// The cell of a point. `None` outside the grid.
    #[inline(always)]
    pub(super) fn cell_of(&self, point: &Vector3<f64>) -> Option<u64> {
        let [x, y, z] = self.coordinates(point).into();
        if !(is_countable(x) && is_countable(y) && is_countable(z)) {
            return None;
        }
        self.grid.cell_of_index([below(x), below(y), below(z)])
    }

    /// A point in units of cells.
    #[inline(always)]
    fn coordinates(&self, point: &Vector3<f64>) -> Vector3<f64> {
        (point - self.grid.origin).component_mul(&self.per_length)
    }

    /// Divides a line into pieces by cells, in order, which replace the contents of `pieces`. The ends of the pieces
    /// meet exactly, from 0 to 1. There are no pieces if the line is undefined.
    #[inline(always)]
    pub(super) fn pieces(
        &self,
        start: &Vector3<f64>,
        line: &Vector3<f64>,
        pieces: &mut Vec<Piece>,
    ) {
        pieces.clear();
        let (from, along) = (self.coordinates(start), line.component_mul(&self.per_length));
        let to = from + along;
        if !(is_usable(from.x, to.x) && is_usable(from.y, to.y) && is_usable(from.z, to.z)) {
            return;
        }
        let ends = [0, 1, 2].map(|axis| {
            if self.is_whole[axis] { [0, 0] } else { ends_of(from[axis], to[axis], along[axis]) }
        });
        let [mut index, last] = [0, 1].map(|end| [ends[0][end], ends[1][end], ends[2][end]]);
        let mut crossings = Crossings::default();
        for axis in 0..3 {
            crossings.insert_planes(axis, [from[axis], along[axis]], [index[axis], last[axis]]);
        }
        let mut first = 0.0;
        for &Crossing { place, axis, step } in crossings.in_order() {
            if place > first {
                pieces.push(Piece { cell: self.grid.cell_of_index(index), first, last: place });
                first = place;
            }
            index[axis] += step;
        }
        if first < 1.0 {
            pieces.push(Piece { cell: self.grid.cell_of_index(index), first, last: 1.0 });
        }
    }
}

/// Indices of the cells in which a line begins and ends, along one axis: an end on a plane belongs to the cell that
/// contains the line.
#[inline(always)]
fn ends_of(from: f64, to: f64, along: f64) -> [i64; 2] {
    let first = if along < 0.0 { -below(-from) - 1 } else { below(from) };
    let last = if along > 0.0 { -below(-to) - 1 } else { below(to) };
    [first, last]
}

/// A point at which a line crosses a plane between cells.
#[derive(Clone, Copy, Debug, Default)]
struct Crossing {
    /// Position in units of the line's length from its start.
    place: f64,
    axis: usize,
    /// 1 or -1.
    step: i64,
}

/// Number of crossings with room in an array; a branch usually has no more.
const FEW: usize = 4;

/// Crossings, sorted by their positions.
#[derive(Default)]
struct Crossings {
    few: [Crossing; FEW],
    count: usize,
    /// All crossings, if there are more.
    many: Vec<Crossing>,
}

impl Crossings {
    /// Inserts the planes between two indices along an axis; the line extends from a coordinate `from` by `along`.
    #[inline(always)]
    fn insert_planes(&mut self, axis: usize, [from, along]: [f64; 2], [index, last]: [i64; 2]) {
        let (step, above) = if along < 0.0 { (-1, 0) } else { (1, 1) };
        for number in 0..(last - index) * step {
            let plane = (index + number * step + above) as f64;
            let place = ((plane - from) / along).clamp(0.0, 1.0);
            self.insert(Crossing { place, axis, step });
        }
    }

    #[inline(always)]
    fn insert(&mut self, crossing: Crossing) {
        if self.count == FEW {
            self.many.extend(self.few);
        }
        if self.count < FEW {
            let mut place = self.count;
            while place > 0 && self.few[place - 1].place > crossing.place {
                self.few[place] = self.few[place - 1];
                place -= 1;
            }
            self.few[place] = crossing;
        } else {
            self.many.push(crossing);
        }
        self.count += 1;
    }

    #[inline(always)]
    fn in_order(&mut self) -> &[Crossing] {
        if self.count <= FEW {
            return &self.few[..self.count];
        }
        self.many.sort_by(|a, b| a.place.total_cmp(&b.place));
        &self.many
    }
}

/// The largest integer that is not above x, within the range of integers.
#[inline(always)]
fn below(x: f64) -> i64 {
    let towards_zero = x as i64;
    towards_zero - i64::from(towards_zero as f64 > x)
}

/// Whether a coordinate lies in the range in which cells can be counted.
#[inline(always)]
fn is_countable(x: f64) -> bool {
    x.abs() < 1.0e15
}

/// Whether the planes between two coordinates can be counted.
#[inline(always)]
fn is_usable(from: f64, to: f64) -> bool {
    (to - from).abs() <= MOST_PLANES && is_countable(from)
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
            let mut pieces = Vec::new();
            GRID.ruler().pieces(&start, &line, &mut pieces);
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
        let start = Vector3::new(0.1, 0.1, 0.6);
        let number_of = |start: &Vector3<f64>, line: Vector3<f64>| {
            let mut pieces = Vec::new();
            GRID.ruler().pieces(start, &line, &mut pieces);
            pieces.len()
        };
        assert_eq!(number_of(&start, Vector3::new(f64::NAN, 0.0, 0.0)), 0);
        assert_eq!(number_of(&start, Vector3::new(0.0, 0.0, f64::INFINITY)), 0);
        let undefined = Vector3::new(0.0, f64::NAN, 0.0);
        assert_eq!(number_of(&undefined, Vector3::zeros()), 0);
        assert_eq!(GRID.cell_of(&undefined), None);
        assert_eq!(number_of(&start, Vector3::zeros()), 1); // the control
    }
}
