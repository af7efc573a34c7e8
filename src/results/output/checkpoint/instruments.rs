//! Data of instruments in a checkpoint: `/measures/NAME/TABLE`, tables of 64-bit words.
//!
//! They are not part of the state, and the digest does not include them. Rows are sorted by their first two words, so
//! that the file does not depend on the ranks. An older program does not know `[measure]` and rejects the case in such
//! a checkpoint.

use crate::instruments::{InstrumentState, Stored, StoredTable, WIDEST};
use crate::output::hdf5_file::{SerialFile, SharedFile};
use crate::output::table::{Rows, TableHead};
use crate::output::{MessageResult, OutputError};
use bytemuck::Pod;
use std::ops::Range;
use talcum_engine::parallel::{Communicator, sort_by_id_in_chunks};

const GROUP: &str = "/measures";

fn path_of(instrument: &str, table: &str) -> String {
    format!("{GROUP}/{instrument}/{table}")
}

/// Numbers of rows over all ranks, instrument by instrument and table by table. Collective.
pub(super) fn row_counts(instruments: &[InstrumentState], ranks: &dyn Communicator) -> Vec<u64> {
    let tables = instruments.iter().flat_map(|instrument| &instrument.stored.tables);
    let mut counts: Vec<i64> =
        tables.map(|table| (table.words.len() / table.width.max(1)) as i64).collect();
    ranks.sum_integers(&mut counts);
    counts.into_iter().map(|count| count as u64).collect()
}

/// Makes the datasets; called on rank 0.
pub(super) fn make(
    file: &SerialFile,
    instruments: &[InstrumentState],
    row_counts: &[u64],
) -> MessageResult<()> {
    if instruments.is_empty() {
        return Ok(());
    }
    file.make_group(GROUP)?;
    file.set_text(GROUP, "names", &joined(instruments.iter().map(|instrument| &instrument.name)))?;
    let mut rows = row_counts.iter();
    for InstrumentState { name, settings, stored } in instruments {
        let group = format!("{GROUP}/{name}");
        file.make_group(&group)?;
        file.set_text(&group, "settings", settings)?;
        file.set_text(&group, "tables", &joined(stored.tables.iter().map(|table| &table.name)))?;
        for table in &stored.tables {
            let path = path_of(name, &table.name);
            let description = "accumulators of an instrument: bits of numbers, and ids";
            let shape: &[usize] = if table.width == 1 { &[] } else { &[table.width] };
            let head = TableHead { name: &path, shape, unit: "1", description };
            let rows = rows.next().copied().unwrap_or_default();
            file.make_table::<u64>(&head, Rows::Fixed(rows))?;
        }
    }
    Ok(())
}

fn joined<'a>(names: impl Iterator<Item = &'a String>) -> String {
    names.map(String::as_str).collect::<Vec<_>>().join(",")
}

fn split(names: &str) -> impl Iterator<Item = &str> {
    names.split(',').filter(|name| !name.is_empty())
}

/// Writes the rows of all ranks. Collective.
pub(super) fn write(
    file: &SharedFile<'_>,
    instruments: &[InstrumentState],
    ranks: &dyn Communicator,
) -> Result<(), OutputError> {
    for InstrumentState { name, stored, .. } in instruments {
        for table in &stored.tables {
            write_table(file, &path_of(name, &table.name), table, ranks)?;
        }
    }
    Ok(())
}

/// Writes a table; the sort moves records whose size is known to the compiler.
fn write_table(
    file: &SharedFile<'_>,
    path: &str,
    table: &StoredTable,
    ranks: &dyn Communicator,
) -> Result<(), OutputError> {
    match table.width {
        2 => write_rows::<2>(file, path, table, ranks),
        3 => write_rows::<3>(file, path, table, ranks),
        4 => write_rows::<4>(file, path, table, ranks),
        5..=8 => write_rows::<8>(file, path, table, ranks),
        _ => write_rows::<WIDEST>(file, path, table, ranks),
    }
}

fn write_rows<const ROOM: usize>(
    file: &SharedFile<'_>,
    path: &str,
    table: &StoredTable,
    ranks: &dyn Communicator,
) -> Result<(), OutputError>
where
    [u64; ROOM]: Pod,
{
    let padded = |row: &[u64]| {
        let mut record = [0; ROOM];
        record[..row.len()].copy_from_slice(row);
        record
    };
    let records: Vec<[u64; ROOM]> = table.words.chunks_exact(table.width).map(padded).collect();
    let dataset = file.dataset(path)?;
    let mut written = Ok(());
    // This is also done after an error, because the other ranks take part.
    sort_by_id_in_chunks(
        &records,
        |record| [record[0], record[1]],
        ranks,
        |sorted| {
            let words: Vec<u64> =
                sorted.rows.iter().flat_map(|record| &record[..table.width]).copied().collect();
            let result = dataset.write_rows(sorted.offset, &words);
            if written.is_ok() {
                written = result;
            }
        },
    );
    file.agreed(written)
}

/// Data of an instrument in a checkpoint, without rows.
pub(super) struct InstrumentHead {
    name: String,
    settings: String,
    /// Name, width and number of rows of each table.
    tables: Vec<(String, usize, u64)>,
}

/// The heads of the instruments in a file; empty for a file without instruments.
pub(super) fn read_heads(file: &SerialFile) -> MessageResult<Vec<InstrumentHead>> {
    let Ok(names) = file.text(GROUP, "names") else { return Ok(Vec::new()) };
    let head = |name: &str| -> MessageResult<InstrumentHead> {
        let group = format!("{GROUP}/{name}");
        let names = file.text(&group, "tables")?;
        let table = |table: &str| {
            let (rows, width) = file.shape(&path_of(name, table))?;
            if (2..=WIDEST).contains(&width) {
                Ok((table.to_owned(), width, rows))
            } else {
                Err(format!("{group}/{table} has rows of {width} words"))
            }
        };
        let tables = split(&names).map(table).collect::<Result<_, _>>()?;
        let settings = file.text(&group, "settings")?;
        Ok(InstrumentHead { name: name.to_owned(), settings, tables })
    };
    split(&names).map(head).collect()
}

/// Reads this rank's rows: `share_of` gives its share of a number of rows. Collective.
pub(super) fn read(
    file: &SharedFile<'_>,
    heads: Vec<InstrumentHead>,
    share_of: impl Fn(u64) -> Range<u64>,
) -> Result<Vec<InstrumentState>, OutputError> {
    let mut instruments = Vec::new();
    for InstrumentHead { name, settings, tables } in heads {
        let mut stored = Stored::default();
        for (table, width, rows) in tables {
            let Range { start, end } = share_of(rows);
            let words = match rows {
                0 => Vec::new(),
                _ => file.read_rows::<u64>(&path_of(&name, &table), start, end - start)?,
            };
            stored.tables.push(StoredTable { name: table, width, words });
        }
        instruments.push(InstrumentState { name, settings, stored });
    }
    Ok(instruments)
}
