//! The cells into which particles are sorted to find their neighbours.

use super::Body;
use nalgebra::Vector3;
use std::ops::Range;

/// A grid of cells over the bounding box of the owned particles, each at least as wide as the range of the list, and a
/// layer of cells around it for ghosts.
///
/// The choice of cells changes the order of work, but never a result.
#[derive(Clone, Debug, Default)]
pub(crate) struct CellGrid {
    /// Corners of the bounding box; without particles, the lower corner is far above the upper.
    corners: [Vector3<f64>; 2],
    inverse_width: Vector3<f64>,
    /// Cells along each axis, those for ghosts included.
    counts: [usize; 3],
    owned: Members,
    ghosts: Members,
}

/// Particles in the order of their cells.
#[derive(Clone, Debug, Default)]
struct Members {
    /// Cell c holds `order[start[c]..start[c + 1]]`.
    start: Vec<u32>,
    order: Vec<u32>,
    cell_of: Vec<u32>,
}

/// A cell with particles, and the particles in the cells around it.
pub(crate) struct Neighbourhood<'a> {
    /// The owned particles of the cell.
    pub(crate) own: Range<usize>,
    /// End of the owned particles in this cell and in the next along x.
    pub(crate) own_end: usize,
    /// Owned particles in the four rows of cells behind this one, in the order of memory.
    pub(crate) behind: [Range<usize>; 4],
    /// Ghosts in each of the rows of cells around this one.
    pub(crate) ghosts: [&'a [u32]; 9],
}

/// Largest number of cells per particle: a few particles in a large box would otherwise need too much memory.
const CELLS_PER_PARTICLE: f64 = 4.0;

impl CellGrid {
    /// Lays out cells at least `width` wide over the owned bodies and sorts the bodies into them; there are no ghosts.
    pub(crate) fn fill(&mut self, bodies: &[Body], width: f64) {
        self.lay_out(bodies, width);
        let (cells, place) = (self.cells(), self.place());
        self.owned.sort(cells, bodies.iter().map(|body| place.of_owned(&body.position)));
        self.ghosts = Members::default();
    }

    /// Sorts ghosts into the cells.
    pub(crate) fn add_ghosts(&mut self, ghosts: &[Body]) {
        let (cells, place) = (self.cells(), self.place());
        self.ghosts.sort(cells, ghosts.iter().map(|body| place.of_ghost(&body.position)));
    }

    /// The lower and the upper corner of the box around the owned particles.
    pub(crate) fn corners(&self) -> &[Vector3<f64>; 2] {
        &self.corners
    }

    /// The indices of the owned particles, cell by cell.
    pub(crate) fn order(&self) -> &[u32] {
        &self.owned.order
    }

    /// The cells that contain owned particles, which must have been brought into the order of the cells; ghosts are
    /// numbered from 0.
    pub(crate) fn neighbourhoods(&self) -> impl Iterator<Item = Neighbourhood<'_>> {
        let has_owned = |&cell: &usize| !self.owned.in_cells(cell..cell + 1).is_empty();
        (0..self.cells()).filter(has_owned).map(|cell| self.around(cell))
    }

    #[inline(always)]
    fn around(&self, cell: usize) -> Neighbourhood<'_> {
        let (along_y, along_z) = (self.counts[0], self.counts[0] * self.counts[1]);
        // Owned particles are never in the outermost cells.
        let row = |cell: usize| cell - 1..cell + 2;
        let behind =
            [cell + along_y, cell + along_z - along_y, cell + along_z, cell + along_z + along_y];
        let before =
            [cell - along_z - along_y, cell - along_z, cell - along_z + along_y, cell - along_y];
        let mut ghosts: [&[u32]; 9] = [&[]; 9];
        if !self.ghosts.order.is_empty() {
            let rows = before.into_iter().chain([cell]).chain(behind);
            for (ghosts, around) in ghosts.iter_mut().zip(rows) {
                *ghosts = &self.ghosts.order[self.ghosts.in_cells(row(around))];
            }
        }
        Neighbourhood {
            own: self.owned.in_cells(cell..cell + 1),
            own_end: self.owned.in_cells(cell..cell + 2).end,
            behind: behind.map(|cell| self.owned.in_cells(row(cell))),
            ghosts,
        }
    }

    fn cells(&self) -> usize {
        self.counts.iter().product()
    }

    fn lay_out(&mut self, bodies: &[Body], width: f64) {
        let infinite = Vector3::repeat(f64::INFINITY);
        let around = |[lower, upper]: [Vector3<f64>; 2], body: &Body| {
            [lower.inf(&body.position), upper.sup(&body.position)]
        };
        self.corners = bodies.iter().fold([infinite, -infinite], around);
        let [lower, upper] = self.corners;
        let extent = if bodies.is_empty() { Vector3::zeros() } else { upper - lower };
        let mut width = width;
        let most = CELLS_PER_PARTICLE * bodies.len() as f64 + 27.0;
        let cells = |width: f64| extent.map(|length| (length / width).floor().max(1.0));
        while cells(width).product() > most {
            width *= 1.25;
        }
        let counts = cells(width);
        self.counts = [counts.x, counts.y, counts.z].map(|count| count as usize + 2);
        self.inverse_width = extent
            .zip_map(&counts, |length, count| if length > 0.0 { count / length } else { 0.0 });
    }

    fn place(&self) -> Place {
        let [origin, _] = self.corners;
        Place { origin, inverse_width: self.inverse_width, counts: self.counts }
    }
}

