//! The table file of an instrument, `measure-NAME.h5`, written by rank 0.
//!
//! There is a group for each table, all of whose datasets have the same number of rows; `time` is written last, and a
//! row without a time does not count. Rows are kept for a second of wall-clock time, and written together; at each
//! checkpoint they are secured against a kill.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::hdf5_file::SerialFile;
use super::output_file::{Obstacle, continue_or_create, shared_rows_up_to};
use super::table::{Rows, TableHead, over_time};
use super::{Head, MessageResult, OutputError, metadata_copy, on_root};
use crate::instruments::{self, InstrumentPlan, Layout, Table};
use talcum_engine::fields::{Column, Unit};
use talcum_engine::parallel::Communicator;

/// Approximate size of a chunk of rows, in bytes.
const PIECE: usize = 1 << 14;
/// Time for which rows are collected: opening a file takes about as long as a hundred steps of a small bed.
const PATIENCE: Duration = Duration::from_secs(1);

/// The open file.
#[derive(Debug)]
pub(super) struct InstrumentFile {
    path: PathBuf,
    tables: Vec<Table>,
    /// Rows that are not in the file yet, with their times; on rank 0.
    waiting: Vec<(f64, instruments::Rows)>,
    written: Instant,
}

/// The scalar results in the file of an instrument.
#[derive(Clone, Debug, PartialEq)]
pub struct InstrumentResults {
    /// Kind of the instrument.
    pub kind: String,
    /// Times of the rows.
    pub times: Vec<f64>,
    /// The columns in the order of the file, each with its values in the order of time.
    pub columns: Vec<Column<Vec<f64>, String>>,
}

impl InstrumentResults {
    /// The file of an instrument of this name in a folder of results.
    pub fn file_of(instrument: &str, results: &Path) -> PathBuf {
        results.join(instruments::table_file_name(instrument))
    }

    /// Reads the scalar results of a file `measure-NAME.h5`.
    ///
    /// # Errors
    /// If it is not such a file, or cannot be read.
    pub fn read(path: &Path) -> Result<Self, OutputError> {
        read_results(path).map_err(|message| OutputError { path: path.to_owned(), message })
    }
}

fn read_results(path: &Path) -> MessageResult<InstrumentResults> {
    let file = SerialFile::open(path)?;
    let names = file.text("/", "scalars")?;
    let times: Vec<f64> = file.read("/results/time")?;
    let mut columns = Vec::new();
    for name in names.split(',').filter(|name| !name.is_empty()) {
        let path = format!("/results/{name}");
        let mut values: Vec<f64> = file.read(&path)?;
        values.truncate(times.len());
        let [unit, meaning] = [file.unit(&path)?, file.description(&path)?];
        columns.push(Column::numbers(name, &unit, &meaning, values));
    }
    let results = InstrumentResults { kind: file.text("/", "kind")?, times, columns };
    file.close()?;
    Ok(results)
}

impl InstrumentFile {
    /// Begins the file, or continues it after the rows up to and including a time. Collective.
    pub(super) fn open(
        path: &Path,
        plan: &InstrumentPlan,
        layout: &Layout,
        head: Head<'_>,
        continue_after: Option<f64>,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        let begin = || {
            metadata_copy::create(path, &bulk(&layout.tables), |path| {
                make(path, plan, layout, head)
            })
        };
        on_root(path, ranks, || {
            let Some(time) = continue_after else { return begin() };
            let tables = &layout.tables;
            let go_on = |found| cut_after(path, time, plan, tables, found);
            let kept = continue_or_create(path, go_on, || Ok(0))?;
            if kept > 0 { metadata_copy::commit(path, &bulk(tables)) } else { begin() }
        })?;
        let (path, tables) = (path.to_owned(), layout.tables.clone());
        Ok(Self { path, tables, waiting: Vec::new(), written: Instant::now() })
    }

    /// Adds rows at a time. Collective.
    pub(super) fn append(
        &mut self,
        time: f64,
        rows: Vec<instruments::Rows>,
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        if ranks.is_root() {
            self.waiting.extend(rows.into_iter().map(|rows| (time, rows)));
        }
        let path = self.path.clone();
        on_root(&path, ranks, || {
            if self.written.elapsed() < PATIENCE { Ok(()) } else { self.write() }
        })?;
        Ok(())
    }

    /// Writes the collected rows, and secures them against a kill. Collective.
    pub(super) fn commit(&mut self, ranks: &dyn Communicator) -> Result<(), OutputError> {
        let path = self.path.clone();
        on_root(&path, ranks, || {
            self.write()?;
            metadata_copy::commit(&self.path, &bulk(&self.tables))
        })?;
        Ok(())
    }

