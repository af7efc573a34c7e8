//! Cells change owner: records of cells from a file, or of another decomposition, are sent to the ranks that own the
//! cells.

use super::migrate::deliver;
use super::{CellRecord, Communicator};
use crate::domain::Decomposition;
use crate::grid::{BoxGrid, LocalCells};
use nalgebra::Vector3;

impl CellRecord {
    /// The indices of the cell in the whole grid.
    fn global_indices(&self, counts: [usize; 3]) -> [usize; 3] {
        let cell = self.cell as usize;
        [cell % counts[0], cell / counts[0] % counts[1], cell / (counts[0] * counts[1])]
    }

    /// The local indices of the cell on the rank that owns it.
    pub(crate) fn indices_in(&self, local: &LocalCells) -> [isize; 3] {
        let global = self.global_indices(local.counts);
        [0, 1, 2].map(|axis| global[axis] as isize - local.start[axis] as isize)
    }
}

/// Sends records to the ranks that own their cells, from whatever ranks hold them. This call is collective.
pub(crate) fn send_cells_to_owners(
    records: &[CellRecord],
    grid: &BoxGrid,
    decomposition: &Decomposition,
    ranks: &dyn Communicator,
) -> Vec<CellRecord> {
    let mut outgoing = vec![Vec::new(); ranks.size()];
    for record in records {
        let cell = record.global_indices(grid.counts());
        let centre = Vector3::from_fn(|axis, _| (cell[axis] as f64 + 0.5) * grid.spacing()[axis]);
        outgoing[decomposition.owner_of(&centre)].push(*record);
    }
    deliver(outgoing, ranks)
}

#[cfg(test)]
mod tests {
    use super::super::run_on_threads;
    use super::*;
    use crate::domain::{Bounds, Face, RankGrid};
    use bytemuck::Zeroable;

    #[test]
    fn every_cell_arrives_at_its_owner() {
        let faces = [[Face::Periodic; 2], [Face::Wall; 2], [Face::Periodic; 2]];
        let bounds = Bounds::new(Vector3::new(1.1, 0.7, 2.3), faces);
        let grid = BoxGrid::new(&bounds, [4, 5, 9]);
        let decomposition = |shape: [usize; 3]| {
            grid.aligned(&Decomposition::even(RankGrid(shape), &bounds), [2; 3])
                .expect("cells suffice")
        };
        let (old, new) = (decomposition([2, 2, 1]), decomposition([1, 1, 4]));
        run_on_threads(4, |ranks| {
            let local = grid.local_cells(old.subdomain(&bounds, ranks.rank()));
            let [nx, ny, _] = local.count;
            let records: Vec<CellRecord> = (0..local.cells())
                .map(|n| {
                    let cell = [n % nx, n / nx % ny, n / (nx * ny)].map(|i| i as isize);
                    let number = local.number_of(cell);
                    let pressure = number as f64;
                    let record = CellRecord { cell: number, pressure, ..Zeroable::zeroed() };
                    assert_eq!(record.indices_in(&local), cell);
                    record
                })
                .collect();
            let received = send_cells_to_owners(&records, &grid, &new, ranks);
            let local = grid.local_cells(new.subdomain(&bounds, ranks.rank()));
            assert_eq!(received.len(), local.cells());
            for record in received {
                let cell = record.indices_in(&local);
                assert!((0..3).all(|a| (0..local.count[a] as isize).contains(&cell[a])));
                assert_eq!(record.pressure, record.cell as f64);
            }
        });
    }
}
