//! Fields on equal cells at chosen times for ParaView: temporal ImageData of VTKHDF 2.0, written by rank 0.
//!
//! Cell data have the shape (times, z, y, x), components last. Data are written first, then the entries that make them
//! a time step; the file is closed after each step, so that a kill between two steps leaves an intact file.

use std::path::Path;

use super::hdf5_file::SerialFile;
use super::output_file::{Obstacle, rows_up_to};
use super::table::{Rows, TableHead};
use super::{Head, MessageResult, SnapshotStorage, metadata_copy};

/// Number of rows of steps that are stored in one chunk.
const STEP_PIECE: usize = 256;

/// A field of an image.
#[derive(Clone, Debug)]
pub(super) struct ImageField<'a> {
    pub(super) name: &'a str,
    /// 1, 3, or 9.
    pub(super) components: usize,
    pub(super) unit: &'a str,
    pub(super) description: &'a str,
}

/// The cells of an image.
#[derive(Clone, Copy, Debug)]
pub(super) struct ImageCells {
    pub(super) origin: [f64; 3],
    pub(super) spacing: [f64; 3],
    /// Number of cells along x, y and z.
    pub(super) counts: [usize; 3],
}

fn data(name: &str) -> String {
    format!("/VTKHDF/CellData/{name}")
}

fn offsets(name: &str) -> String {
    format!("/VTKHDF/Steps/CellDataOffsets/{name}")
}

/// Paths of the datasets that grow.
pub(super) fn tables<'a>(names: impl IntoIterator<Item = &'a str>) -> Vec<String> {
    let of_fields = names.into_iter().flat_map(|name| [data(name), offsets(name)]);
    of_fields.chain(["/VTKHDF/Steps/Values".to_owned()]).collect()
}

/// The tables of the numbers of cells, which are not copied at checkpoints.
pub(super) fn bulk(tables: &[String]) -> Vec<String> {
    tables.iter().filter(|name| name.starts_with(&data(""))).cloned().collect()
}

/// Begins a file.
pub(super) fn create(
    path: &Path,
    cells: &ImageCells,
    fields: &[ImageField<'_>],
    storage: SnapshotStorage,
    head: Head<'_>,
) -> MessageResult<()> {
    let tables = tables(fields.iter().map(|field| field.name));
    metadata_copy::create(path, &bulk(&tables), |path| make(path, cells, (fields, storage), head))
}

fn make(
    path: &Path,
    cells: &ImageCells,
    fields: (&[ImageField<'_>], SnapshotStorage),
    head: Head<'_>,
) -> MessageResult<()> {
    let file = SerialFile::create(path)?;
    for group in ["/VTKHDF", "/VTKHDF/CellData", "/VTKHDF/Steps", "/VTKHDF/Steps/CellDataOffsets"] {
        file.make_group(group)?;
    }
    let [nx, ny, nz] = cells.counts;
    file.set_numbers("/VTKHDF", "Version", &[2_i64, 0])?;
    file.set_format_name("/VTKHDF", "Type", b"ImageData")?;
    let extent = [0, nx as i64, 0, ny as i64, 0, nz as i64];
    file.set_numbers("/VTKHDF", "WholeExtent", &extent)?;
    file.set_numbers("/VTKHDF", "Origin", &cells.origin)?;
    file.set_numbers("/VTKHDF", "Spacing", &cells.spacing)?;
    file.set_numbers("/VTKHDF", "Direction", &[1.0_f64, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0])?;
    file.set_number("/VTKHDF/Steps", "NSteps", 0_i64)?;
    file.make_group("/talcum")?;
    for (name, entry) in head.provenance.entries() {
        file.set_text("/talcum", name, &entry)?;
    }
    file.set_text("/talcum", "case", head.case_text)?;
    make_tables(&file, [nz, ny, nx], fields, head)?;
    file.close()
}

fn make_tables(
    file: &SerialFile,
    shape: [usize; 3],
    (fields, storage): (&[ImageField<'_>], SnapshotStorage),
    head: Head<'_>,
) -> MessageResult<()> {
    for &ImageField { name, components: width, unit, description } in fields {
        let path = data(name);
        let blocks = TableHead { name: &path, width, unit, description };
        storage.make_numbers(file, &blocks, &shape, 1)?;
        let path = offsets(name);
        let description = "index of VTKHDF, one for each time";
        let index = TableHead { name: &path, width: 1, unit: "1", description };
        file.make_table::<i64>(&index, Rows::Growing(STEP_PIECE))?;
    }
    let (name, description) = ("/VTKHDF/Steps/Values", "times of the snapshots");
    let times = TableHead { name, width: 1, unit: head.units().time, description };
    file.make_table::<f64>(&times, Rows::Growing(STEP_PIECE))
}

/// Adds the fields at a time: the values of each field, cell by cell.
pub(super) fn append<'a>(
    path: &Path,
    time: f64,
    fields: impl IntoIterator<Item = (&'a str, Vec<f64>)>,
) -> MessageResult<()> {
    let file = SerialFile::open_to_change(path)?;
    let step: i64 = file.number("/VTKHDF/Steps", "NSteps")?;
    for (name, numbers) in fields {
        file.append(&data(name), &numbers)?;
        file.append(&offsets(name), &[step])?;
    }
    file.append("/VTKHDF/Steps/Values", &[time])?;
    file.set_number("/VTKHDF/Steps", "NSteps", step + 1)?;
    file.close()
}

/// Drops the snapshots after a time; returns how many are left. If none are left, the file is unchanged: a new one
/// replaces it.
pub(super) fn cut_after(
    path: &Path,
    time: f64,
    tables: &[String],
    found_length: u64,
) -> Result<u64, Obstacle> {
    metadata_copy::restore(path).map_err(Obstacle::Failed)?;
    let steps = steps_to_keep(path, time, tables, found_length).map_err(Obstacle::Unusable)?;
    if steps > 0 {
        cut(path, steps, tables).map_err(Obstacle::Failed)?;
    }
    Ok(steps)
}

fn steps_to_keep(
    path: &Path,
    time: f64,
    tables: &[String],
    found_length: u64,
) -> MessageResult<u64> {
    let file = SerialFile::open(path)?;
    let listed: i64 = file.number("/VTKHDF/Steps", "NSteps")?;
    let times: Vec<f64> = file.read("/VTKHDF/Steps/Values")?;
    let listed = times.len().min(listed.max(0) as usize);
    let steps = rows_up_to(&times[..listed], time)? as u64;
    let require = |name: &String| metadata_copy::require_rows(&file, name, steps, found_length);
    tables.iter().try_for_each(require)?;
    for name in tables.iter().filter(|name| name.starts_with(&offsets(""))) {
        let listed = file.read_rows::<i64>(name, 0, steps)?;
        if !listed.into_iter().eq(0..steps as i64) {
            return Err(format!("{name} is damaged"));
        }
    }
    file.close()?;
    Ok(steps)
}

fn cut(path: &Path, steps: u64, tables: &[String]) -> MessageResult<()> {
    let file = SerialFile::open_to_change(path)?;
    tables.iter().try_for_each(|name| file.cut(name, steps))?;
    file.set_number("/VTKHDF/Steps", "NSteps", steps as i64)?;
    file.close()
}
