//! Contacts at chosen times for ParaView, as lines from centre to centre: temporal PolyData of VTKHDF 2.0.
//!
//! There is one partition for each time; lines are sorted by the ids of their ends, with two points for each line: a
//! contact through a periodic face is drawn to the image that is touched. Rows are written first, by all ranks; then
//! rank 0 writes the data that make them a time step.

use std::path::{Path, PathBuf};

use super::hdf5_file::{SerialFile, SharedFile};
use super::output_file::{Obstacle, continue_or_create, rows_up_to};
use super::table::{Rows, TableHead};
use super::{ColumnUnits, Head, MessageResult, OutputError, metadata_copy, on_root};
use crate::measures::ContactLine;
use crate::parallel::{Communicator, SortedRows, sort_by_id};

/// The kinds of cells that PolyData may have; ours are lines, but the groups of all kinds must exist.
const CELLS: [&str; 4] = ["Vertices", "Lines", "Polygons", "Strips"];
/// Integer columns of a line.
const IDS: [&str; 2] = ["lower", "higher"];
/// Number of rows of lines that are stored in one chunk.
const LINE_PIECE: usize = 4096;
/// Number of rows of steps that are stored in one chunk.
const STEP_PIECE: usize = 256;

/// A column of numbers of a line.
struct LineColumn {
    name: &'static str,
    width: usize,
    unit: fn(&ColumnUnits) -> &'static str,
    description: &'static str,
    of: fn(&ContactLine) -> &[f64],
}

const NUMBERS: [LineColumn; 5] = [
    LineColumn {
        name: "normal_force",
        width: 1,
        unit: |units| units.force,
        description: "normal force without van der Waals attraction, positive if it pushes the two apart",
        of: |line| std::slice::from_ref(&line.normal_force),
    },
    LineColumn {
        name: "cohesive_force",
        width: 1,
        unit: |units| units.force,
        description: "magnitude of the van der Waals attraction",
        of: |line| std::slice::from_ref(&line.cohesive_force),
    },
    LineColumn {
        name: "tangential_force",
        width: 3,
        unit: |units| units.force,
        description: "tangential force on the higher id",
        of: |line| &line.tangential_force,
    },
    LineColumn {
        name: "overlap",
        width: 1,
        unit: |units| units.length,
        description: "overlap of the surfaces",
        of: |line| std::slice::from_ref(&line.overlap),
    },
    LineColumn {
        name: "age",
        width: 1,
        unit: |units| units.time,
        description: "time since the first of the samples at all of which the two have touched",
        of: |line| std::slice::from_ref(&line.age),
    },
];

/// Numbers of steps and lines in the file.
#[derive(Clone, Copy, Debug, Default)]
struct Extent {
    steps: u64,
    lines: u64,
}

/// The file of lines.
#[derive(Clone, Debug)]
pub(super) struct ContactLines {
    path: PathBuf,
    extent: Extent,
}

fn cell_data(name: &str) -> String {
    format!("/VTKHDF/CellData/{name}")
}

fn names() -> impl Iterator<Item = &'static str> {
    IDS.into_iter().chain(NUMBERS.iter().map(|column| column.name))
}

/// Datasets of /VTKHDF/Steps with one integer for each time.
fn step_tables() -> Vec<String> {
    let steps = ["PartOffsets", "NumberOfParts", "PointOffsets"]
        .map(|name| format!("/VTKHDF/Steps/{name}"));
    let data = names().map(|name| format!("/VTKHDF/Steps/CellDataOffsets/{name}"));
    let cells = CELLS.iter().flat_map(|kind| {
        ["NumberOfCells", "NumberOfConnectivityIds"].map(|name| format!("/VTKHDF/{kind}/{name}"))
    });
    let number = std::iter::once("/VTKHDF/NumberOfPoints".to_owned());
    let others = CELLS.iter().filter(|kind| **kind != "Lines");
    let offsets = others.map(|kind| format!("/VTKHDF/{kind}/Offsets"));
    steps.into_iter().chain(data).chain(cells).chain(number).chain(offsets).collect()
}

