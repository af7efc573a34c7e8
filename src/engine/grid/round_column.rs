//! A round column on the cells of a box: which cells are open, and how much of the column each of them represents.

use super::{BoxGrid, CellLocator, Field, LocalCells};
use nalgebra::Vector3;
use std::f64::consts::PI;

/// A vertical cylinder in a box, with the gas and the particles inside.
///
/// A cell is open if its centre lies in the column. Material in the column is assigned to open cells only: a point has
/// the weights of trilinear interpolation in the open cells around it, divided by their sum. The same holds for volume:
/// the open fraction of a cell is
///
/// ```math
/// \theta_c = \frac{1}{\Delta x\, \Delta y} \int_\text{column} \frac{w_c}{\sum_\text{open} w}\, dA ,
/// ```
///
/// which is 1 away from the wall. At the wall it lies between some 0.4 and 1.6, wherever the wall cuts the cells: an
/// open cell takes over the parts of the column in closed neighbours, so that no cell is small. The sum over all cells
/// is pi R^2 / (dx dy), and a bed of uniform packing has the same voidage in all cells.
///
/// A point in the thin segments of the column around which no cell may be open, farther from the axis than
/// (R^2 - (dx^2 + dy^2) / 4)^1/2, is treated as if it lay on that circle.
#[derive(Clone, Debug, PartialEq)]
pub struct RoundColumn {
    centre: [f64; 2],
    radius: f64,
    counts: [usize; 2],
    spacing: [f64; 2],
    /// Open fractions of the cells across the column, x fastest; 0 if closed.
    open_fractions: Vec<f64>,
}

/// Smallest number of cells across a column: with fewer, the wall would act on both sides of a face.
const LEAST_CELLS: f64 = 4.0;
/// Largest distance of the wall beyond a face of the box, as a fraction of the radius: both are rounded.
const SLACK: f64 = 1.0e-9;
/// Number of strips across a square that the wall cuts, and of points along each strip: errors of open fractions are
/// about 1e-4 before their sum is made exact.
const STRIPS: usize = 48;

impl RoundColumn {
    /// A column with this axis and radius, within the box.
    ///
    /// # Errors
    /// With a message, if the column reaches out of the box, the box is periodic across it, or its cells are too few.
    pub fn new(grid: &BoxGrid, centre: [f64; 2], radius: f64) -> Result<Self, String> {
        let [dx, dy, dz] = grid.spacing().into();
        let [nx, ny, _] = grid.counts();
        let lengths = [dx * nx as f64, dy * ny as f64];
        for axis in 0..2 {
            let room = centre[axis].min(lengths[axis] - centre[axis]);
            if room < radius * (1.0 - SLACK) || grid.is_periodic(axis) {
                return Err(format!(
                    "the round column reaches beyond the box along {}: the gas in it needs a radius of at most {room}",
                    ["x", "y"][axis]
                ));
            }
        }
        if 2.0 * radius < LEAST_CELLS * dx.max(dy) {
            return Err(format!(
                "the round column is {:.2} cells wide: the gas in it needs at least {LEAST_CELLS}",
                2.0 * radius / dx.max(dy)
            ));
        }
        let mut column = Self {
            centre,
            radius,
            counts: [nx, ny],
            spacing: [dx, dy],
            open_fractions: vec![0.0; nx * ny],
        };
        let open: Vec<bool> = (0..nx * ny)
            .map(|cell| {
                column.distance_from_axis(column.cell_centre([cell % nx, cell / nx])) < radius
            })
            .collect();
        column.share_area(&open, &CellLocator::new(grid, LocalCells::whole([nx, ny, 1])), 0.5 * dz);
        Ok(column)
    }

    /// This column on other cells of its box.
    ///
    /// # Errors
    /// The errors of [`RoundColumn::new`].
    pub fn on(&self, grid: &BoxGrid) -> Result<Self, String> {
        Self::new(grid, self.centre, self.radius)
    }

    /// Radius R.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Cross-section of the column in cells: pi R^2 / (dx dy).
    pub fn cross_section_in_cells(&self) -> f64 {
        PI * self.radius * self.radius / (self.spacing[0] * self.spacing[1])
    }

