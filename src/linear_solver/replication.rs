//! Levels that every rank holds as a whole: gathering the cells of all ranks, and taking a rank's own back.

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
        let [along_x, rows, _] = self.cells.count;
        for (number, row) in field.rows().enumerate() {
            let [x, y, z] = self.cells.start;
            let (j, k) = (y + number % rows, z + number / rows);
            let [_, along_y, along_z] = self.strides();
            let start = x + j * along_y + k * along_z;
            let values = &field.values()[row..row + along_x];
            let gathered = self.buffer[start..start + along_x].iter_mut();
            gathered.zip(values).for_each(|(gathered, &value)| *gathered = f64::from(value));
        }
        // Each cell has one owner: only one addend of each sum is not zero.
        ranks.sum_exact(&mut self.buffer);
        replica.set_owned(self.buffer.iter().map(|&value| value as f32));
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

    fn strides(&self) -> [usize; 3] {
        let [nx, ny, _] = self.cells.counts;
        [1, nx, nx * ny]
    }
}
