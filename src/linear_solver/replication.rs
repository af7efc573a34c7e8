//! Levels that every rank holds as a whole: gathering the cells of all ranks, and taking a rank's own back.

use super::cell_pairs::row_starts;
use super::operator::Coefficients;
use crate::grid::{Field, LocalCells};
use crate::parallel::Communicator;

/// Gathers a distributed field on every rank, and takes a rank's own cells out of it again.
#[derive(Clone, Debug)]
pub(super) struct Replication {
    cells: LocalCells,
    periodic: [bool; 3],
    buffer: Vec<f64>,
}

impl Replication {
    pub(super) fn new(cells: LocalCells, periodic: [bool; 3]) -> Self {
        Self { cells, periodic, buffer: vec![0.0; cells.counts.iter().product()] }
    }

    /// Gathers the owned cells of all ranks in the owned cells of `replica`. This call is collective.
    pub(super) fn gather(
        &mut self,
        field: &Field<f32>,
        replica: &mut Field<f32>,
        ranks: &dyn Communicator,
    ) {
        self.buffer.fill(0.0);
        let LocalCells { count, order, .. } = self.cells;
        let owned = row_starts(count.map(|count| 0..count as isize), order);
        for (row, first) in field.rows().zip(owned) {
            let values = &field.values()[row..][..field.row_length()];
            let start = self.place_of(first);
            let gathered = self.buffer[start..].iter_mut();
            gathered.zip(values).for_each(|(gathered, &value)| *gathered = f64::from(value));
        }
        // Each cell has one owner: only one addend of each sum is not zero.
        ranks.sum_exact(&mut self.buffer);
        let length = replica.row_length();
        for (row, gathered) in replica.rows().zip(self.buffer.chunks_exact(length)) {
            let values = replica.values_mut()[row..][..length].iter_mut();
            values.zip(gathered).for_each(|(value, &gathered)| *value = gathered as f32);
        }
    }

    /// Gathers coefficients; the halo of `replica` is not filled. This call is collective.
    pub(super) fn gather_coefficients(
        &mut self,
        coefficients: &Coefficients<f32>,
        replica: &mut Coefficients<f32>,
        ranks: &dyn Communicator,
    ) {
        for axis in 0..3 {
            self.gather(&coefficients.faces[axis], &mut replica.faces[axis], ranks);
        }
        self.gather(&coefficients.diagonal, &mut replica.diagonal, ranks);
    }

    /// Copies a rank's own cells and their halo from the replica.
    pub(super) fn take_local(&self, replica: &Field<f32>, field: &mut Field<f32>) {
        let halo = field.halo() as isize;
        let range = |axis: usize| -halo..self.cells.count[axis] as isize + halo;
        for k in range(2) {
            for j in range(1) {
                for i in range(0) {
                    if let Some(cell) = self.global_cell([i, j, k]) {
                        *field.at_mut([i, j, k]) = replica.at(cell);
                    }
                }
            }
        }
    }

    /// The cell of the whole grid; `None` beyond a face that is not periodic.
    fn global_cell(&self, cell: [isize; 3]) -> Option<[isize; 3]> {
        let mut global = [0; 3];
        for axis in 0..3 {
            let count = self.cells.counts[axis] as isize;
            let index = cell[axis] + self.cells.start[axis] as isize;
            if !(0..count).contains(&index) && !self.periodic[axis] {
                return None;
            }
            global[axis] = index.rem_euclid(count);
        }
        Some(global)
    }

    /// The place of an owned cell in the buffer, which has the order of the whole grid in memory, without a halo.
    fn place_of(&self, cell: [isize; 3]) -> usize {
        let LocalCells { counts, start, order: [row, inner, outer], .. } = self.cells;
        let at = |axis: usize| start[axis] + cell[axis] as usize;
        at(row) + counts[row] * (at(inner) + counts[inner] * at(outer))
    }
}
