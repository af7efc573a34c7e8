//! The particles at chosen times for ParaView: `particles.vtkhdf`, temporal PolyData of VTKHDF 2.0.
//!
//! There is one partition for each time; rows are sorted by id, so that the file does not depend on the number of
//! ranks. Rows are written first, then the entries that make them a time step. The file is closed after each step, so
//! that it can be read during the run; at each checkpoint its rows are secured against a kill.

use std::path::{Path, PathBuf};

use super::hdf5_file::{SerialFile, SharedFile};
use super::output_file::{Obstacle, continue_or_create, rows_up_to};
use super::table::{Rows, TableHead};
use super::{
    ColumnUnits, Head, MessageResult, OpenedOutput, Opening, Output, OutputError, OutputKind,
    Sample, SnapshotFormat, metadata_copy, on_root,
};
use crate::parallel::{Communicator, ParticleRecord, Records, sort_by_id, sort_numbers_by_id};

/// The kinds of cells that PolyData may have. Each snapshot has one cell, a vertex of all its particles, so that it is
/// drawn by default; the groups of the other kinds must exist.
const CELLS: [&str; 4] = ["Vertices", "Lines", "Polygons", "Strips"];
/// The points of this vertex, 0, 1, 2, ...: one list for all snapshots, as long as the largest.
const VERTEX_POINTS: &str = "/VTKHDF/Vertices/Connectivity";
/// Start and end of the points of each vertex in that list: two rows for each snapshot.
const VERTEX_ENDS: &str = "/VTKHDF/Vertices/Offsets";
/// The positions.
const POINTS: &str = "/VTKHDF/Points";
/// Datasets with a row for each particle at each time.
const POINT_DATA: [&str; 4] = ["id", "velocity", "angular_velocity", "radius"];
/// Datasets of /VTKHDF/Steps with one integer for each time.
const STEP_INTEGERS: [&str; 3] = ["PartOffsets", "NumberOfParts", "PointOffsets"];
/// Datasets of /VTKHDF/Steps with one integer for each time and kind of cells.
const CELL_OFFSETS: [&str; 2] = ["CellOffsets", "ConnectivityIdOffsets"];
/// Number of rows of particles that are stored in one chunk.
const POINT_PIECE: usize = 4096;
/// Number of rows of steps that are stored in one chunk.
const STEP_PIECE: usize = 256;

/// The file of snapshots.
#[derive(Clone, Debug)]
pub struct ParticleSnapshots {
    path: PathBuf,
    format: SnapshotFormat,
    /// Whether the file is compressed; a file that was begun with another setting keeps it.
    compressed: bool,
    steps: u64,
    /// Number of rows, including those between snapshots.
    points: u64,
}

/// Rows of one snapshot: those of all particles, from the first row on.
#[derive(Clone, Copy)]
struct SnapshotRows {
    step: u64,
    first: u64,
    count: u64,
}

impl ParticleSnapshots {
    /// Entry in the list of outputs.
    pub const KIND: OutputKind = OutputKind {
        file_name: "particles.vtkhdf",
        needs_momentum_before: false,
        open: Self::open,
    };

    fn open(path: &Path, opening: &Opening<'_>, ranks: &dyn Communicator) -> OpenedOutput {
        let format = opening.snapshots;
        let snapshots = match opening.continue_after {
            Some(time) => Self::resume(path, time, opening.head, format, ranks)?,
            None => Self::create(path, opening.head, format, ranks)?,
        };
        Ok(Some(Box::new(snapshots)))
    }

