//! Rows in the order of ids, whatever rank they come from: what files hold.

use bytemuck::Pod;

use super::Communicator;
use super::migrate::deliver;

/// One rank's rows of a table that is sorted over all ranks: the ranks' blocks, one after another in the
/// order of the ranks, are the table.
#[derive(Clone, Debug, PartialEq)]
pub struct SortedBlock<T> {
    /// This rank's rows, sorted; there may be none.
    pub rows: Vec<T>,
    /// Number of rows of lower ranks.
    pub offset: u64,
    /// Number of rows of all ranks.
    pub total: u64,
}

/// Sends each record to the rank that holds its part of the ids, and sorts there. The range of ids is
/// cut evenly, so that ranks hold about equally much if ids are about evenly spread. Records of one id
/// come to the same rank, in no certain order among themselves. Collective.
pub fn sort_by_id<T: Pod>(
    records: Vec<T>,
    id_of: impl Fn(&T) -> u64,
    ranks: &dyn Communicator,
) -> SortedBlock<T> {
    let (lowest, highest) = range_of_ids(records.iter().map(&id_of), ranks);
    let size = ranks.size() as u128;
    let width = u128::from(highest - lowest) + 1;
    let mut rows = records;
    if ranks.size() > 1 {
        let mut outgoing = vec![Vec::new(); ranks.size()];
        for record in rows {
            let rank = u128::from(id_of(&record) - lowest) * size / width;
            outgoing[rank as usize].push(record);
        }
        rows = deliver(outgoing, ranks);
    }
    rows.sort_unstable_by_key(&id_of);
    let (offset, total) = position_of_block(rows.len(), ranks);
    SortedBlock { rows, offset, total }
}

/// Number of rows of lower ranks, and of all ranks. Collective.
fn position_of_block(rows: usize, ranks: &dyn Communicator) -> (u64, u64) {
    let mut counts = vec![0; ranks.size()];
    counts[ranks.rank()] = rows as i64;
    ranks.sum_integers(&mut counts);
    let offset: i64 = counts[..ranks.rank()].iter().sum();
    (offset as u64, counts.iter().sum::<i64>() as u64)
}

/// The lowest and the highest id of all ranks; (0, 0) if there is none. Collective.
fn range_of_ids(ids: impl Iterator<Item = u64>, ranks: &dyn Communicator) -> (u64, u64) {
    let here = ids.fold(None, |range: Option<(u64, u64)>, id| {
        Some(range.map_or((id, id), |(low, high)| (low.min(id), high.max(id))))
    });
    // Each rank's range in its own place: exact, where a maximum of doubles would round.
    let mut ranges = vec![0; 3 * ranks.size()];
    if let Some((low, high)) = here {
        let own = &mut ranges[3 * ranks.rank()..][..3];
        own.copy_from_slice(&[1, low as i64, high as i64]);
    }
    ranks.sum_integers(&mut ranges);
    let present = ranges.chunks(3).filter(|range| range[0] == 1);
    present
        .map(|range| (range[1] as u64, range[2] as u64))
        .reduce(|all, one| (all.0.min(one.0), all.1.max(one.1)))
        .unwrap_or((0, 0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::run_on_threads;

    #[test]
    fn blocks_of_all_ranks_are_one_sorted_table() {
        let ids: Vec<u64> = (0..100).map(|k| (k * 37) % 101 + 5).collect();
        let mut sorted = ids.clone();
        sorted.sort_unstable();
        for n in 1..=4 {
            let blocks = run_on_threads(n, |ranks| {
                // Rank 0 has nothing to give if there are others.
                let mine = |k: usize| if n == 1 { true } else { k % (n - 1) + 1 == ranks.rank() };
                let here: Vec<u64> = (0..100).filter(|&k| mine(k)).map(|k: usize| ids[k]).collect();
                sort_by_id(here, |&id| id, ranks)
            });
            let mut table = Vec::new();
            for block in &blocks {
                assert_eq!((block.offset, block.total), (table.len() as u64, 100));
                table.extend_from_slice(&block.rows);
            }
            assert_eq!(table, sorted);
            assert!(blocks.iter().all(|block| block.rows.len() <= 100 / n + 2));
        }
    }

    #[test]
    fn extreme_ids_and_empty_tables_are_fine() {
        for n in 1..=3 {
            let blocks = run_on_threads(n, |ranks| {
                let here = if ranks.is_root() { vec![u64::MAX, 3, 0] } else { vec![] };
                (sort_by_id(here, |&id| id, ranks), sort_by_id::<u64>(vec![], |&id| id, ranks))
            });
            let table: Vec<u64> = blocks.iter().flat_map(|(block, _)| block.rows.clone()).collect();
            assert_eq!(table, [0, 3, u64::MAX]);
            assert!(blocks.iter().all(|(_, empty)| empty.total == 0 && empty.rows.is_empty()));
        }
    }
}
