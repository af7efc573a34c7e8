//! When a measure looks at the bed.

use super::MeasureKind;

/// One measure of a case: its name, its times and its settings.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasurePlan {
    /// What the case calls it.
    pub name: String,
    /// Interval of its looks; time.
    pub every: f64,
    /// Time of the first look.
    pub start: f64,
    /// What it measures.
    pub kind: MeasureKind,
}

impl MeasurePlan {
    /// Names of its files in the folder of results: the table, and the fields or lines for ParaView.
    pub fn file_names(&self) -> [String; 2] {
        [format!("measure-{}.h5", self.name), format!("measure-{}.vtkhdf", self.name)]
    }

    /// Its settings as text. A file, or a stored measure, with other settings cannot be continued.
    pub fn settings(&self) -> String {
        format!("every {:?} from {:?}: {:?}", self.every, self.start, self.kind)
    }
}