    /// Begins a file, replacing any existing one. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn create(
        path: &Path,
        head: Head<'_>,
        format: &SnapshotFormat,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        on_root(path, ranks, || create(path, head, format))?;
        let (path, format) = (path.to_owned(), format.clone());
        let compressed = format.storage.compression > 0;
        Ok(Self { path, format, compressed, steps: 0, points: 0 })
    }

    /// Continues a file in its last committed state, after the snapshots up to and including `time`; later ones are
    /// dropped. A file that cannot be read is set aside with a warning, and a new one is begun. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn resume(
        path: &Path,
        time: f64,
        head: Head<'_>,
        format: &SnapshotFormat,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        let found = on_root(path, ranks, || {
            let kept = continue_or_create(
                path,
                |found| cut_after(path, time, format, found),
                || Ok(Kept::default()),
            )?;
            match kept.steps {
                0 => create(path, head, format)?,
                _ => metadata_copy::commit(path, &point_tables(format))?,
            }
            let compressed = SerialFile::open(path)?.is_compressed(POINTS)?;
            Ok([kept.steps, kept.points, u64::from(compressed)])
        })?;
        // Only rank 0 has counted: the sum makes the result known to all ranks.
        let mut counts = found.unwrap_or_default().map(|count| count as i64);
        ranks.sum_integers(&mut counts);
        let [steps, points, compressed] = counts.map(|count| count as u64);
        let (path, format) = (path.to_owned(), format.clone());
        // A file that was begun with another setting keeps it.
        Ok(Self { path, format, compressed: compressed == 1, steps, points })
    }

    /// Contents and format of the snapshots.
    pub fn format(&self) -> &SnapshotFormat {
        &self.format
    }

    /// Adds the particles at a time: the shares of all ranks, in any order, with the values of each further column in
    /// the same order. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn append(
        &mut self,
        time: f64,
        particles: &(impl Records<ParticleRecord> + ?Sized),
        columns: &[Vec<f64>],
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        let block = sort_by_id(particles, |particle| [particle.id, 0], ranks);
        let (begin, count) = (first_row(self.points, self.compressed), block.total);
        let first = begin + block.offset;
        let vectors = |get: fn(&ParticleRecord) -> &[f64; 3]| -> Vec<f64> {
            block.rows.iter().flat_map(get).copied().collect()
        };
        let ids: Vec<i64> = block.rows.iter().map(|particle| particle.id as i64).collect();
        let radii: Vec<f64> = block.rows.iter().map(|particle| particle.radius).collect();
        let file = match self.compressed {
            true => SharedFile::open_to_write_on_root(&self.path, ranks)?,
            false => SharedFile::open_to_write(&self.path, ranks)?,
        };
        let tables = point_tables(&self.format);
        tables.iter().try_for_each(|name| file.grow(name, begin + count))?;
        file.write_rows(POINTS, first, &vectors(|particle| &particle.position))?;
        file.write_rows(&point_data("id"), first, &ids)?;
        let velocities = vectors(|particle| &particle.velocity);
        file.write_rows(&point_data("velocity"), first, &velocities)?;
        let spins = vectors(|particle| &particle.angular_velocity);
        file.write_rows(&point_data("angular_velocity"), first, &spins)?;
        file.write_rows(&point_data("radius"), first, &radii)?;
        for (column, values) in self.format.columns.iter().zip(columns) {
            let ids = (0..particles.count()).map(|index| particles.at(index).id);
            let sorted = sort_numbers_by_id(ids, values, column.width, ranks);
            file.write_rows(&point_data(column.name), first, &sorted.rows)?;
        }
        file.close()?;
        let (path, rows) = (&self.path, SnapshotRows { step: self.steps, first: begin, count });
        on_root(path, ranks, || append_step(path, time, rows, &self.format))?;
        self.steps += 1;
        self.points = begin + count;
        Ok(())
    }
}

/// The row at which a snapshot begins after a number of rows. Compressed chunks are written once and never moved, so
/// that a snapshot begins with a chunk of its own.
fn first_row(rows: u64, compressed: bool) -> u64 {
    if compressed { rows.next_multiple_of(POINT_PIECE as u64) } else { rows }
}

impl Output for ParticleSnapshots {
    fn write(
        &mut self,
        sample: &mut Sample<'_>,
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        self.append(sample.measures.time, sample.particles, sample.columns, ranks)
    }

    fn commit(&self, ranks: &dyn Communicator) -> Result<(), OutputError> {
        metadata_copy::commit_on_root(&self.path, &point_tables(&self.format), ranks)
    }
}

fn point_data(name: &str) -> String {
    format!("/VTKHDF/PointData/{name}")
}

/// Names of the datasets with a row for each particle at each time, except for the positions.
fn names(format: &SnapshotFormat) -> impl Iterator<Item = &'static str> {
    POINT_DATA.into_iter().chain(format.columns.iter().map(|column| column.name))
}

/// Paths of the datasets with a row for each particle at each time.
fn point_tables(format: &SnapshotFormat) -> Vec<String> {
    std::iter::once(POINTS.to_owned()).chain(names(format).map(point_data)).collect()
}

/// Paths of the datasets with one row for each time, one integer wide.
fn step_tables(format: &SnapshotFormat) -> Vec<String> {
    let steps = STEP_INTEGERS.iter().map(|name| format!("/VTKHDF/Steps/{name}"));
    let data = names(format).map(|name| format!("/VTKHDF/Steps/PointDataOffsets/{name}"));
    let cells = CELLS.iter().flat_map(|kind| {
        ["NumberOfCells", "NumberOfConnectivityIds", "Offsets"]
            .map(|name| format!("/VTKHDF/{kind}/{name}"))
    });
    let cells = cells.filter(|name| name != VERTEX_ENDS);
    let number = std::iter::once("/VTKHDF/NumberOfPoints".to_owned());
    steps.chain(data).chain(cells).chain(number).collect()
}