    /// Open fraction of the cells at this place across the column; 0 if they are closed or outside the box.
    pub fn open_fraction(&self, [i, j]: [isize; 2]) -> f64 {
        let [nx, ny] = self.counts.map(|count| count as isize);
        let inside = (0..nx).contains(&i) && (0..ny).contains(&j);
        if inside { self.open_fractions[(i + nx * j) as usize] } else { 0.0 }
    }

    /// The open fraction of a cell, counted from the first cell of a rank's part.
    pub(crate) fn open_fraction_in(&self, part: &LocalCells, [i, j]: [isize; 2]) -> f64 {
        self.open_fraction([i + part.start[0] as isize, j + part.start[1] as isize])
    }

    /// 2 (1 - r^2 / R^2) in open cells, x fastest, scaled so that its mean over the column is 1; 0 in closed ones.
    pub fn parabolic_profile(&self) -> Vec<f64> {
        let parabola = |(cell, open): (usize, &f64)| {
            let [nx, _] = self.counts;
            let distance = self.distance_from_axis(self.cell_centre([cell % nx, cell / nx]));
            if *open > 0.0 { 1.0 - (distance / self.radius).powi(2) } else { 0.0 }
        };
        let mut profile: Vec<f64> = self.open_fractions.iter().enumerate().map(parabola).collect();
        let sum: f64 = profile.iter().zip(&self.open_fractions).map(|(v, open)| v * open).sum();
        profile.iter_mut().for_each(|value| *value *= self.cross_section_in_cells() / sum);
        profile
    }

    /// Distance from a point in the column to its wall along x (0) or y (1), forwards or backwards.
    pub(crate) fn distance_to_wall(&self, point: [f64; 2], axis: usize, forwards: bool) -> f64 {
        let along = point[axis] - self.centre[axis];
        self.half_chord(axis, point[1 - axis]) + if forwards { -along } else { along }
    }

    /// Half of the column's chord along an axis, at a place along the other.
    fn half_chord(&self, axis: usize, across: f64) -> f64 {
        let out = across - self.centre[1 - axis];
        (self.radius * self.radius - out * out).max(0.0).sqrt()
    }

    /// The point whose weights are used for a point in the column: the point itself, unless it lies in the outermost
    /// segments.
    #[inline(always)]
    pub(crate) fn within_reach(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let out = [point.x - self.centre[0], point.y - self.centre[1]];
        let distance = length_of(out);
        let reach = self.reach();
        if distance <= reach {
            return *point;
        }
        let factor = reach / distance;
        Vector3::new(self.centre[0] + out[0] * factor, self.centre[1] + out[1] * factor, point.z)
    }

    /// Distance from the axis within which one of the cells around every point is open: the weighted mean of the
    /// squared distances of their centres exceeds that of the point by at most (dx^2 + dy^2) / 4.
    fn reach(&self) -> f64 {
        let [dx, dy] = self.spacing;
        let rounding = 1.0 - 1.0e-12;
        (self.radius * self.radius - 0.25 * (dx * dx + dy * dy)).sqrt() * rounding
    }

    fn distance_from_axis(&self, [x, y]: [f64; 2]) -> f64 {
        length_of([x - self.centre[0], y - self.centre[1]])
    }

    fn cell_centre(&self, cell: [usize; 2]) -> [f64; 2] {
        [0, 1].map(|axis| (cell[axis] as f64 + 0.5) * self.spacing[axis])
    }

    /// Sets the open fractions, square by square between the centres of four cells.
    fn share_area(&mut self, open: &[bool], locator: &CellLocator, height: f64) {
        let [nx, ny] = self.counts;
        for (i, j) in (0..=ny).flat_map(|j| (0..=nx).map(move |i| (i, j))) {
            let corners = [[i, j], [i + 1, j], [i, j + 1], [i + 1, j + 1]];
            let cell = |[i, j]: [usize; 2]| {
                let inside = (1..=nx).contains(&i) && (1..=ny).contains(&j);
                inside.then(|| i - 1 + nx * (j - 1))
            };
            let within = |&cell: &usize| {
                let centre = self.cell_centre([cell % nx, cell / nx]);
                open[cell] && self.distance_from_axis(centre) <= self.reach()
            };
            let cells: Vec<usize> = corners.into_iter().filter_map(cell).filter(within).collect();
            if cells.len() == corners.len() {
                cells.into_iter().for_each(|cell| self.open_fractions[cell] += 0.25);
            } else {
                self.share_square([i, j], open, locator, height);
            }
        }
        self.make_sum_exact();
    }

