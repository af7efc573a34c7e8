//! What every measure can do.

use super::layout::{Layout, Rows};
use super::stored::Stored;
use super::view::View;
use crate::domain::Bounds;
use crate::grid::{BoxGrid, ColumnGrid};
use crate::parallel::Communicator;
use crate::state::SizeRange;
use bytemuck::{Pod, Zeroable};

/// What a measure is begun for.
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

/// What must be made ready before a measure looks.
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
    /// What either of two needs.
    pub fn or(self, other: Self) -> Self {
        Self {
            contact_forces: self.contact_forces || other.contact_forces,
            series: self.series || other.series,
            gas_cells: self.gas_cells || other.gas_cells,
        }
    }
}

/// A measure in a run: looks at the state now and then, and never changes it. What it finds is the same bits on any
/// number of ranks.
///
/// Its accumulators go into checkpoints: [`Measure::stored`] on some ranks, then [`Measure::restore`] on as many or
/// others, makes a measure that continues with the same bits.
pub trait Measure {
    /// What stands in its files.
    fn layout(&self) -> Layout;

    /// What must be ready before it looks.
    fn needs(&self) -> Needs {
        Needs::default()
    }

    /// Looks at the run; returns what is to be written now. Collective.
    fn look(&mut self, view: &View<'_>, ranks: &dyn Communicator) -> Findings;

    /// The agglomerate of each of this rank's particles as of the last sample, by their ids; `None` if the measure does not
    /// know agglomerates. Collective.
    fn agglomerates(&self, _: &[u64], _: &dyn Communicator) -> Option<Vec<Option<u64>>> {
        None
    }

    /// What must be kept to resume later. Collective.
    fn stored(&self, ranks: &dyn Communicator) -> Stored;

    /// Continues from what was kept by a measure of the same settings; `None` if something is missing in it. Collective.
    fn restore(&mut self, stored: &Stored, ranks: &dyn Communicator) -> Option<()>;
}

/// What a sample found, to be written.
#[derive(Clone, Debug, Default)]
pub struct Findings {
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
    /// Centre of the lower, inside of the box.
    pub start: [f64; 3],
    /// Centre of the higher, in the image that it is touched in.
    pub end: [f64; 3],
    /// Normal force, cohesion left out; positive if it pushes the two apart.
    pub normal_force: f64,
    /// Magnitude of the cohesive force.
    pub cohesive_force: f64,
    /// Tangential force on the higher.
    pub tangential_force: [f64; 3],
    /// Overlap.
    pub overlap: f64,
    /// Time since the first sample at which they touched.
    pub age: f64,
}