    fn write(&mut self) -> MessageResult<()> {
        self.written = Instant::now();
        let waiting = std::mem::take(&mut self.waiting);
        if waiting.is_empty() {
            return Ok(());
        }
        let file = SerialFile::open_to_change(&self.path)?;
        for (number, table) in self.tables.iter().enumerate() {
            let rows: Vec<_> = waiting.iter().filter(|(_, rows)| rows.table == number).collect();
            if rows.iter().all(|(_, rows)| rows.count == 0) {
                continue;
            }
            for (place, column) in table.columns.iter().enumerate() {
                let values: Vec<f64> =
                    rows.iter().flat_map(|(_, rows)| &rows.values[place]).copied().collect();
                file.append(&path_of(table, &column.name), &values)?;
            }
            let times = rows.iter().flat_map(|(time, rows)| std::iter::repeat_n(*time, rows.count));
            file.append(&path_of(table, "time"), &times.collect::<Vec<f64>>())?;
        }
        file.close()
    }
}

fn path_of(table: &Table, column: &str) -> String {
    format!("/{}/{column}", table.name)
}

/// Paths of the datasets that grow, except for the times, which are copied at checkpoints.
fn bulk(tables: &[Table]) -> Vec<String> {
    let of_table =
        |table: &Table| table.columns.iter().map(|column| path_of(table, &column.name)).collect();
    tables.iter().flat_map::<Vec<String>, _>(of_table).collect()
}

/// Paths of the datasets of a table that grow.
fn growing(table: &Table) -> Vec<String> {
    [bulk(std::slice::from_ref(table)), vec![path_of(table, "time")]].concat()
}

fn make(path: &Path, plan: &InstrumentPlan, layout: &Layout, head: Head<'_>) -> MessageResult<()> {
    let file = SerialFile::create(path)?;
    for (name, entry) in head.provenance.entries() {
        file.set_text("/", name, &entry)?;
    }
    let scalars: Vec<&str> = layout.scalars().map(|column| &*column.name).collect();
    let described = [
        ("case", head.case_text),
        ("measure", &plan.name),
        ("kind", plan.kind.name()),
        ("settings", &plan.settings()),
        ("scalars", &scalars.join(",")),
    ];
    described.iter().try_for_each(|(name, text)| file.set_text("/", name, text))?;
    let units = head.units();
    for column in &layout.fixed {
        let path = format!("/{}", column.name);
        let rows = (column.values.len() / column.width().max(1)) as u64;
        let head = TableHead::of_column(&path, column, units);
        file.make_table::<f64>(&head, Rows::Fixed(rows))?;
        file.fill(&path, &column.values)?;
    }
    for table in &layout.tables {
        file.make_group(&format!("/{}", table.name))?;
        let time = Column::scalar("time", Unit::Time, "time of the row");
        for column in table.columns.iter().chain([&time]) {
            let piece = (PIECE / (8 * column.width().max(1))).clamp(1, 256);
            let path = path_of(table, &column.name);
            let head = TableHead::of_column(&path, column, units);
            file.make_table::<f64>(&head, Rows::Growing(piece))?;
        }
    }
    let scaled = |table: &Table| {
        let group = format!("/{}", table.name);
        table.columns.iter().map(|column| over_time(&group, column)).collect::<Vec<_>>()
    };
    file.set_scales(&layout.tables.iter().flat_map(scaled).collect::<Vec<_>>())?;
    file.close()
}

/// Drops the rows after a time; returns how many are left. If none are left, the file is unchanged: a new one replaces
/// it.
fn cut_after(
    path: &Path,
    time: f64,
    plan: &InstrumentPlan,
    tables: &[Table],
    found_length: u64,
) -> Result<u64, Obstacle> {
    metadata_copy::restore(path).map_err(Obstacle::Failed)?;
    let rows = rows_to_keep(path, time, plan, tables).map_err(Obstacle::Unusable)?;
    require_rows(path, tables, &rows, found_length).map_err(Obstacle::Unusable)?;
    let all = rows.iter().sum();
    if all > 0 {
        cut(path, tables, &rows).map_err(Obstacle::Failed)?;
    }
    Ok(all)
}

/// Number of rows of each table up to and including a time. Several rows may have the same time.
fn rows_to_keep(
    path: &Path,
    time: f64,
    plan: &InstrumentPlan,
    tables: &[Table],
) -> MessageResult<Vec<u64>> {
    let file = SerialFile::open(path)?;
    if file.text("/", "settings")? != plan.settings() {
        return Err("its settings are others".to_owned());
    }
    let rows_of = |table: &Table| {
        let times: Vec<f64> = file.read(&path_of(table, "time"))?;
        Ok(shared_rows_up_to(&times, time)? as u64)
    };
    let rows = tables.iter().map(rows_of).collect::<MessageResult<_>>()?;
    file.close()?;
    Ok(rows)
}

fn require_rows(
    path: &Path,
    tables: &[Table],
    rows: &[u64],
    found_length: u64,
) -> MessageResult<()> {
    let file = SerialFile::open(path)?;
    for (table, &rows) in tables.iter().zip(rows) {
        for name in growing(table) {
            metadata_copy::require_rows(&file, &name, rows, found_length)?;
        }
    }
    file.close()
}

fn cut(path: &Path, tables: &[Table], rows: &[u64]) -> MessageResult<()> {
    let file = SerialFile::open_to_change(path)?;
    for (table, &rows) in tables.iter().zip(rows) {
        growing(table).iter().try_for_each(|name| file.cut(name, rows))?;
    }
    file.close()
}