impl Members {
    /// Sorts particles into this number of cells, given the number of each particle's cell.
    fn sort(&mut self, cells: usize, cell_of: impl Iterator<Item = u32>) {
        self.cell_of.clear();
        self.cell_of.extend(cell_of);
        // Counts are stored one place further along, so that they turn into the starts.
        self.start.clear();
        self.start.resize(cells + 2, 0);
        for &cell in &self.cell_of {
            self.start[cell as usize + 2] += 1;
        }
        for cell in 2..cells + 2 {
            self.start[cell] += self.start[cell - 1];
        }
        self.order.clear();
        self.order.resize(self.cell_of.len(), 0);
        for (index, &cell) in self.cell_of.iter().enumerate() {
            let place = &mut self.start[cell as usize + 1];
            self.order[*place as usize] = index as u32;
            *place += 1;
        }
    }

    /// Places of the particles of consecutive cells, in their order.
    #[inline(always)]
    fn in_cells(&self, cells: Range<usize>) -> Range<usize> {
        self.start[cells.start] as usize..self.start[cells.end] as usize
    }
}

/// Location of positions in a grid.
#[derive(Clone, Copy)]
struct Place {
    origin: Vector3<f64>,
    inverse_width: Vector3<f64>,
    counts: [usize; 3],
}

impl Place {
    /// The cell of an owned particle; all of these lie within the outermost cells.
    fn of_owned(&self, position: &Vector3<f64>) -> u32 {
        self.cell(position, |cells, count| (cells as usize + 1).min(count - 2))
    }

    /// The cell of a ghost; the nearest cell if the ghost lies farther outside.
    fn of_ghost(&self, position: &Vector3<f64>) -> u32 {
        // Negative numbers become 0.
        self.cell(position, |cells, count| ((cells + 1.0) as usize).min(count - 1))
    }

    /// Finds the cell along each axis from the distance of a position from the origin, in widths of a cell.
    #[inline(always)]
    fn cell(&self, position: &Vector3<f64>, along: impl Fn(f64, usize) -> usize) -> u32 {
        let Self { origin, inverse_width, counts: [nx, ny, nz] } = *self;
        let cells = (position - origin).component_mul(&inverse_width);
        (along(cells.x, nx) + nx * (along(cells.y, ny) + ny * along(cells.z, nz))) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::{random_of, uniform};

    /// Bodies at random in a box that begins at `from`.
    fn bodies(count: usize, from: f64, lengths: [f64; 3]) -> Vec<Body> {
        let mut random = random_of(1, 0, "cells");
        let mut coordinate = |length: f64| from + length * uniform(&mut random);
        let position = |_| lengths.map(&mut coordinate);
        let positions: Vec<[f64; 3]> = (0..count).map(position).collect();
        positions.into_iter().map(|at| Body::new(at.into(), Vector3::zeros(), 0.5, 1.0)).collect()
    }

    /// All pairs of an owned body with a later one, or with a ghost, nearer than `width`: sorted.
    fn near(owned: &[Body], ghosts: &[Body], width: f64) -> Vec<[usize; 2]> {
        let is_near = |one: &Body, other: &Body| (one.position - other.position).norm() < width;
        let mut pairs = Vec::new();
        for (i, body) in owned.iter().enumerate() {
            let others = owned[i + 1..].iter().chain(ghosts).enumerate();
            pairs.extend(
                others.filter(|(_, other)| is_near(body, other)).map(|(k, _)| [i, i + 1 + k]),
            );
        }
        pairs
    }

    /// The same pairs, found among the neighbourhoods.
    fn found(grid: &CellGrid, owned: &[Body], ghosts: &[Body], width: f64) -> Vec<[usize; 2]> {
        let all: Vec<&Body> = owned.iter().chain(ghosts).collect();
        let mut pairs = Vec::new();
        for Neighbourhood { own, own_end, behind, ghosts } in grid.neighbourhoods() {
            for i in own {
                let others = (i + 1..own_end).chain(behind.iter().cloned().flatten());
                let of_ghosts = ghosts.iter().flat_map(|ghosts| ghosts.iter());
                let ghosts = of_ghosts.map(|&ghost| owned.len() + ghost as usize);
                let near = |&k: &usize| (all[k].position - all[i].position).norm() < width;
                pairs.extend(others.chain(ghosts).filter(near).map(|k| [i, k]));
            }
        }
        pairs.sort_unstable();
        pairs
    }

    #[test]
    fn every_near_pair_is_found_once() {
        let width = 1.1;
        for lengths in [[7.0, 5.0, 9.0], [0.3, 4.0, 6.0], [0.0, 0.0, 5.0]] {
            let mut owned = bodies(150, 2.0, lengths);
            let ghosts = bodies(150, 0.7, lengths.map(|length| length + 2.6));
            let mut grid = CellGrid::default();
            grid.fill(&owned, width);
            owned = grid.order().iter().map(|&index| owned[index as usize]).collect();
            grid.add_ghosts(&ghosts);
            let near_pairs = near(&owned, &ghosts, width);
            assert_eq!(found(&grid, &owned, &ghosts, width), near_pairs, "{lengths:?}");
            assert!(near_pairs.len() > 100);
            // Control: pairs farther apart than the width of a cell are missed.
            let farther = 3.0 * width;
            assert_ne!(found(&grid, &owned, &ghosts, farther), near(&owned, &ghosts, farther));
        }
    }

    #[test]
    fn no_particles_have_no_neighbourhoods() {
        let mut grid = CellGrid::default();
        assert_eq!(grid.neighbourhoods().count(), 0);
        grid.fill(&[], 1.0);
        grid.add_ghosts(&bodies(5, 0.0, [1.0; 3]));
        assert_eq!(grid.neighbourhoods().count(), 0);
    }
}
