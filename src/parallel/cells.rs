//! Cells change owner: what a file or another cut holds of them goes to the rank whose block they are in.

use super::migrate::deliver;
use super::{CellRecord, Communicator};
use crate::domain::Decomposition;
use crate::grid::{BoxGrid, LocalCells};
use nalgebra::Vector3;

impl CellRecord {
    /// The record of a cell of a part, counted from the part's first one.
    pub fn new(part: &LocalCells, cell: [isize; 3], numbers: [f64; Self::NUMBERS]) -> Self {
        let [i, j, k] = [0, 1, 2].map(|axis| part.start[axis] + cell[axis] as usize);
        Self { cell: (i + part.counts[0] * (j + part.counts[1] * k)) as u64, numbers }
    }

    /// Where the cell is in the whole grid.
    fn place(&self, counts: [usize; 3]) -> [usize; 3] {
        let cell = self.cell as usize;
        [cell % counts[0], cell / counts[0] % counts[1], cell / (counts[0] * counts[1])]
    }

    /// Where the cell is in a part that owns it.
    pub fn place_in(&self, part: &LocalCells) -> [isize; 3] {
        let place = self.place(part.counts);
        [0, 1, 2].map(|axis| place[axis] as isize - part.start[axis] as isize)
    }
}

/// Sends records to the ranks that own their cells, wherever they are now. Collective.
pub fn send_cells_to_owners(
    records: &[CellRecord],
    grid: &BoxGrid,
    decomposition: &Decomposition,
    ranks: &dyn Communicator,
) -> Vec<CellRecord> {
    let mut outgoing = vec![Vec::new(); ranks.size()];
    for record in records {
        let place = record.place(grid.counts());
        let centre = Vector3::from_fn(|axis, _| (place[axis] as f64 + 0.5) * grid.spacing()[axis]);
        outgoing[decomposition.owner_of(&centre)].push(*record);
    }
    deliver(outgoing, ranks)
}

#[cfg(test)]
mod tests {
    use super::super::run_on_threads;
    use super::*;
    use crate::domain::{Bounds, Face, RankGrid};

    #[test]
    fn every_cell_comes_to_its_owner() {
        let faces = [[Face::Periodic; 2], [Face::Wall; 2], [Face::Periodic; 2]];
        let bounds = Bounds::new(Vector3::new(1.1, 0.7, 2.3), faces);
        let grid = BoxGrid::new(&bounds, [4, 5, 9]);
        let decomposition = |shape: [usize; 3]| {
            grid.aligned(&Decomposition::even(RankGrid(shape), &bounds), 2).expect("cells suffice")
        };
        let (old, new) = (decomposition([2, 2, 1]), decomposition([1, 1, 4]));
        run_on_threads(4, |ranks| {
            let part = grid.local_cells(old.subdomain(&bounds, ranks.rank()));
            let [nx, ny, _] = part.count;
            let records: Vec<CellRecord> = (0..part.cells())
                .map(|n| {
                    let cell = [n % nx, n / nx % ny, n / (nx * ny)].map(|i| i as isize);
                    let record = CellRecord::new(&part, cell, [0.0; CellRecord::NUMBERS]);
                    assert_eq!(record.place_in(&part), cell);
                    CellRecord { numbers: [record.cell as f64; CellRecord::NUMBERS], ..record }
                })
                .collect();
            let received = send_cells_to_owners(&records, &grid, &new, ranks);
            let part = grid.local_cells(new.subdomain(&bounds, ranks.rank()));
            assert_eq!(received.len(), part.cells());
            for record in received {
                let place = record.place_in(&part);
                assert!((0..3).all(|a| (0..part.count[a] as isize).contains(&place[a])));
                assert_eq!(record.numbers, [record.cell as f64; CellRecord::NUMBERS]);
            }
        });
    }
}
