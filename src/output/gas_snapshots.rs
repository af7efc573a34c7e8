//! The gas at chosen times for ParaView: `gas.vtkhdf`, temporal ImageData of VTKHDF 2.0.
//!
//! Rank 0 writes the data sent by the others: fields are small compared with the particles.

use std::path::{Path, PathBuf};
use std::slice::from_ref;

use super::image_file::{ImageCells, ImageField, bulk};
use super::output_file::continue_or_create;
use super::{
    Head, MessageResult, OpenedOutput, Opening, Output, OutputError, OutputKind, Sample,
    SnapshotStorage, image_file, metadata_copy, on_root,
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
/// The file of snapshots of the gas. Its records contain pressure, velocity of the gas, voidage and velocity of the
/// solids.
#[derive(Clone, Debug)]
pub struct GasSnapshots {
    path: PathBuf,
}

impl GasSnapshots {
    /// Entry in the list of outputs.
    pub const KIND: OutputKind =
        OutputKind { file_name: "gas.vtkhdf", needs_momentum_before: false, open: Self::open };

    /// Opens the file; nothing for a case without a volume-averaged gas.
    fn open(path: &Path, opening: &Opening<'_>, ranks: &dyn Communicator) -> OpenedOutput {
        let Some(grid) = opening.gas_grid else { return Ok(None) };
        let storage = opening.snapshots.storage;
        let snapshots = match opening.continue_after {
            Some(time) => Self::resume(path, time, (grid, storage), opening.head, ranks)?,
            None => Self::create(path, (grid, storage), opening.head, ranks)?,
        };
        Ok(Some(Box::new(snapshots)))
    }

    /// Begins a file, replacing any existing one. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn create(
        path: &Path,
        fields: (&BoxGrid, SnapshotStorage),
        head: Head<'_>,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        on_root(path, ranks, || create(path, fields, head))?;
        Ok(Self { path: path.to_owned() })
    }

    /// Continues a file in its last committed state, after the snapshots up to and including `time`; later ones are
    /// dropped. A file that cannot be read is set aside with a warning, and a new one is begun. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn resume(
        path: &Path,
        time: f64,
        fields: (&BoxGrid, SnapshotStorage),
        head: Head<'_>,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        on_root(path, ranks, || {
            let tables = tables();
            let go_on = |found| image_file::cut_after(path, time, &tables, found);
            let kept = continue_or_create(path, go_on, || Ok(0))?;
            if kept > 0 {
                metadata_copy::commit(path, &bulk(&tables))
            } else {
                create(path, fields, head)
            }
        })?;
        Ok(Self { path: path.to_owned() })
    }

    /// Adds the gas at a time: the cells of all ranks, in any order. Collective.
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
        metadata_copy::commit_on_root(&self.path, &bulk(&tables()), ranks)
    }
}

/// Paths of the datasets that grow.
fn tables() -> Vec<String> {
    image_file::tables(FIELDS.iter().map(|field| field.name))
}

fn create(
    path: &Path,
    (grid, storage): (&BoxGrid, SnapshotStorage),
    head: Head<'_>,
) -> MessageResult<()> {
    let units = head.units();
    let described = [
        (units.pressure, "pressure of the gas less its hydrostatic head"),
        (units.speed, "velocity of the gas between the particles, mean of a cell's faces"),
        ("1", "volume of gas per open volume; 0 in cells outside of a round column"),
        (units.speed, "mean velocity of the solids by volume; 0 where there are none"),
    ];
    let fields = FIELDS.iter().zip(described).map(|(field, (unit, description))| ImageField {
        name: field.name,
        components: field.components,
        unit,
        description,
    });
    let (spacing, counts) = (grid.spacing().into(), grid.counts());
    let cells = ImageCells { origin: [0.0; 3], spacing, counts };
    image_file::create(path, &cells, &fields.collect::<Vec<_>>(), storage, head)
}

fn append(path: &Path, time: f64, cells: &[CellSample]) -> MessageResult<()> {
    let numbers = |field: &SampledField| cells.iter().flat_map(field.of).copied().collect();
    image_file::append(path, time, FIELDS.iter().map(|field| (field.name, numbers(field))))
}
