//! A number measured by the run itself, through a section `[measure.NAME]` of its case.

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
    Key::new("measure", Kind::Text, "The NAME of a section `[measure.NAME]` of the case"),
    Key::new(
        "column",
        Kind::Text,
        "A number that this measure gives, one of `scalars` in its file",
    ),
    STATISTIC,
    WINDOW,
];

/// The quantity of a section.
pub(super) fn read(section: &Section<'_>) -> Option<Box<dyn Quantity>> {
    let reduction = Reduction::of_section(section);
    let (measure, column) = (section.text("measure")?, section.text("column")?);
    Some(Box::new(ResultStatistic { measure, column, reduction: reduction? }))
}

/// One statistic of one column of the table `results` of a measure.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ResultStatistic {
    pub(super) measure: String,
    pub(super) column: String,
    pub(super) reduction: Reduction,
}

impl ResultStatistic {
    /// Whether the results of a run contain the file of its measure.
    pub(super) fn is_in(&self, results: &Path) -> bool {
        InstrumentResults::file_of(&self.measure, results).exists()
    }
}

impl Quantity for ResultStatistic {
    /// Rows that are undefined, such as the mean size if there are no agglomerates, do not count.
    fn value(&self, results: &Path) -> Result<Measured, OutputError> {
        let path = InstrumentResults::file_of(&self.measure, results);
        if !self.is_in(results) {
            let message =
                format!("is not there: the case has no section [measure.{}]", self.measure);
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
        let column = format!("{}.{}", self.measure, self.column);
        format!("{} as the run measured it", self.reduction.describe(&column))
    }

    fn check(&self, run: &RunOutline) -> Result<(), String> {
        let Some(columns) = run.measures.get(&self.measure) else {
            let known: Vec<&str> = run.measures.keys().map(String::as_str).collect();
            return Err(match known.is_empty() {
                true => "the case has no section [measure.NAME]".to_owned(),
                false => format!(
                    "the case has no [measure.{}]: {}",
                    self.measure,
                    advice(&self.measure, &known)
                ),
            });
        };
        if !columns.contains(&self.column.as_str()) {
            let advice = advice(&self.column, columns);
            return Err(format!(
                "measure.{} has no number {}: {advice}",
                self.measure, self.column
            ));
        }
        self.reduction.window.check(run.end_time)
    }

    fn may_be_nothing(&self) -> bool {
        true
    }
}
