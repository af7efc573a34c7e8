//! The values of the runs of each point, as columns of a table.

use super::replicates::Replicates;
use talcum_engine::fields::Column;
use talcum_results::output::{Cells, TableColumn};

/// The values of a number for the runs of each point.
pub(crate) struct OfPoints<'a> {
    /// Name of the number.
    pub(crate) name: &'a str,
    /// Its unit; empty if it is not known.
    pub(crate) unit: &'a str,
    /// Its values, point by point.
    pub(crate) given: &'a [Vec<f64>],
}

impl OfPoints<'_> {
    /// Mean, standard deviation and both ends of the interval at a level of confidence; if runs may have no
    /// value, also the number of those that gave a value.
    pub(crate) fn columns(&self, may_be_nothing: bool, confidence: f64) -> Vec<TableColumn> {
        let Self { name, unit, given } = *self;
        let replicates: Vec<Option<Replicates>> =
            given.iter().map(|values| Replicates::of(values, confidence)).collect();
        let column = |suffix: &str, about: &str, of: &dyn Fn(&Replicates) -> f64| {
            let values = replicates.iter().map(|found| found.as_ref().map_or(f64::NAN, of));
            Column::numbers(&format!("{name}{suffix}"), unit, about, values.collect())
        };
        let mut columns = vec![
            column("", "mean over the runs", &|e| e.mean),
            column("_deviation", "standard deviation", &|e| e.deviation),
            column("_lower", "lower end of the interval", &|e| e.mean - e.half_width),
            column("_upper", "upper end of the interval", &|e| e.mean + e.half_width),
        ];
        if may_be_nothing {
            let counts = Cells::Whole(given.iter().map(|values| values.len() as u64).collect());
            columns.push(Column::new(&format!("{name}_runs"), "runs that gave a value", counts));
        }
        columns
    }
}
