//! Sorting of records by id over all ranks (bucket sort with one bucket of ids per rank), for the rows of files.

use bytemuck::Pod;

use super::{Communicator, Message, Records, records_of_bytes};

/// One rank's rows of a table that is sorted over all ranks. The rows of rank 0, of rank 1 and so on, one after
/// another, are the table, or a chunk of it.
#[derive(Clone, Debug, PartialEq)]
pub struct SortedRows<T> {
    /// This rank's rows, sorted; there may be none.
    pub rows: Vec<T>,
    /// Number of rows of the table before these.
    pub offset: u64,
    /// Number of rows of the whole table.
    pub total: u64,
}

/// Approximate number of rows per rank in a chunk of ids: small enough for the processor's cache, and large enough for
/// long messages and long transfers to files.
const ROWS_PER_CHUNK: u64 = 1 << 14;

/// Sorts all records by their first id, then by their second, and returns this rank's share. The range of first ids is
/// divided into equal parts, so that all ranks hold about as many rows if the ids are about evenly spread. Records with
/// the same first id come to the same rank; the order of records with equal ids is not defined. This call is
/// collective.
pub fn sort_by_id<T: Pod>(
    records: &(impl Records<T> + ?Sized),
    ids_of: impl Fn(&T) -> [u64; 2],
    ranks: &dyn Communicator,
) -> SortedRows<T> {
    let mut whole = None;
    sort_in_chunks(records, ids_of, 1, ranks, |rows| whole = Some(rows));
    whole.expect("there is one chunk")
}

/// Sorts records as [`sort_by_id`] does, but chunk by chunk: `take` receives this rank's share of the first chunk of
/// ids, then of the next. Only the records of one chunk are copied at a time, never all. Offsets and totals are those
/// of the whole table. This call is collective.
pub fn sort_by_id_in_chunks<T: Pod>(
    records: &(impl Records<T> + ?Sized),
    ids_of: impl Fn(&T) -> [u64; 2],
    ranks: &dyn Communicator,
    take: impl FnMut(SortedRows<T>),
) {
    let total = ranks.total(records.count()) as u64;
    let chunks = total.div_ceil(ROWS_PER_CHUNK * ranks.size() as u64) as usize;
    sort_in_chunks(records, ids_of, chunks, ranks, take);
}

fn sort_in_chunks<T: Pod>(
    records: &(impl Records<T> + ?Sized),
    ids_of: impl Fn(&T) -> [u64; 2],
    chunks: usize,
    ranks: &dyn Communicator,
    mut take: impl FnMut(SortedRows<T>),
) {
    let size = ranks.size();
    let first_ids: Vec<u64> =
        (0..records.count()).map(|index| ids_of(&records.at(index))[0]).collect();
    let ids = IdRange::of(first_ids.iter().copied(), ranks);
    // Each chunk consists of one part for each rank.
    let mut members = vec![Vec::new(); chunks * size];
    for (index, id) in first_ids.into_iter().enumerate() {
        members[ids.chunk_of(id, chunks * size)].push(index as u32);
    }
    let mut rows: Vec<i64> = members.iter().map(|part| part.len() as i64).collect();
    ranks.sum_integers(&mut rows);
    let total = rows.iter().sum::<i64>() as u64;
    let mut offset = 0;
    for (parts, rows) in members.chunks(size).zip(rows.chunks(size)) {
        let own = &parts[ranks.rank()];
        let own: Vec<T> = own.iter().map(|&index| records.at(index as usize)).collect();
        let to_others = (0..size).filter(|&rank| rank != ranks.rank() && !parts[rank].is_empty());
        let messages: Vec<Message> = to_others
            .map(|rank| Message { rank, bytes: bytes_of(records, &parts[rank]) })
            .collect();
        let incoming = ranks.sparse_exchange(&messages);
        let before = rows[..ranks.rank()].iter().sum::<i64>() as u64;
        let rows_here = sorted(&own, &incoming, &ids_of);
        take(SortedRows { rows: rows_here, offset: offset + before, total });
        offset += rows.iter().sum::<i64>() as u64;
    }
}

fn bytes_of<T: Pod>(records: &(impl Records<T> + ?Sized), part: &[u32]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(size_of::<T>() * part.len());
    for &index in part {
        bytes.extend_from_slice(bytemuck::bytes_of(&records.at(index as usize)));
    }
    bytes
}

/// Sorts the records of this rank and those in messages. The ids are sorted together with the positions of their
/// records, which are long.
fn sorted<T: Pod>(own: &[T], messages: &[Message], ids_of: impl Fn(&T) -> [u64; 2]) -> Vec<T> {
    let key = |record: &T| {
        let [first, second] = ids_of(record).map(u128::from);
        first << 64 | second
    };
    let mut order: Vec<(u128, [u32; 2])> = Vec::with_capacity(own.len());
    order.extend(own.iter().zip(0..).map(|(record, index)| (key(record), [0, index])));
    for (message, source) in messages.iter().zip(1..) {
        let records = records_of_bytes::<T>(&message.bytes).zip(0..);
        order.extend(records.map(|(record, index)| (key(&record), [source, index])));
    }
    order.sort_unstable_by_key(|&(key, _)| key);
    let record = |[source, index]: [u32; 2]| match source {
        0 => own[index as usize],
        _ => messages[source as usize - 1].record(index as usize),
    };
    order.into_iter().map(|(_, position)| record(position)).collect()
}

/// The lowest and the highest id of all ranks; zeros if there are no ids.
#[derive(Clone, Copy)]
pub(super) struct IdRange {
    lowest: u64,
    highest: u64,
}

