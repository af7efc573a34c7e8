//! The gas at chosen times for ParaView: `gas.vtkhdf`, fields on the cells of the box.
//!
//! Rank 0 writes the data sent by the others: fields are small compared with the particles.

use std::path::Path;
use std::slice::from_ref;

use super::vtkhdf::{Dataset, ImageCells, Numbers, RecordColumn, Writer, image_table, numbers_in};
use super::{Head, Output, OutputError, OutputKind, Sample, SnapshotStorage};
use talcum_engine::fields::{Column, Unit};
use talcum_engine::grid::BoxGrid;
use talcum_engine::parallel::{CellSample, Communicator, records_of_bytes, sort_by_id};

static FIELDS: [RecordColumn<CellSample>; 4] = [
    Column::with(
        "CellData/pressure",
        Unit::Pressure,
        &[],
        "pressure of the gas less its hydrostatic head",
        |cell| from_ref(&cell.pressure),
    ),
    Column::with(
        "CellData/velocity",
        Unit::Speed,
        &[3],
        "velocity of the gas between the particles, mean of a cell's faces",
        |cell| &cell.velocity,
    ),
    Column::with(
        "CellData/voidage",
        Unit::One,
        &[],
        "volume of gas per open volume; 0 in cells outside of a round column",
        |cell| from_ref(&cell.voidage),
    ),
    Column::with(
        "CellData/solids_velocity",
        Unit::Speed,
        &[3],
        "mean velocity of the solids by volume; 0 where there are none",
        |cell| &cell.solids_velocity,
    ),
];

/// The file of snapshots of the gas. Its records contain pressure, velocity of the gas, voidage and velocity of the
/// solids.
#[derive(Clone, Debug)]
pub struct GasSnapshots(Writer);

impl GasSnapshots {
    /// In the list of outputs; nothing for a case without a volume-averaged gas.
    pub const KIND: OutputKind = OutputKind {
        file_name: "gas.vtkhdf",
        needs_momentum_before: false,
        open: |path, opening, ranks| {
            let Some(grid) = opening.gas_grid else { return Ok(None) };
            let fields = (grid, opening.snapshots.storage);
            let snapshots = Self::open(path, fields, opening.head, opening.continue_after, ranks)?;
            Ok(Some(Box::new(snapshots)))
        },
    };

    /// Begins a file, replacing any existing one; or continues a file in its last committed state, after the snapshots up to
    /// and including a time; later ones are dropped. A file that cannot be read is set aside with a warning, and a new one is
    /// begun. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn open(
        path: &Path,
        (grid, storage): (&BoxGrid, SnapshotStorage),
        head: Head<'_>,
        continue_after: Option<f64>,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        let (spacing, counts) = (grid.spacing().into(), grid.counts());
        let cells = ImageCells { origin: [0.0; 3], spacing, counts };
        let units = head.units();
        let fields = FIELDS.iter().map(|field| Dataset::of_column("", field, Numbers::Real, units));
        let table = image_table(cells, fields, storage, units);
        Writer::open(path, table, head, continue_after, ranks).map(Self)
    }

    /// Adds the gas at a time: the cells of all ranks, in any order. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn append(
        &mut self,
        time: f64,
        cells: &[CellSample],
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        let sorted = sort_by_id(cells, |record| [record.cell, 0], ranks).rows;
        let bytes =
            ranks.gather_to_root(bytemuck::cast_slice(&sorted)).unwrap_or_default().concat();
        let all: Vec<CellSample> = records_of_bytes(&bytes).collect();
        let rows = FIELDS.iter().map(|field| (&*field.name, numbers_in(field, &all)));
        self.0.append_on_root(time, ranks, rows)
    }
}

impl Output for GasSnapshots {
    fn write(
        &mut self,
        sample: &mut Sample<'_>,
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        let Some(cells) = (sample.gas_cells)() else { return Ok(()) };
        self.append(sample.row.time, &cells, ranks)
    }

    fn commit(&self, ranks: &dyn Communicator) -> Result<(), OutputError> {
        self.0.commit(ranks)
    }
}
