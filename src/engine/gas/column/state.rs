//! The state that a column gas keeps from step to step: none, unless it comes from a plenum or is compressible.

use super::compressible::ColumnCell;
use crate::parallel::{CellRecord, Communicator};
use bytemuck::Zeroable;

/// Number of the cell that represents a plenum in checkpoints. The intervals of a compressible gas, from the plate
/// upwards, have the numbers before it, in descending order: no volume-averaged gas has so many cells.
const PLENUM: u64 = u64::MAX;
/// Smallest possible number of an interval.
const LOWEST_NUMBER: u64 = 1 << 63;

/// State of a compressible gas or a plenum; it is equal on all ranks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColumnState {
    /// Pressure of the plenum less that above the bed, if there is one.
    pub plenum: Option<f64>,
    /// State of a compressible gas, interval by interval from the plate upwards; empty for an incompressible one.
    pub cells: Vec<ColumnCell>,
}

impl ColumnState {
    /// Whether there is no state to keep.
    pub(in crate::gas) fn is_empty(&self) -> bool {
        self.plenum.is_none() && self.cells.is_empty()
    }

    /// Records of the state in a checkpoint.
    pub(in crate::gas) fn records(&self) -> Vec<CellRecord> {
        let plenum = self.plenum.map(|pressure| CellRecord {
            cell: PLENUM,
            pressure,
            ..CellRecord::zeroed()
        });
        let cells = self.cells.iter().zip(1..).map(|(cell, number)| CellRecord {
            cell: PLENUM - number,
            pressure: cell.pressure,
            voidage: cell.voidage,
            ..CellRecord::zeroed()
        });
        plenum.into_iter().chain(cells).collect()
    }

    /// Whether a record is one of a column gas.
    pub(in crate::gas) fn has(record: &CellRecord) -> bool {
        record.cell >= LOWEST_NUMBER
    }

    /// The state from the cells of a checkpoint, each on any one rank, whatever gas they belong to. Collective.
    pub(in crate::gas) fn from_records(
        records: &[CellRecord],
        ranks: &dyn Communicator,
    ) -> ColumnState {
        let own = || records.iter().filter(|record| Self::has(record));
        let mut counts = [0, 0];
        for record in own() {
            counts[usize::from(record.cell == PLENUM)] += 1;
        }
        ranks.sum_integers(&mut counts);
        let [cells, plenums] = counts.map(|count| count as usize);
        // Each cell is on one rank, so the sum of its bits is its bits. The plenum comes first.
        let mut bits = vec![0; 2 * (cells + 1)];
        for record in own() {
            let row = 2 * (PLENUM - record.cell) as usize;
            if let Some(row) = bits.get_mut(row..row + 2) {
                row.copy_from_slice(
                    &[record.pressure, record.voidage].map(|it| it.to_bits() as i64),
                );
            }
        }
        ranks.sum_integers(&mut bits);
        let mut rows = bits.chunks_exact(2).map(|row| {
            let [pressure, voidage] = [row[0], row[1]].map(|bits| f64::from_bits(bits as u64));
            ColumnCell { pressure, voidage }
        });
        let plenum = rows.next().filter(|_| plenums > 0).map(|row| row.pressure);
        Self { plenum, cells: rows.collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::run_on_threads;

    #[test]
    fn it_comes_back_from_records_on_any_ranks_among_those_of_another_gas() {
        let cell = |number: u64| CellRecord { cell: number, pressure: 7.0, ..CellRecord::zeroed() };
        for plenum in [None, Some(-0.3)] {
            for count in [0, 1, 5] {
                let of = |k: usize| ColumnCell { pressure: 0.1 - k as f64, voidage: 0.4 };
                let state = ColumnState { plenum, cells: (0..count).map(of).collect() };
                assert_eq!(state.is_empty(), plenum.is_none() && count == 0);
                let records = [vec![cell(0), cell(3)], state.records()].concat();
                let found = run_on_threads(3, |ranks| {
                    let own = records.iter().skip(ranks.rank()).step_by(3).copied();
                    ColumnState::from_records(&own.collect::<Vec<_>>(), ranks)
                });
                assert!(found.iter().all(|it| *it == state), "{found:?}");
            }
        }
    }
}
