//! Fields of which every rank holds the whole.

use super::operator::Coefficients;
use crate::grid::{Field, LocalCells};
use crate::parallel::Communicator;

/// Brings the parts of a field together on every rank, and takes a rank's part out again.
#[derive(Clone, Debug)]
pub(super) struct Gathering {
    part: LocalCells,
    periodic: [bool; 3],
    buffer: Vec<f64>,
}

impl Gathering {
    pub(super) fn new(part: LocalCells, periodic: [bool; 3]) -> Self {
        Self { part, periodic, buffer: vec![0.0; part.counts.iter().product()] }
    }

    /// Owned cells of all parts into the owned cells of `whole`. Collective.
    pub(super) fn gather(&mut self, field: &Field, whole: &mut Field, ranks: &dyn Communicator) {
        self.buffer.fill(0.0);
        let [along_x, rows, _] = self.part.count;
        for (number, row) in field.rows().enumerate() {
            let [x, y, z] = self.part.start;
            let (j, k) = (y + number % rows, z + number / rows);
            let [_, along_y, along_z] = self.strides();
            let place = x + j * along_y + k * along_z;
            self.buffer[place..place + along_x]
                .copy_from_slice(&field.values()[row..row + along_x]);
        }
        // Each cell has one owner, so that every sum has one addend.
        ranks.sum_exact(&mut self.buffer);
        whole.set_owned(self.buffer.iter().copied());
    }

    /// Coefficients of all parts; their halos are not filled. Collective.
    pub(super) fn gather_coefficients(
        &mut self,
        parts: &Coefficients,
        whole: &mut Coefficients,
        ranks: &dyn Communicator,
    ) {
        for axis in 0..3 {
            self.gather(&parts.faces[axis], &mut whole.faces[axis], ranks);
        }
        self.gather(&parts.diagonal, &mut whole.diagonal, ranks);
    }

    /// A rank's part with its halo, out of the whole.
    pub(super) fn take_part(&self, whole: &Field, field: &mut Field) {
        let halo = field.halo() as isize;
        let range = |axis: usize| -halo..self.part.count[axis] as isize + halo;
        for k in range(2) {
            for j in range(1) {
                for i in range(0) {
                    if let Some(cell) = self.place([i, j, k]) {
                        *field.at_mut([i, j, k]) = whole.at(cell);
                    }
                }
            }
        }
    }

    /// Place in the whole of a cell of the part; none beyond a face that is not periodic.
    fn place(&self, cell: [isize; 3]) -> Option<[isize; 3]> {
        let mut place = [0; 3];
        for axis in 0..3 {
            let count = self.part.counts[axis] as isize;
            let number = cell[axis] + self.part.start[axis] as isize;
            if !(0..count).contains(&number) && !self.periodic[axis] {
                return None;
            }
            place[axis] = number.rem_euclid(count);
        }
        Some(place)
    }

    fn strides(&self) -> [usize; 3] {
        let [nx, ny, _] = self.part.counts;
        [1, nx, nx * ny]
    }
}
