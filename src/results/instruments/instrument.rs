//! The interface of all instruments.

use super::layout::{Layout, Rows};
use super::stored::Stored;
use super::view::View;
use bytemuck::{Pod, Zeroable};
use talcum_engine::domain::Bounds;
use talcum_engine::grid::{BoxGrid, ColumnGrid};
use talcum_engine::parallel::Communicator;
use talcum_engine::state::SizeRange;

/// Data of the run for which an instrument is begun.
#[derive(Clone, Copy, Debug)]
pub struct Setting<'a> {
    /// The box.
    pub bounds: &'a Bounds,
    /// Sizes of the particles at the start of the run.
    pub sizes: &'a SizeRange,
    /// The grid of the profiles over height.
    pub column: &'a ColumnGrid,
    /// The cells of a volume-averaged gas, if the case has one.
    pub gas_grid: Option<&'a BoxGrid>,
    /// Interval of the samples.
    pub every: f64,
    /// Time of the first sample.
    pub start: f64,
}

/// Data that must be prepared before an instrument takes a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// Forces of contacts.
    pub contact_forces: bool,
    /// The numbers of the series, and the bed over height.
    pub series: bool,
    /// The volume-averaged gas on its cells.
    pub gas_cells: bool,
}

impl Needs {
    /// The data that either of two instruments needs.
    pub fn or(self, other: Self) -> Self {
        Self {
            contact_forces: self.contact_forces || other.contact_forces,
            series: self.series || other.series,
            gas_cells: self.gas_cells || other.gas_cells,
        }
    }
}

/// An instrument in a run: it samples the state at intervals, and never changes it. Its results have the same bits on any
/// number of ranks.
///
/// Its accumulators are stored in checkpoints: [`Instrument::stored`] on some ranks, then [`Instrument::restore`] on as many
/// or others, gives an instrument that continues with the same bits.
pub trait Instrument {
    /// The contents of its files.
    fn layout(&self) -> Layout;

    /// Data that must be prepared before it takes a sample.
    fn needs(&self) -> Needs {
        Needs::default()
    }

    /// Takes a sample of the run; returns the results to be written now. Collective.
    fn look(&mut self, view: &View<'_>, ranks: &dyn Communicator) -> Readings;

    /// The agglomerate of each of this rank's particles at the last sample, by their ids; `None` if the instrument does
    /// not find agglomerates. Collective.
    fn agglomerates(&self, _: &[u64], _: &dyn Communicator) -> Option<Vec<Option<u64>>> {
        None
    }

    /// Data that must be stored to resume later. Collective.
    fn stored(&self, ranks: &dyn Communicator) -> Stored;

    /// Continues from the stored data of an instrument with the same settings; `None` if they are incomplete. Collective.
    fn restore(&mut self, stored: &Stored, ranks: &dyn Communicator) -> Option<()>;
}

/// Results of a sample, to be written.
#[derive(Clone, Debug, Default)]
pub struct Readings {
    /// Rows of tables.
    pub rows: Vec<Rows>,
    /// Fields on cells: a record for each cell that this rank knows, in any order.
    pub cells: Option<Vec<CellValues>>,
    /// Lines from particle to particle, each on one rank, in any order.
    pub lines: Option<Vec<ContactLine>>,
}

/// The values of the fields of an image in one cell, one field after another.
#[derive(Clone, Debug, PartialEq)]
pub struct CellValues {
    /// Number of the cell, x fastest, then y, then z.
    pub cell: u64,
    /// The values.
    pub values: Vec<f64>,
}

/// A contact as a line.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ContactLine {
    /// The lower id of the pair.
    pub lower: u64,
    /// The higher id of the pair.
    pub higher: u64,
    /// Centre of the particle with the lower id, inside the box.
    pub start: [f64; 3],
    /// Centre of the particle with the higher id, in the image in which it is touched.
    pub end: [f64; 3],
    /// Normal force without cohesion; positive if it pushes the two apart.
    pub normal_force: f64,
    /// Magnitude of the cohesive force.
    pub cohesive_force: f64,
    /// Tangential force on the particle with the higher id.
    pub tangential_force: [f64; 3],
    /// Overlap.
    pub overlap: f64,
    /// Time since the first sample at which they touched.
    pub age: f64,
}
