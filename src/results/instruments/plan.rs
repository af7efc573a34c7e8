//! Times at which an instrument takes samples.

use super::{InstrumentKind, Setting};
use talcum_engine::domain::Bounds;
use talcum_engine::grid::{BoxGrid, ColumnGrid};
use talcum_engine::state::SizeRange;

/// One instrument of a case: its name, its times and its settings.
#[derive(Clone, Debug, PartialEq)]
pub struct InstrumentPlan {
    /// Its name in the case.
    pub name: String,
    /// Interval of its samples; time.
    pub every: f64,
    /// Time of the first sample.
    pub start: f64,
    /// Its kind, with settings.
    pub kind: InstrumentKind,
}

impl InstrumentPlan {
    /// Names of its files in the folder of results: the table, and the fields or lines for ParaView.
    pub fn file_names(&self) -> [String; 2] {
        [table_file_name(&self.name), format!("measure-{}.vtkhdf", self.name)]
    }

    /// Names of the columns of its table `results` with one number in a row.
    pub fn scalar_names(&self, bounds: &Bounds, gas_grid: Option<&BoxGrid>) -> Vec<String> {
        // Sizes and heights determine the length of arrays, not the columns.
        let height = bounds.lengths().z;
        let sizes =
            &SizeRange { smallest_diameter: height, largest_diameter: height, largest_mass: 1.0 };
        let column = &ColumnGrid::new(bounds, height, 1.0);
        let Self { every, start, .. } = *self;
        let setting = Setting { bounds, sizes, column, gas_grid, every, start };
        self.kind.begin(&setting).layout().scalars().map(|column| column.name.to_string()).collect()
    }

    /// Its settings as text. A file, or a stored instrument, with other settings cannot be continued.
    pub fn settings(&self) -> String {
        format!("every {:?} from {:?}: {:?}", self.every, self.start, self.kind)
    }
}

/// Name of the table file of an instrument in the folder of results.
pub fn table_file_name(instrument: &str) -> String {
    format!("measure-{instrument}.h5")
}
