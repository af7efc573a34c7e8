//! The values of the runs of each point, as columns of a table.

use super::replicates::Replicates;
use talcum_results::output::{Cells, Column};

/// The values of a number for the runs of each point.
pub(crate) struct OfPoints<'a> {
    /// Name of the number.
    pub(crate) name: &'a str,
    /// Its unit, if it is known.
    pub(crate) unit: Option<&'a str>,
    /// Its values, point by point.
    pub(crate) given: &'a [Vec<f64>],
}

impl OfPoints<'_> {
    /// Mean, standard deviation and both ends of the interval at a level of confidence; if runs may have had nothing to
    /// measure, also the number of those that gave a value.
    pub(crate) fn columns(&self, may_be_nothing: bool, confidence: f64) -> Vec<Column> {
        let Self { name, unit, given } = *self;
        let replicates: Vec<Option<Replicates>> =
            given.iter().map(|values| Replicates::of(values, confidence)).collect();
        let column = |suffix: &str, about: &str, of: &dyn Fn(&Replicates) -> f64| {
            let values = replicates.iter().map(|found| found.as_ref().map_or(f64::NAN, of));
            numbers(&format!("{name}{suffix}"), unit, about, values.collect())
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

/// A column of numbers, whose unit may be unknown.
pub(super) fn numbers(name: &str, unit: Option<&str>, about: &str, values: Vec<f64>) -> Column {
    let column = Column::new(name, about, Cells::Number(values));
    Column { unit: unit.map(str::to_owned), ..column }
}
