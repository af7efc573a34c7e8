//! A number that an instrument of the run gives, a section `[measure.NAME]` of its case.

use super::reduction::{Reduction, STATISTIC};
use super::window::WINDOW;
use super::{Measured, Quantity, Value};
use crate::study::run_outline::RunOutline;
use std::path::Path;
use talcum_engine::schema::{Key, Kind};
use talcum_results::output::{InstrumentResults, OutputError};
use talcum_runs::input::{Section, advice};

/// Keys of the source `case`.
pub(super) const KEYS: &[Key] = &[
    Key::new(
        "measure",
        Kind::Text,
        "The NAME of an instrument, a section `[measure.NAME]` of the case",
    ),
    Key::new(
        "column",
        Kind::Text,
        "A number that this instrument gives, one of `scalars` in its file",
    ),
    STATISTIC,
    WINDOW,
];

/// The quantity of a section.
pub(super) fn read(section: &Section<'_>) -> Option<Box<dyn Quantity>> {
    let reduction = Reduction::of_section(section);
    let (instrument, column) = (section.text("measure")?, section.text("column")?);
    Some(Box::new(ResultStatistic { instrument, column, reduction: reduction? }))
}

/// One statistic of one column of the table `results` of an instrument.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ResultStatistic {
    pub(super) instrument: String,
    pub(super) column: String,
    pub(super) reduction: Reduction,
}

impl ResultStatistic {
    /// Whether the results of a run contain the file of its instrument.
    pub(super) fn is_in(&self, results: &Path) -> bool {
        InstrumentResults::file_of(&self.instrument, results).exists()
    }
}

impl Quantity for ResultStatistic {
    /// Rows that are undefined, such as the mean size if there are no agglomerates, do not count.
    fn value(&self, results: &Path) -> Result<Measured, OutputError> {
        let path = InstrumentResults::file_of(&self.instrument, results);
        if !self.is_in(results) {
            let message =
                format!("is not there: the case has no section [measure.{}]", self.instrument);
            return Err(OutputError { path, message });
        }
        let table = InstrumentResults::read(&path)?;
        let column = table.columns.iter().find(|column| column.name == self.column);
        let Some(column) = column else {
            let message = format!("it has no column {} in its table results", self.column);
            return Err(OutputError { path, message });
        };
        let rows = table.times.iter().copied().zip(column.values.iter().copied());
        let end = table.times.last().copied().unwrap_or(f64::NAN);
        let value = self.reduction.value(rows.filter(|(_, value)| value.is_finite()), end);
        Ok(Measured {
            value: value.map_or_else(Value::Nothing, Value::Number),
            unit: column.unit.clone(),
        })
    }

    fn describe(&self) -> String {
        let column = format!("{}.{}", self.instrument, self.column);
        format!("{} as the run measured it", self.reduction.describe(&column))
    }

    fn check(&self, run: &RunOutline) -> Result<(), String> {
        let Some(columns) = run.instruments.get(&self.instrument) else {
            let known: Vec<&str> = run.instruments.keys().map(String::as_str).collect();
            if known.is_empty() {
                return Err("the case has no section [measure.NAME]".to_owned());
            }
            let advice = advice(&self.instrument, &known);
            return Err(format!("the case has no [measure.{}]: {advice}", self.instrument));
        };
        if !columns.contains(&self.column) {
            let known: Vec<&str> = columns.iter().map(String::as_str).collect();
            let advice = advice(&self.column, &known);
            return Err(format!(
                "the instrument {} has no number {}: {advice}",
                self.instrument, self.column
            ));
        }
        self.reduction.window.check(run.end_time)
    }

    fn may_be_nothing(&self) -> bool {
        true
    }
}