/// The datasets of lines that grow, with their numbers of rows for an extent.
fn line_tables(Extent { steps, lines }: Extent) -> Vec<(String, u64)> {
    let others = [
        ("Points", 2 * lines),
        ("Lines/Connectivity", 2 * lines),
        ("Lines/Offsets", lines + steps),
    ];
    let others = others.map(|(name, rows)| (format!("/VTKHDF/{name}"), rows));
    names().map(|name| (cell_data(name), lines)).chain(others).collect()
}

/// Every dataset that grows, with its number of rows for an extent.
fn tables(extent: Extent) -> Vec<(String, u64)> {
    let of_steps = ["CellOffsets", "ConnectivityIdOffsets", "Values"];
    let of_steps = of_steps.map(|name| format!("/VTKHDF/Steps/{name}"));
    let of_steps = step_tables().into_iter().chain(of_steps).map(|name| (name, extent.steps));
    line_tables(extent).into_iter().chain(of_steps).collect()
}

/// The tables of the lines, which are not copied at checkpoints.
fn bulk() -> Vec<String> {
    line_tables(Extent::default()).into_iter().map(|(name, _)| name).collect()
}

impl ContactLines {
    /// Begins the file, or continues it after the lines up to and including a time. Collective.
    pub(super) fn open(
        path: &Path,
        head: Head<'_>,
        continue_after: Option<f64>,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        let begin = || metadata_copy::create(path, &bulk(), |path| make(path, head));
        let found = on_root(path, ranks, || {
            let Some(time) = continue_after else { return begin().map(|()| Extent::default()) };
            let go_on = |found| cut_after(path, time, found);
            let kept = continue_or_create(path, go_on, || Ok(Extent::default()))?;
            match kept.steps {
                0 => begin()?,
                _ => metadata_copy::commit(path, &bulk())?,
            }
            Ok(kept)
        })?;
        // Only rank 0 has counted: the sum makes the result known to all ranks.
        let found = found.unwrap_or_default();
        let mut counts = [found.steps as i64, found.lines as i64];
        ranks.sum_integers(&mut counts);
        let [steps, lines] = counts.map(|count| count as u64);
        Ok(Self { path: path.to_owned(), extent: Extent { steps, lines } })
    }

    /// Adds the lines of a time: all ranks' shares, in any order. Collective.
    pub(super) fn append(
        &mut self,
        time: f64,
        lines: &[ContactLine],
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        let block = sort_by_id(lines, |line| [line.lower, line.higher], ranks);
        let before = self.extent;
        let after = Extent { steps: before.steps + 1, lines: before.lines + block.total };
        let file = SharedFile::open_to_write(&self.path, ranks)?;
        line_tables(after).iter().try_for_each(|(name, rows)| file.grow(name, *rows))?;
        write_lines(&file, before, &block, ranks)?;
        file.close()?;
        on_root(&self.path, ranks, || append_step(&self.path, time, before, block.total))?;
        self.extent = after;
        Ok(())
    }

    /// Secures the written data. Collective.
    pub(super) fn commit(&self, ranks: &dyn Communicator) -> Result<(), OutputError> {
        metadata_copy::commit_on_root(&self.path, &bulk(), ranks)
    }
}

