//! The gas at chosen times for ParaView: `gas.vtkhdf`, temporal ImageData of VTKHDF 2.0.
//!
//! Cell data of shape (times, z, y, x), components last. Rank 0 writes what the others send: fields are small
//! beside the particles. Data are written first, then what makes them a time step; the file is closed after
//! each, so that a kill between two steps leaves a whole file.

use std::path::{Path, PathBuf};
use std::slice::from_ref;

use super::hdf5_file::SerialFile;
use super::output_file::{Obstacle, continue_or_create, rows_up_to};
use super::table::{Rows, TableHead};
use super::{
    ColumnUnits, Head, MessageResult, OpenedOutput, Opening, Output, OutputError, OutputKind,
    Sample, metadata_copy, on_root,
};
use crate::grid::BoxGrid;
use crate::parallel::{CellSample, Communicator, sort_by_id};

/// A field of the snapshots.
struct SampledField {
    name: &'static str,
    components: usize,
    of: fn(&CellSample) -> &[f64],
}

const FIELDS: [SampledField; 4] = [
    SampledField { name: "pressure", components: 1, of: |cell| from_ref(&cell.pressure) },
    SampledField { name: "velocity", components: 3, of: |cell| &cell.velocity },
    SampledField { name: "voidage", components: 1, of: |cell| from_ref(&cell.voidage) },
    SampledField { name: "solids_velocity", components: 3, of: |cell| &cell.solids_velocity },
];
/// Rows of steps that are stored as one piece.
const STEP_PIECE: usize = 256;

/// The file of snapshots of the gas. Their records hold pressure, velocity of the gas, voidage and velocity of
/// the solids.
#[derive(Clone, Debug)]
pub struct GasSnapshots {
    path: PathBuf,
}

impl GasSnapshots {
    /// In the list of outputs.
    pub const KIND: OutputKind =
        OutputKind { file_name: "gas.vtkhdf", needs_momentum_before: false, open: Self::open };

    /// Nothing for a case without a volume-averaged gas.
    fn open(path: &Path, opening: &Opening<'_>, ranks: &dyn Communicator) -> OpenedOutput {
        let Some(grid) = opening.gas_grid else { return Ok(None) };
        let snapshots = match opening.continue_after {
            Some(time) => Self::resume(path, time, grid, opening.head, ranks)?,
            None => Self::create(path, grid, opening.head, ranks)?,
        };
        Ok(Some(Box::new(snapshots)))
    }

    /// Begins a file, in the place of one that is there. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn create(
        path: &Path,
        grid: &BoxGrid,
        head: Head<'_>,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        on_root(path, ranks, || create(path, grid, head))?;
        Ok(Self { path: path.to_owned() })
    }

    /// Continues a file as it was last committed, after the snapshots up to and including `time`; later ones are
    /// dropped. A file that cannot be read is set aside with a warning, and a new one begun. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn resume(
        path: &Path,
        time: f64,
        grid: &BoxGrid,
        head: Head<'_>,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        on_root(path, ranks, || {
            let kept = continue_or_create(path, || cut_after(path, time), || Ok(0))?;
            if kept > 0 { metadata_copy::commit(path, &tables()) } else { create(path, grid, head) }
        })?;
        Ok(Self { path: path.to_owned() })
    }

    /// Adds the gas at a time: all ranks' cells, in any order. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn append(
        &self,
        time: f64,
        cells: &[CellSample],
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        let sorted = sort_by_id(cells, |record| [record.cell, 0], ranks).rows;
        let bytes =
            ranks.gather_to_root(bytemuck::cast_slice(&sorted)).unwrap_or_default().concat();
        let all: Vec<CellSample> = crate::parallel::records_of_bytes(&bytes).collect();
        on_root(&self.path, ranks, || append(&self.path, time, &all))?;
        Ok(())
    }
}

impl Output for GasSnapshots {
    fn write(
        &mut self,
        sample: &mut Sample<'_>,
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        let Some(cells) = (sample.gas_cells)() else { return Ok(()) };
        self.append(sample.measures.time, &cells, ranks)
    }

    fn commit(&self, ranks: &dyn Communicator) -> Result<(), OutputError> {
        metadata_copy::commit_on_root(&self.path, &tables(), ranks)
    }
}

/// Paths of the datasets that grow.
fn tables() -> Vec<String> {
    let names = FIELDS.iter().map(|field| field.name);
    let all = names.clone().map(data).chain(names.map(offsets));
    all.chain(std::iter::once("/VTKHDF/Steps/Values".to_owned())).collect()
}

fn data(name: &str) -> String {
    format!("/VTKHDF/CellData/{name}")
}

fn offsets(name: &str) -> String {
    format!("/VTKHDF/Steps/CellDataOffsets/{name}")
}