impl IdRange {
    /// The range of the ids of all ranks. This call is collective.
    pub(super) fn of(ids: impl Iterator<Item = u64>, ranks: &dyn Communicator) -> Self {
        let here = ids.fold(None, |range: Option<(u64, u64)>, id| {
            Some(range.map_or((id, id), |(low, high)| (low.min(id), high.max(id))))
        });
        // One element for each rank, so that the sum of integers is exact; a maximum of doubles would round.
        let mut ranges = vec![0; 3 * ranks.size()];
        if let Some((low, high)) = here {
            let own = &mut ranges[3 * ranks.rank()..][..3];
            own.copy_from_slice(&[1, low as i64, high as i64]);
        }
        ranks.sum_integers(&mut ranges);
        let present = ranges.chunks(3).filter(|range| range[0] == 1);
        let (lowest, highest) = present
            .map(|range| (range[1] as u64, range[2] as u64))
            .reduce(|all, one| (all.0.min(one.0), all.1.max(one.1)))
            .unwrap_or((0, 0));
        Self { lowest, highest }
    }

    /// The chunk of an id if the range is divided into this many equal chunks; the nearest one for an id outside the
    /// range.
    pub(super) fn chunk_of(self, id: u64, chunks: usize) -> usize {
        let width = ((self.highest - self.lowest) / chunks as u64).saturating_add(1);
        ((id.saturating_sub(self.lowest) / width) as usize).min(chunks - 1)
    }
}

/// Sorts numbers of particles by their ids over the ranks: `width` numbers for each id, at most six. The numbers of the
/// rows of this rank are returned one after another, without ids. Collective.
pub fn sort_numbers_by_id(
    ids: impl Iterator<Item = u64>,
    numbers: &[f64],
    width: usize,
    ranks: &dyn Communicator,
) -> SortedRows<f64> {
    /// Largest number of components of a field.
    const WIDEST: usize = 6;
    let record = |(id, numbers): (u64, &[f64])| {
        let mut record = [id; 1 + WIDEST];
        record[1..=width].copy_from_slice(bytemuck::cast_slice(numbers));
        record
    };
    let records: Vec<[u64; 1 + WIDEST]> =
        ids.zip(numbers.chunks_exact(width)).map(record).collect();
    let SortedRows { rows, offset, total } = sort_by_id(&records, |record| [record[0], 0], ranks);
    let numbers = rows.iter().flat_map(|record| &record[1..=width]);
    SortedRows { rows: numbers.map(|&bits| f64::from_bits(bits)).collect(), offset, total }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::run_on_threads;

    #[test]
    fn rows_of_all_ranks_are_one_sorted_table() {
        let ids: Vec<u64> = (0..100).map(|k| (k * 37) % 101 + 5).collect();
        let mut sorted = ids.clone();
        sorted.sort_unstable();
        for n in 1..=4 {
            let by_rank = run_on_threads(n, |ranks| {
                // Rank 0 has no rows if there are other ranks.
                let mine = |k: usize| if n == 1 { true } else { k % (n - 1) + 1 == ranks.rank() };
                let here: Vec<u64> = (0..100).filter(|&k| mine(k)).map(|k: usize| ids[k]).collect();
                sort_by_id(&here, |&id| [id, 0], ranks)
            });
            let mut table = Vec::new();
            for sorted in &by_rank {
                assert_eq!((sorted.offset, sorted.total), (table.len() as u64, 100));
                table.extend_from_slice(&sorted.rows);
            }
            assert_eq!(table, sorted);
            assert!(by_rank.iter().all(|rows| rows.rows.len() <= 100 / n + 2));
        }
    }

    #[test]
    fn chunks_of_all_ranks_are_one_table_sorted_by_both_ids() {
        let pairs: Vec<[u64; 2]> = (0..300).map(|k| [(k * 37) % 101 + 5, (k * 7) % 13]).collect();
        let mut expected = pairs.clone();
        expected.sort_unstable();
        for n in 1..=3 {
            for chunks in [1, 2, 7] {
                let by_rank = run_on_threads(n, |ranks| {
                    let mine = pairs.iter().skip(ranks.rank()).step_by(n).copied();
                    let mut of_chunks = Vec::new();
                    let here: Vec<[u64; 2]> = mine.collect();
                    sort_in_chunks(&here, |&ids| ids, chunks, ranks, |rows| of_chunks.push(rows));
                    of_chunks
                });
                let mut table = Vec::new();
                for chunk in 0..chunks {
                    for rows in by_rank.iter().map(|of_chunks| &of_chunks[chunk]) {
                        assert_eq!((rows.offset, rows.total), (table.len() as u64, 300));
                        assert!(rows.rows.len() <= 300 / (n * chunks) + 6);
                        table.extend_from_slice(&rows.rows);
                    }
                }
                assert_eq!(table, expected);
            }
        }
    }

    #[test]
    fn extreme_ids_and_empty_tables_are_sorted() {
        for n in 1..=3 {
            let by_rank = run_on_threads(n, |ranks| {
                let here = if ranks.is_root() { vec![u64::MAX, 3, 0] } else { vec![] };
                (
                    sort_by_id(&here, |&id| [id, 0], ranks),
                    sort_by_id::<u64>(&[], |&id| [id, 0], ranks),
                )
            });
            let table: Vec<u64> = by_rank.iter().flat_map(|(rows, _)| rows.rows.clone()).collect();
            assert_eq!(table, [0, 3, u64::MAX]);
            assert!(by_rank.iter().all(|(_, empty)| empty.total == 0 && empty.rows.is_empty()));
        }
    }
}
