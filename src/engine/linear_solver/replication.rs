//! Levels that every rank holds completely: gathering of the cells of all ranks, and extraction of a rank's own cells.

use super::operator::Coefficients;
use super::rows::row_starts;
use crate::grid::{Field, LocalCells};
use crate::parallel::Communicator;

/// Number of fields of coefficients, the most that are gathered at once.
const COEFFICIENTS: usize = 4;

/// Gathers distributed fields on every rank, and extracts a rank's own cells from them.
#[derive(Clone, Debug)]
pub(super) struct Replication {
    cells: LocalCells,
    periodic: [bool; 3],
    buffer: Vec<f64>,
}

impl Replication {
    pub(super) fn new(cells: LocalCells, periodic: [bool; 3]) -> Self {
        let largest = COEFFICIENTS * cells.counts.iter().product::<usize>();
        Self { cells, periodic, buffer: Vec::with_capacity(largest) }
    }

    /// Gathers the owned cells of all ranks in the owned cells of `replicas`, whose halos are not filled. This call is
    /// collective.
    pub(super) fn gather<const N: usize>(
        &mut self,
        fields: [&Field<f32>; N],
        replicas: [&mut Field<f32>; N],
        ranks: &dyn Communicator,
    ) {
        let LocalCells { counts, count, order, .. } = self.cells;
        let cells: usize = counts.iter().product();
        self.buffer.clear();
        self.buffer.resize(N * cells, 0.0);
        for (number, field) in fields.into_iter().enumerate() {
            let owned = row_starts(count.map(|count| 0..count as isize), order);
            for (row, first) in field.rows().zip(owned) {
                let values = &field.values()[row..][..field.row_length()];
                let start = number * cells + self.place_of(first);
                let gathered = self.buffer[start..].iter_mut();
                gathered.zip(values).for_each(|(gathered, &value)| *gathered = f64::from(value));
            }
        }
        // Each cell has one owner: only one addend of each sum is not zero.
        ranks.sum_exact(&mut self.buffer);
        for (replica, gathered) in replicas.into_iter().zip(self.buffer.chunks_exact(cells)) {
            let length = replica.row_length();
            for (row, gathered) in replica.rows().zip(gathered.chunks_exact(length)) {
                let values = replica.values_mut()[row..][..length].iter_mut();
                values.zip(gathered).for_each(|(value, &gathered)| *value = gathered as f32);
            }
        }
    }

    /// Gathers coefficients. This call is collective.
    pub(super) fn gather_coefficients(
        &mut self,
        coefficients: &Coefficients<f32>,
        replica: &mut Coefficients<f32>,
        ranks: &dyn Communicator,
    ) {
        let Coefficients { faces: [x, y, z], diagonal } = coefficients;
        self.gather([x, y, z, diagonal], replica.fields(), ranks);
    }

    /// Copies a rank's own cells and their halo from the replica, except for cells beyond faces that are not periodic.
    pub(super) fn take_local(&self, replica: &Field<f32>, field: &mut Field<f32>) {
        let halo = field.halo() as isize;
        let LocalCells { count, order: order @ [row, inner, outer], .. } = self.cells;
        let local = |axis: usize| -halo..count[axis] as isize + halo;
        // The divisions that wrap an index take longer than the copying.
        let along_row: Vec<Option<usize>> = local(row).map(|i| self.global(row, i)).collect();
        for k in local(outer) {
            for j in local(inner) {
                let beside = self.global(inner, j).zip(self.global(outer, k));
                let Some((global_j, global_k)) = beside else { continue };
                let first = in_order([0, global_j as isize, global_k as isize], order);
                let of_all = &replica.values()[replica.index(first)..];
                let to = field.index(in_order([-halo, j, k], order));
                let cells = field.values_mut()[to..].iter_mut();
                for (value, place) in cells.zip(&along_row) {
                    if let Some(place) = *place {
                        *value = of_all[place];
                    }
                }
            }
        }
    }

    /// The index of a cell in the whole grid along an axis; `None` beyond a face that is not periodic.
    fn global(&self, axis: usize, cell: isize) -> Option<usize> {
        let (count, index) =
            (self.cells.counts[axis] as isize, cell + self.cells.start[axis] as isize);
        let is_inside = (0..count).contains(&index);
        (is_inside || self.periodic[axis]).then(|| index.rem_euclid(count) as usize)
    }

    /// The place of an owned cell in the buffer, which has the memory order of the whole grid, without a halo.
    fn place_of(&self, cell: [isize; 3]) -> usize {
        let LocalCells { counts, start, order: [row, inner, outer], .. } = self.cells;
        let at = |axis: usize| start[axis] + cell[axis] as usize;
        at(row) + counts[row] * (at(inner) + counts[inner] * at(outer))
    }
}

/// A cell from its indices in the order of memory.
fn in_order(indices: [isize; 3], order: [usize; 3]) -> [isize; 3] {
    let mut cell = [0; 3];
    order.into_iter().zip(indices).for_each(|(axis, index)| cell[axis] = index);
    cell
}