fn create(path: &Path, grid: &BoxGrid, head: Head<'_>) -> MessageResult<()> {
    metadata_copy::create(path, &tables(), |path| make(path, grid, head))
}

fn make(path: &Path, grid: &BoxGrid, head: Head<'_>) -> MessageResult<()> {
    let file = SerialFile::create(path)?;
    for group in ["/VTKHDF", "/VTKHDF/CellData", "/VTKHDF/Steps", "/VTKHDF/Steps/CellDataOffsets"] {
        file.make_group(group)?;
    }
    let [nx, ny, nz] = grid.counts();
    let extent = [0, nx as i64, 0, ny as i64, 0, nz as i64];
    let spacing: [f64; 3] = grid.spacing().into();
    file.set_numbers("/VTKHDF", "Version", &[2_i64, 0])?;
    file.set_format_name("/VTKHDF", "Type", b"ImageData")?;
    file.set_numbers("/VTKHDF", "WholeExtent", &extent)?;
    file.set_numbers("/VTKHDF", "Origin", &[0.0_f64; 3])?;
    file.set_numbers("/VTKHDF", "Spacing", &spacing)?;
    file.set_numbers("/VTKHDF", "Direction", &[1.0_f64, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0])?;
    file.set_number("/VTKHDF/Steps", "NSteps", 0_i64)?;
    file.make_group("/talcum")?;
    for (name, entry) in head.provenance.entries() {
        file.set_text("/talcum", name, &entry)?;
    }
    file.set_text("/talcum", "case", head.case_text)?;
    make_tables(&file, [nz, ny, nx], &head.units())?;
    file.close()
}

fn make_tables(file: &SerialFile, shape: [usize; 3], units: &ColumnUnits) -> MessageResult<()> {
    let described = [
        (units.pressure, "pressure of the gas less its hydrostatic head"),
        (units.speed, "velocity of the gas between the particles, mean of a cell's faces"),
        ("1", "volume of gas per volume"),
        (units.speed, "mean velocity of the solids by volume; 0 where there are none"),
    ];
    for (SampledField { name, components: width, .. }, (unit, description)) in
        FIELDS.into_iter().zip(described)
    {
        let path = data(name);
        let head = TableHead { name: &path, width, unit, description };
        file.make_blocks::<f64>(&head, &shape)?;
        let path = offsets(name);
        let description = "index of VTKHDF, one for each time";
        let head = TableHead { name: &path, width: 1, unit: "1", description };
        file.make_table::<i64>(&head, Rows::Growing(STEP_PIECE))?;
    }
    let (name, description) = ("/VTKHDF/Steps/Values", "times of the snapshots");
    let head = TableHead { name, width: 1, unit: units.time, description };
    file.make_table::<f64>(&head, Rows::Growing(STEP_PIECE))
}

fn append(path: &Path, time: f64, cells: &[CellSample]) -> MessageResult<()> {
    let file = SerialFile::open_to_change(path)?;
    let step: i64 = file.number("/VTKHDF/Steps", "NSteps")?;
    for SampledField { name, of, .. } in FIELDS {
        let numbers = cells.iter().flat_map(of);
        file.append(&data(name), &numbers.copied().collect::<Vec<f64>>())?;
        file.append(&offsets(name), &[step])?;
    }
    file.append("/VTKHDF/Steps/Values", &[time])?;
    file.set_number("/VTKHDF/Steps", "NSteps", step + 1)?;
    file.close()
}

/// Drops the snapshots after a time.
fn cut_after(path: &Path, time: f64) -> Result<u64, Obstacle> {
    let found_length = metadata_copy::restore(path).map_err(Obstacle::Failed)?;
    let steps = steps_to_keep(path, time, found_length).map_err(Obstacle::Unusable)?;
    if steps > 0 {
        cut(path, steps).map_err(Obstacle::Failed)?;
    }
    Ok(steps)
}

fn steps_to_keep(path: &Path, time: f64, found_length: u64) -> MessageResult<u64> {
    let file = SerialFile::open(path)?;
    let listed: i64 = file.number("/VTKHDF/Steps", "NSteps")?;
    let times: Vec<f64> = file.read("/VTKHDF/Steps/Values")?;
    let listed = times.len().min(listed.max(0) as usize);
    let steps = rows_up_to(&times[..listed], time) as u64;
    let require = |name: &String| metadata_copy::require_rows(&file, name, steps, found_length);
    tables().iter().try_for_each(require)?;
    file.close()?;
    Ok(steps)
}

fn cut(path: &Path, steps: u64) -> MessageResult<()> {
    let file = SerialFile::open_to_change(path)?;
    tables().iter().try_for_each(|name| file.cut(name, steps))?;
    file.set_number("/VTKHDF/Steps", "NSteps", steps as i64)?;
    file.close()
}
