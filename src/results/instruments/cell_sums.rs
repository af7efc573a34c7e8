//! Sums over samples on cells that are spread over the ranks, each cell on its rendezvous rank.

use super::stored::Stored;
use crate::analysis::send_to_rendezvous;
use std::collections::BTreeMap;
use talcum_engine::parallel::Communicator;

/// Sums by cell. If the contribution of a sample to a cell does not depend on the ranks, neither do the sums, since
/// samples follow one another in time.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct CellSums {
    sums: BTreeMap<u64, Vec<f64>>,
}

impl CellSums {
    /// Adds the values of a cell. This rank must be the cell's rendezvous rank.
    pub(super) fn add(&mut self, cell: u64, values: &[f64]) {
        let sums = self.sums.entry(cell).or_insert_with(|| vec![0.0; values.len()]);
        sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
    }

    /// The sums of this rank's cells, which are then reset.
    pub(super) fn take(&mut self) -> BTreeMap<u64, Vec<f64>> {
        std::mem::take(&mut self.sums)
    }

    /// Stores the sums under a name.
    pub(super) fn store(&self, name: &str, stored: &mut Stored) {
        let rows = self.sums.iter().flat_map(|(&cell, sums)| {
            sums.iter().enumerate().map(move |(place, sum)| [cell, place as u64, sum.to_bits()])
        });
        stored.add_records(name, &rows.collect::<Vec<[u64; 3]>>());
    }

    /// Continues from stored sums. Collective.
    pub(super) fn restore(
        &mut self,
        name: &str,
        stored: &Stored,
        ranks: &dyn Communicator,
    ) -> Option<()> {
        let rows: Vec<[u64; 3]> = stored.records(name)?;
        let mut rows = send_to_rendezvous(rows, |row| row[0], ranks);
        rows.sort_unstable();
        self.sums.clear();
        for [cell, _, bits] in rows {
            self.sums.entry(cell).or_default().push(f64::from_bits(bits));
        }
        Some(())
    }
}