/// Writes this rank's lines.
fn write_lines(
    file: &SharedFile<'_>,
    before: Extent,
    block: &SortedRows<ContactLine>,
    ranks: &dyn Communicator,
) -> Result<(), OutputError> {
    let (rows, first) = (&block.rows, before.lines + block.offset);
    let points = rows.iter().flat_map(|line| line.start.into_iter().chain(line.end));
    file.write_rows("/VTKHDF/Points", 2 * first, &points.collect::<Vec<f64>>())?;
    let ends = 2 * block.offset..2 * (block.offset + rows.len() as u64);
    let ends: Vec<i64> = ends.map(|end| end as i64).collect();
    file.write_rows("/VTKHDF/Lines/Connectivity", 2 * first, &ends)?;
    let is_last = ranks.rank() + 1 == ranks.size();
    let offsets = ends.iter().copied().step_by(2).chain(is_last.then_some(2 * block.total as i64));
    let offsets: Vec<i64> = offsets.collect();
    file.write_rows("/VTKHDF/Lines/Offsets", first + before.steps, &offsets)?;
    let ids: [fn(&ContactLine) -> u64; 2] = [|line| line.lower, |line| line.higher];
    for (name, id) in IDS.into_iter().zip(ids) {
        let values: Vec<i64> = rows.iter().map(|line| id(line) as i64).collect();
        file.write_rows(&cell_data(name), first, &values)?;
    }
    for column in &NUMBERS {
        let values: Vec<f64> = rows.iter().flat_map(column.of).copied().collect();
        file.write_rows(&cell_data(column.name), first, &values)?;
    }
    Ok(())
}

fn make(path: &Path, head: Head<'_>) -> MessageResult<()> {
    let file = SerialFile::create(path)?;
    for group in ["/VTKHDF", "/VTKHDF/CellData", "/VTKHDF/Steps", "/VTKHDF/Steps/CellDataOffsets"] {
        file.make_group(group)?;
    }
    file.set_numbers("/VTKHDF", "Version", &[2_i64, 0])?;
    file.set_format_name("/VTKHDF", "Type", b"PolyData")?;
    file.set_number("/VTKHDF/Steps", "NSteps", 0_i64)?;
    file.make_group("/talcum")?;
    for (name, entry) in head.provenance.entries() {
        file.set_text("/talcum", name, &entry)?;
    }
    file.set_text("/talcum", "case", head.case_text)?;
    CELLS.iter().try_for_each(|kind| file.make_group(&format!("/VTKHDF/{kind}")))?;
    make_line_tables(&file, &head.units())?;
    make_step_tables(&file, &head.units())?;
    file.close()
}

fn make_line_tables(file: &SerialFile, units: &ColumnUnits) -> MessageResult<()> {
    let rows = Rows::Growing(LINE_PIECE);
    let (name, description) = ("/VTKHDF/Points", "centres: of the lower id, then of the higher");
    file.make_table::<f64>(&TableHead { name, width: 3, unit: units.length, description }, rows)?;
    for name in IDS {
        let description = "global id of a particle of the pair";
        let name = &cell_data(name);
        file.make_table::<i64>(&TableHead { name, width: 1, unit: "1", description }, rows)?;
    }
    for &LineColumn { name, width, unit, description, .. } in &NUMBERS {
        let name = &cell_data(name);
        file.make_table::<f64>(&TableHead { name, width, unit: unit(units), description }, rows)?;
    }
    for name in ["Connectivity", "Offsets"] {
        let name = &format!("/VTKHDF/Lines/{name}");
        let description = "index of VTKHDF";
        file.make_table::<i64>(&TableHead { name, width: 1, unit: "1", description }, rows)?;
    }
    for kind in CELLS.iter().filter(|kind| **kind != "Lines") {
        let name = &format!("/VTKHDF/{kind}/Connectivity");
        let description = "points of cells: there are none";
        file.make_table::<i64>(&TableHead { name, width: 1, unit: "1", description }, rows)?;
    }
    Ok(())
}