/// Paths of the datasets that grow.
fn tables(format: &SnapshotFormat) -> Vec<String> {
    let wider = ["CellOffsets", "ConnectivityIdOffsets", "Values"];
    let wider = wider.map(|name| format!("/VTKHDF/Steps/{name}"));
    let vertices = [VERTEX_ENDS, VERTEX_POINTS].map(str::to_owned);
    [point_tables(format), step_tables(format), wider.to_vec(), vertices.to_vec()].concat()
}

fn create(path: &Path, head: Head<'_>, format: &SnapshotFormat) -> MessageResult<()> {
    metadata_copy::create(path, &point_tables(format), |path| make(path, head, format))
}

fn make(path: &Path, head: Head<'_>, format: &SnapshotFormat) -> MessageResult<()> {
    let file = SerialFile::create(path)?;
    for group in ["/VTKHDF", "/VTKHDF/PointData", "/VTKHDF/Steps", "/VTKHDF/Steps/PointDataOffsets"]
    {
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
    make_point_tables(&file, &head.units(), format)?;
    make_step_tables(&file, &head.units(), format)?;
    file.close()
}

fn make_point_tables(
    file: &SerialFile,
    units: &ColumnUnits,
    format: &SnapshotFormat,
) -> MessageResult<()> {
    let make = |name: &str, is_whole, (width, unit, description)| {
        let head = TableHead { name, width, unit, description };
        match is_whole {
            true => file.make_table::<i64>(&head, format.storage.rows(POINT_PIECE)),
            false => format.storage.make_numbers(file, &head, &[], POINT_PIECE),
        }
    };
    let places = "centres, of one time after another, sorted by id";
    make(POINTS, false, (3, units.length, places))?;
    let always = [
        ("velocity", (3, units.speed, "velocities of the centres")),
        ("angular_velocity", (3, units.angular_speed, "angular velocities")),
        ("radius", (1, units.length, "radii")),
    ];
    for (name, what) in always {
        make(&point_data(name), false, what)?;
    }
    make(&point_data("id"), true, (1, "1", "global ids, ascending at each time"))?;
    format.columns.iter().try_for_each(|column| {
        let what = (column.width, column.unit, column.description);
        make(&point_data(column.name), column.is_whole, what)
    })
}

fn make_step_tables(
    file: &SerialFile,
    units: &ColumnUnits,
    format: &SnapshotFormat,
) -> MessageResult<()> {
    let rows = Rows::Growing(STEP_PIECE);
    let head = TableHead {
        name: "/VTKHDF/Steps/Values",
        width: 1,
        unit: units.time,
        description: "times of the snapshots",
    };
    file.make_table::<f64>(&head, rows)?;
    let integers = |name: &str, width, description: &str, rows| {
        file.make_table::<i64>(&TableHead { name, width, unit: "1", description }, rows)
    };
    CELLS.iter().try_for_each(|kind| file.make_group(&format!("/VTKHDF/{kind}")))?;
    for name in step_tables(format) {
        integers(&name, 1, "index of VTKHDF, one for each time", rows)?;
    }
    for name in CELL_OFFSETS {
        let description = "index of VTKHDF, for each time and kind of cells";
        integers(&format!("/VTKHDF/Steps/{name}"), CELLS.len(), description, rows)?;
    }
    for kind in &CELLS[1..] {
        let name = format!("/VTKHDF/{kind}/Connectivity");
        integers(&name, 1, "points of cells: there are none", rows)?;
    }
    let description = "points of the vertex of each snapshot: 0, 1, 2, ...";
    integers(VERTEX_POINTS, 1, description, Rows::Growing(POINT_PIECE))?;
    integers(VERTEX_ENDS, 1, "for each snapshot 0 and the number of its points", rows)
}

/// Turns existing rows into a snapshot.
fn append_step(
    path: &Path,
    time: f64,
    rows: SnapshotRows,
    format: &SnapshotFormat,
) -> MessageResult<()> {
    let SnapshotRows { step, first, count } = rows;
    let file = SerialFile::open_to_change(path)?;
    file.append("/VTKHDF/Steps/Values", &[time])?;
    for name in step_tables(format) {
        let value = match name.rsplit('/').next() {
            Some("PartOffsets") => step,
            Some("NumberOfParts") => 1,
            Some("NumberOfPoints") => count,
            Some("PointOffsets") => first,
            Some("NumberOfCells") if name.contains(CELLS[0]) => 1,
            Some("NumberOfConnectivityIds") if name.contains(CELLS[0]) => count,
            _ if name.contains("PointDataOffsets") => first,
            _ => 0,
        };
        file.append(&name, &[value as i64])?;
    }
    file.append("/VTKHDF/Steps/CellOffsets", &[step as i64, 0, 0, 0])?;
    file.append("/VTKHDF/Steps/ConnectivityIdOffsets", &[0_i64; CELLS.len()])?;
    file.append(VERTEX_ENDS, &[0, count as i64])?;
    let (listed, _) = file.shape(VERTEX_POINTS)?;
    if listed < count {
        let further: Vec<i64> = (listed..count).map(|point| point as i64).collect();
        file.append(VERTEX_POINTS, &further)?;
    }
    file.set_number("/VTKHDF/Steps", "NSteps", step as i64 + 1)?;
    file.close()
}

/// The parts of a continued file that are kept.
#[derive(Clone, Copy, Default)]
struct Kept {
    /// Number of snapshots.
    steps: u64,
    /// Number of rows up to the end of the last one.
    points: u64,
    /// Number of particles of the largest one.
    most: u64,
}

/// Drops the snapshots after a time.
fn cut_after(
    path: &Path,
    time: f64,
    format: &SnapshotFormat,
    found_length: u64,
) -> Result<Kept, Obstacle> {
    metadata_copy::restore(path).map_err(Obstacle::Failed)?;
    let kept = rows_to_keep(path, time, format, found_length).map_err(Obstacle::Unusable)?;
    if kept.steps > 0 {
        cut(path, kept, format).map_err(Obstacle::Failed)?;
    }
    Ok(kept)
}

fn rows_to_keep(
    path: &Path,
    time: f64,
    format: &SnapshotFormat,
    found_length: u64,
) -> MessageResult<Kept> {
    let file = SerialFile::open(path)?;
    let shown = file.names("/VTKHDF/PointData")?;
    if let Some(other) = shown.iter().find(|name| names(format).all(|wanted| wanted != *name)) {
        return Err(format!("it shows {other}, which the case no longer asks for"));
    }
    let listed: i64 = file.number("/VTKHDF/Steps", "NSteps")?;
    let times: Vec<f64> = file.read("/VTKHDF/Steps/Values")?;
    let (firsts, counts) = snapshot_rows(&file)?;
    let compressed = file.is_compressed(POINTS)?;
    let listed = times.len().min(listed.max(0) as usize);
    let steps = rows_up_to(&times[..listed], time)?;
    let damaged = "its numbers of particles are damaged";
    let mut kept = Kept { steps: steps as u64, ..Kept::default() };
    for step in 0..steps {
        let (Some(&first), Some(&count)) = (firsts.get(step), counts.get(step)) else {
            return Err(damaged.to_owned());
        };
        let is_next = first == first_row(kept.points, compressed);
        kept.points = first.checked_add(count).filter(|_| is_next).ok_or(damaged)?;
        kept.most = kept.most.max(count);
    }
    for (name, rows) in rows_of_tables(kept, format) {
        metadata_copy::require_rows(&file, &name, rows, found_length)?;
    }
    file.close()?;
    Ok(kept)
}

/// The first row of each snapshot, and the number of its rows.
pub(super) fn snapshot_rows(file: &SerialFile) -> MessageResult<(Vec<u64>, Vec<u64>)> {
    let read = |name| -> MessageResult<Vec<u64>> {
        let numbers: Vec<i64> = file.read(name)?;
        let number = |&number: &i64| u64::try_from(number);
        let numbers: Result<_, _> = numbers.iter().map(number).collect();
        numbers.map_err(|_| "its numbers of particles are damaged".to_owned())
    };
    Ok((read("/VTKHDF/Steps/PointOffsets")?, read("/VTKHDF/NumberOfPoints")?))
}

/// Each table with its number of rows.
fn rows_of_tables(kept: Kept, format: &SnapshotFormat) -> impl Iterator<Item = (String, u64)> {
    let Kept { steps, points, most } = kept;
    let of_points = point_tables(format);
    tables(format).into_iter().map(move |name| {
        let rows = match name.as_str() {
            VERTEX_ENDS => 2 * steps,
            VERTEX_POINTS => most,
            _ if of_points.contains(&name) => points,
            _ => steps,
        };
        (name, rows)
    })
}

fn cut(path: &Path, kept: Kept, format: &SnapshotFormat) -> MessageResult<()> {
    let file = SerialFile::open_to_change(path)?;
    let compressed = file.is_compressed(POINTS)?;
    let of_points = point_tables(format);
    for (name, rows) in rows_of_tables(kept, format) {
        // A truncated chunk would be written again, and moved.
        let whole = compressed && of_points.contains(&name);
        let rows = if whole { first_row(rows, true).min(file.shape(&name)?.0) } else { rows };
        file.cut(&name, rows)?;
    }
    file.set_number("/VTKHDF/Steps", "NSteps", kept.steps as i64)?;
    file.close()
}
