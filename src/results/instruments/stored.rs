//! Data of an instrument in checkpoints: tables of 64-bit words, whose rows are spread over the ranks.
//!
//! Numbers are stored as their bits. Rows are written in ascending order of their first two words, so that a checkpoint
//! does not depend on the ranks; a rank that reads them may receive any share.

use bytemuck::Pod;
use talcum_engine::parallel::{Communicator, records_of_bytes};

/// The widest row; 64-bit words.
pub const WIDEST: usize = 16;

/// One table.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StoredTable {
    /// Its name.
    pub name: String,
    /// Words in a row, from 2 to [`WIDEST`].
    pub width: usize,
    /// This rank's rows, one after another.
    pub words: Vec<u64>,
}

/// An instrument in a checkpoint.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct InstrumentState {
    /// Name of the instrument in the case.
    pub name: String,
    /// Its settings; it cannot continue with others.
    pub settings: String,
    /// Its stored data.
    pub stored: Stored,
}

/// All stored data of an instrument.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Stored {
    /// The tables, each with its own name.
    pub tables: Vec<StoredTable>,
}

impl Stored {
    /// Adds records that are spread over the ranks; their first two words order them.
    pub fn add_records<T: Pod>(&mut self, name: &str, records: &[T]) {
        let width = size_of::<T>() / size_of::<u64>();
        debug_assert!((2..=WIDEST).contains(&width) && size_of::<T>().is_multiple_of(8));
        let words = bytemuck::cast_slice::<T, u8>(records);
        let words = words.chunks_exact(8).map(bytemuck::pod_read_unaligned).collect();
        self.tables.push(StoredTable { name: name.to_owned(), width, words });
    }

    /// Adds numbers that all ranks have.
    pub fn add_numbers(&mut self, name: &str, numbers: &[f64], ranks: &dyn Communicator) {
        let rows = numbers.iter().enumerate().map(|(place, x)| [place as u64, x.to_bits()]);
        let rows: Vec<[u64; 2]> = if ranks.is_root() { rows.collect() } else { Vec::new() };
        self.add_records(name, &rows);
    }

    fn table(&self, name: &str) -> Option<&StoredTable> {
        self.tables.iter().find(|table| table.name == name)
    }

    /// This rank's share of the records with a name.
    pub fn records<T: Pod>(&self, name: &str) -> Option<Vec<T>> {
        let table = self.table(name).filter(|table| 8 * table.width == size_of::<T>())?;
        Some(records_of_bytes(bytemuck::cast_slice(&table.words)).collect())
    }

    /// The numbers with a name, on all ranks. Collective.
    pub fn numbers(&self, name: &str, ranks: &dyn Communicator) -> Option<Vec<f64>> {
        let rows: Vec<[u64; 2]> = self.records(name)?;
        let gathered = ranks.gather_to_root(bytemuck::cast_slice(&rows));
        let mut bytes = gathered.map(|all| all.concat()).unwrap_or_default();
        ranks.broadcast_from_root(&mut bytes);
        let mut rows: Vec<[u64; 2]> = records_of_bytes(&bytes).collect();
        rows.sort_unstable();
        Some(rows.into_iter().map(|[_, bits]| f64::from_bits(bits)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use talcum_engine::parallel::run_on_threads;

    #[test]
    fn numbers_and_records_come_back_bit_by_bit() {
        run_on_threads(3, |ranks| {
            let numbers = [0.1, -0.0, f64::NAN, 1.0e-310];
            let mut stored = Stored::default();
            stored.add_numbers("numbers", &numbers, ranks);
            stored.add_records("records", &[[ranks.rank() as u64, 7, 9]]);
            let found = stored.numbers("numbers", ranks).unwrap();
            assert_eq!(
                found.iter().map(|x| x.to_bits()).collect::<Vec<_>>(),
                numbers.map(f64::to_bits)
            );
            assert_eq!(
                stored.records::<[u64; 3]>("records"),
                Some(vec![[ranks.rank() as u64, 7, 9]])
            );
            // Controls: another width, another name.
            assert_eq!(stored.records::<[u64; 2]>("records"), None);
            assert_eq!(stored.numbers("other", ranks), None);
        });
    }
}