fn make_step_tables(file: &SerialFile, units: &ColumnUnits) -> MessageResult<()> {
    let rows = Rows::Growing(STEP_PIECE);
    let (name, description) = ("/VTKHDF/Steps/Values", "times");
    file.make_table::<f64>(&TableHead { name, width: 1, unit: units.time, description }, rows)?;
    let description = "index of VTKHDF, for each time";
    let four = ["CellOffsets", "ConnectivityIdOffsets"].map(|name| format!("/VTKHDF/Steps/{name}"));
    let integers = step_tables().into_iter().map(|name| (name, 1));
    for (name, width) in integers.chain(four.into_iter().map(|name| (name, CELLS.len()))) {
        file.make_table::<i64>(&TableHead { name: &name, width, unit: "1", description }, rows)?;
    }
    Ok(())
}

/// Turns the lines that were added after an extent into a time step.
fn append_step(path: &Path, time: f64, before: Extent, added: u64) -> MessageResult<()> {
    let file = SerialFile::open_to_change(path)?;
    file.append("/VTKHDF/Steps/Values", &[time])?;
    for name in step_tables() {
        let is_of_lines = name.contains("/Lines/");
        let value = match name.rsplit('/').next() {
            Some("PartOffsets") => before.steps,
            Some("NumberOfParts") => 1,
            Some("NumberOfPoints") => 2 * added,
            Some("PointOffsets") => 2 * before.lines,
            Some("NumberOfCells") if is_of_lines => added,
            Some("NumberOfConnectivityIds") if is_of_lines => 2 * added,
            _ if name.contains("CellDataOffsets") => before.lines,
            _ => 0,
        };
        file.append(&name, &[value as i64])?;
    }
    let of_lines = |value: u64| CELLS.map(|kind| if kind == "Lines" { value as i64 } else { 0 });
    file.append("/VTKHDF/Steps/CellOffsets", &of_lines(before.lines))?;
    file.append("/VTKHDF/Steps/ConnectivityIdOffsets", &of_lines(2 * before.lines))?;
    file.set_number("/VTKHDF/Steps", "NSteps", before.steps as i64 + 1)?;
    file.close()
}

/// Drops the lines after a time; returns the extent that is kept. If it is empty, the file is unchanged: a new one
/// replaces it.
fn cut_after(path: &Path, time: f64, found_length: u64) -> Result<Extent, Obstacle> {
    metadata_copy::restore(path).map_err(Obstacle::Failed)?;
    let kept = extent_to_keep(path, time, found_length).map_err(Obstacle::Unusable)?;
    if kept.steps > 0 {
        cut(path, kept).map_err(Obstacle::Failed)?;
    }
    Ok(kept)
}

fn extent_to_keep(path: &Path, time: f64, found_length: u64) -> MessageResult<Extent> {
    let file = SerialFile::open(path)?;
    let listed: i64 = file.number("/VTKHDF/Steps", "NSteps")?;
    let times: Vec<f64> = file.read("/VTKHDF/Steps/Values")?;
    let counts: Vec<i64> = file.read("/VTKHDF/Lines/NumberOfCells")?;
    let firsts: Vec<i64> = file.read(&format!("/VTKHDF/Steps/CellDataOffsets/{}", IDS[0]))?;
    let listed = times.len().min(listed.max(0) as usize);
    let steps = rows_up_to(&times[..listed], time)?;
    let mut places = firsts.iter().zip(&counts).take(steps);
    let lines = places.try_fold(0_i64, |sum, (&first, &count)| {
        sum.checked_add(count).filter(|_| first == sum && count >= 0)
    });
    let lines = lines.ok_or("its numbers of lines are damaged")?;
    let extent = Extent { steps: steps as u64, lines: lines as u64 };
    for (name, rows) in tables(extent) {
        metadata_copy::require_rows(&file, &name, rows, found_length)?;
    }
    file.close()?;
    Ok(extent)
}

fn cut(path: &Path, kept: Extent) -> MessageResult<()> {
    let file = SerialFile::open_to_change(path)?;
    for (name, rows) in tables(kept) {
        file.cut(&name, rows)?;
    }
    file.set_number("/VTKHDF/Steps", "NSteps", kept.steps as i64)?;
    file.close()
}