    /// Shares the part of a square that lies in the column, in strips along the axis to which the wall is more nearly
    /// normal.
    fn share_square(&mut self, square: [usize; 2], open: &[bool], locator: &CellLocator, z: f64) {
        let edges = [0, 1].map(|axis| {
            let edge = |offset: f64| (square[axis] as f64 + offset) * self.spacing[axis];
            [edge(-0.5).max(0.0), edge(0.5).min(self.counts[axis] as f64 * self.spacing[axis])]
        });
        let from_axis =
            [0, 1].map(|axis| (0.5 * (edges[axis][0] + edges[axis][1]) - self.centre[axis]).abs());
        let along = usize::from(from_axis[1] > from_axis[0]);
        let across = 1 - along;
        let width = (edges[across][1] - edges[across][0]) / STRIPS as f64;
        for strip in 0..STRIPS {
            let mut point = Vector3::new(0.0, 0.0, z);
            point[across] = edges[across][0] + (strip as f64 + 0.5) * width;
            let half_chord = self.half_chord(along, point[across]);
            let lowest = edges[along][0].max(self.centre[along] - half_chord);
            let highest = edges[along][1].min(self.centre[along] + half_chord);
            let step = (highest - lowest) / STRIPS as f64;
            if step <= 0.0 {
                continue;
            }
            let part = width * step / (self.spacing[0] * self.spacing[1]);
            for place in 0..STRIPS {
                point[along] = lowest + (place as f64 + 0.5) * step;
                self.share_point(point, part, open, locator);
            }
        }
    }

    fn share_point(
        &mut self,
        point: Vector3<f64>,
        part: f64,
        open: &[bool],
        locator: &CellLocator,
    ) {
        let corners = locator.weights(&self.within_reach(&point)).corners();
        let shares = corners.map(|([i, j, _], weight)| {
            let cell = i as usize + self.counts[0] * j as usize;
            (cell, if open[cell] { weight } else { 0.0 })
        });
        let sum: f64 = shares.iter().map(|(_, weight)| weight).sum();
        for (cell, weight) in shares {
            self.open_fractions[cell] += part * (weight / sum);
        }
    }

    /// Scales the fractions of cells at the wall so that their sum is that of the column.
    fn make_sum_exact(&mut self) {
        let full = self.open_fractions.iter().filter(|&&part| part == 1.0).count() as f64;
        let at_wall: f64 = self.open_fractions.iter().filter(|&&part| part != 1.0).sum();
        let factor = (self.cross_section_in_cells() - full) / at_wall;
        for part in self.open_fractions.iter_mut().filter(|part| **part != 1.0) {
            *part *= factor;
        }
    }
}

#[inline(always)]
fn length_of([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y).sqrt()
}

/// A column on the cells of a rank, for fields with a halo of one width.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ColumnOnCells {
    /// The whole column.
    pub(crate) column: RoundColumn,
    /// Open fractions of the cells of a field, in the order of memory.
    open_fractions: Field,
}

impl ColumnOnCells {
    /// The column on the cells of a part, for fields of the shape of `field`.
    pub(crate) fn new(column: &RoundColumn, part: &LocalCells, field: &Field) -> Self {
        let mut open_fractions = Field::new(part, field.halo());
        let halo = field.halo() as isize;
        let [x, y, z] = part.count.map(|count| -halo..count as isize + halo);
        for (i, j) in y.flat_map(|j| x.clone().map(move |i| (i, j))) {
            let open = column.open_fraction_in(part, [i, j]);
            z.clone().for_each(|k| *open_fractions.at_mut([i, j, k]) = open);
        }
        Self { column: column.clone(), open_fractions }
    }

    /// Open fractions of the cells of a field, in the order of memory; 0 if they are closed.
    pub(crate) fn values(&self) -> &[f64] {
        self.open_fractions.values()
    }

    /// Open fraction of the cell at an index into a field.
    #[inline(always)]
    pub(crate) fn at(&self, index: usize) -> f64 {
        self.open_fractions.values()[index]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::{Bounds, Face};
    use proptest::prelude::*;

    fn grid(lengths: [f64; 2], counts: [usize; 2]) -> BoxGrid {
        let walls = [Face::Wall; 2];
        let bounds = Bounds::new(Vector3::new(lengths[0], lengths[1], 1.0), [walls; 3]);
        BoxGrid::new(&bounds, [counts[0], counts[1], 2])
    }

    proptest! {
        #[test]
        fn the_cells_of_a_column_have_its_cross_section(
            radius in 1.0..2.0f64, x in 2.0..2.5f64, y in 2.0..3.0f64, nx in 10usize..30, ny in 11usize..25,
        ) {
            let column = RoundColumn::new(&grid([4.5, 5.0], [nx, ny]), [x, y], radius).unwrap();
            let [nx, ny] = [nx as isize, ny as isize];
            let cells = (0..ny).flat_map(|j| (0..nx).map(move |i| [i, j]));
            let (mut sum, mut full) = (0.0, 0);
            for [i, j] in cells {
                let open = column.open_fraction([i, j]);
                let centre = column.cell_centre([i as usize, j as usize]);
                let depth = radius - column.distance_from_axis(centre);
                prop_assert_eq!(open > 0.0, depth > 0.0);
                // No open cell is small, and none has more than itself and its neighbours outwards.
                prop_assert!(open == 0.0 || (0.3..2.5).contains(&open), "{}", open);
                let diagonal = (column.spacing[0].powi(2) + column.spacing[1].powi(2)).sqrt();
                let is_inside = depth > 2.0 * diagonal;
                prop_assert!(!is_inside || open == 1.0, "{}", open);
                full += i32::from(is_inside);
                sum += open;
            }
            // Some hundred terms of up to 2, and one scaling.
            prop_assert!((sum - column.cross_section_in_cells()).abs() < 1.0e-10, "{}", sum);
            // Negative control: whole cells whose centres are inside have another area.
            prop_assert!(f64::from(full) < column.cross_section_in_cells());
        }
    }

    /// Open fraction of the cell at this distance from a flat wall, over its width.
    fn at_flat_wall(distance: f64) -> f64 {
        // Half of the hat towards the axis, and the whole range between the centre and the wall.
        0.5 + distance
    }

    #[test]
    fn the_cell_at_a_wide_columns_wall_has_all_that_lies_beyond_its_centre() {
        // At its pole a column of 200 cells is practically flat.
        for radius in [99.6, 99.9, 100.2] {
            let column = RoundColumn::new(&grid([202.0; 2], [202; 2]), [101.5; 2], radius).unwrap();
            let last = (101.0 + radius).floor() as isize;
            let open = column.open_fraction([last, 101]);
            let expected = at_flat_wall(radius - (last as f64 + 0.5 - 101.5));
            // The wall recedes by 1/800 over half a cell.
            assert!((open - expected).abs() < 2.0e-3, "{radius}: {open} for {expected}");
            assert_eq!(column.open_fraction([last + 1, 101]), 0.0);
        }
    }

    #[test]
    fn columns_that_do_not_fit_are_refused() {
        let grid = grid([4.0, 5.0], [10, 10]);
        let refused = |centre, radius| RoundColumn::new(&grid, centre, radius).unwrap_err();
        assert!(refused([2.0, 2.5], 2.01).contains("along x"));
        assert!(refused([2.0, 3.5], 1.9).contains("along y"));
        assert!(refused([2.0, 2.5], 0.9).contains("3.60 cells"));
        assert!(RoundColumn::new(&grid, [2.0, 2.5], 2.0).is_ok());
    }

    #[test]
    fn every_point_of_a_column_has_an_open_cell_around_it() {
        let grid = grid([4.0, 4.0], [7, 9]);
        let column = RoundColumn::new(&grid, [2.03, 1.98], 1.93).unwrap();
        let locator = CellLocator::new(&grid, LocalCells::whole([7, 9, 1]));
        for step in 0..20_000 {
            let angle = f64::from(step) * 1.0e-3;
            let out = 1.93 * if step % 2 == 0 { 1.0 } else { 0.99 };
            let point = Vector3::new(2.03 + out * angle.cos(), 1.98 + out * angle.sin(), 0.2);
            let corners = locator.weights(&column.within_reach(&point)).corners();
            let open: f64 = corners
                .iter()
                .filter(|([i, j, _], _)| column.open_fraction([*i, *j]) > 0.0)
                .map(|(_, weight)| weight)
                .sum();
            assert!(open > 0.0, "{point}");
        }
    }
}
