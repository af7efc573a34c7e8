//! A statistic of a column of `series.csv` over a window of time.

use super::{Measure, MeasureSource, Measured, Window, window};
use crate::analysis::Measures;
use crate::output::OutputError;
use crate::output::readers::SeriesTable;
use crate::study::section::{Section, advice};
use std::path::Path;

/// The columns of `series.csv`, without `time`.
fn series_columns() -> Vec<&'static str> {
    Measures::COLUMNS.iter().map(|column| column.name).filter(|name| *name != "time").collect()
}

/// What is computed from the rows in the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Statistic {
    /// Arithmetic mean of the rows.
    Mean,
    /// Value in the last row.
    Last,
    /// Largest value.
    Max,
    /// Smallest value.
    Min,
    /// Standard deviation of the rows about their mean, with n - 1.
    Deviation,
}

impl Statistic {
    const NAMES: [(&'static str, Self); 5] = [
        ("mean", Self::Mean),
        ("last", Self::Last),
        ("max", Self::Max),
        ("min", Self::Min),
        ("deviation", Self::Deviation),
    ];

    /// The statistic of that name.
    pub(crate) fn named(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|(known, _)| *known == name).map(|(_, statistic)| *statistic)
    }

    /// The statistic of values in the order of time; `None` if there are too few.
    pub(crate) fn of(self, values: &[f64]) -> Option<f64> {
        let last = *values.last()?;
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        match self {
            Self::Mean => Some(mean),
            Self::Last => Some(last),
            Self::Max => Some(values.iter().copied().fold(last, f64::max)),
            Self::Min => Some(values.iter().copied().fold(last, f64::min)),
            Self::Deviation if values.len() < 2 => None,
            Self::Deviation => {
                let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
                Some((squares / (values.len() - 1) as f64).sqrt())
            }
        }
    }
}

/// The source `series`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Series;

impl MeasureSource for Series {
    fn name(&self) -> &'static str {
        "series"
    }

    fn prepare(&self, section: &Section<'_>) -> Option<Box<dyn Measure>> {
        let column = section.required("column", "a column of series.csv");
        let statistic =
            section.required("statistic", "\"mean\", \"last\", \"max\", \"min\" or \"deviation\"");
        let window = section.optional("window").map(|entry| window(&entry));
        let column = column?;
        let name = column.text()?;
        let known = series_columns();
        if !known.contains(&name.as_str()) {
            column.fail(format!("no such column: {}", advice(&name, &known)));
            return None;
        }
        let entry = statistic?;
        let Some(statistic) = Statistic::named(&entry.text()?) else {
            let names = Statistic::NAMES.map(|(name, _)| name);
            entry.fail(format!("must be one of {}", names.join(", ")));
            return None;
        };
        let window = match window {
            Some(window) => window?,
            None => Window::default(),
        };
        Some(Box::new(ColumnStatistic { column: name, statistic, window }))
    }
}

/// One statistic of one column.
#[derive(Clone, Debug, PartialEq)]
struct ColumnStatistic {
    column: String,
    statistic: Statistic,
    window: Window,
}

impl Measure for ColumnStatistic {
    fn value(&self, results: &Path) -> Result<Measured, OutputError> {
        let path = results.join("series.csv");
        let table = SeriesTable::read(&path)?;
        let value = statistic_of(&table, &self.column, self.statistic, &self.window);
        value.map_err(|message| OutputError { path, message })
    }

    fn describe(&self) -> String {
        let name = Statistic::NAMES.iter().find(|(_, known)| *known == self.statistic);
        let name = name.map_or("", |(name, _)| name);
        format!("{name} of {}{}", self.column, self.window)
    }

    fn check(&self, end_time: f64) -> Result<(), String> {
        self.window.check(end_time)
    }
}

/// The statistic of a column over a window.
///
/// # Errors
/// If there is no such column, or if too few rows lie in the window.
pub(crate) fn statistic_of(
    table: &SeriesTable,
    column: &str,
    statistic: Statistic,
    window: &Window,
) -> Result<Measured, String> {
    let time = table.position("time").ok_or("it has no column time")?;
    let at = table.position(column).ok_or(format!("it has no column {column}"))?;
    let end = table.rows.last().map_or(f64::NAN, |row| row[time]);
    let (from, to) = window.bounds(end);
    let inside = |row: &&Vec<f64>| (from..=to).contains(&row[time]);
    let values: Vec<f64> = table.rows.iter().filter(inside).map(|row| row[at]).collect();
    let value = statistic.of(&values).ok_or(format!(
        "{} rows between the times {from} and {to} are too few; the last row is at {end}",
        values.len()
    ))?;
    Ok(Measured::number(value, &table.columns[at].1))
}

#[cfg(test)]
mod tests {
    use super::super::Value;
    use super::*;

    const TEXT: &str = "# commit: abc\n# case: title = \"x\"\ntime [sqrt(d/g)],bed_top [d]\n0,10\n1,20\n2,40\n3,30\n";

    #[test]
    fn statistics_over_windows() {
        let table = SeriesTable::parse(TEXT).unwrap();
        let value = |statistic, window| {
            statistic_of(&table, "bed_top", statistic, &window).map(|measured| measured.value)
        };
        let all = Window::default();
        let from_one = Window { from: Some(1.0), ..all };
        assert_eq!(value(Statistic::Mean, all), Ok(Value::Number(25.0)));
        assert_eq!(value(Statistic::Mean, from_one), Ok(Value::Number(30.0)));
        assert_eq!(value(Statistic::Last, all), Ok(Value::Number(30.0)));
        assert_eq!(value(Statistic::Max, all), Ok(Value::Number(40.0)));
        assert_eq!(
            value(Statistic::Min, Window { last: Some(2.0), ..all }),
            Ok(Value::Number(20.0))
        );
        // Deviation of 20, 40, 30: sqrt((100 + 100 + 0) / 2).
        assert_eq!(value(Statistic::Deviation, from_one), Ok(Value::Number(10.0)));
        let unit = statistic_of(&table, "bed_top", Statistic::Mean, &all).unwrap().unit;
        assert_eq!(unit, "d");
    }

    #[test]
    fn an_empty_window_and_an_unknown_column_are_errors() {
        let table = SeriesTable::parse(TEXT).unwrap();
        let late = Window { from: Some(5.0), ..Window::default() };
        let error = statistic_of(&table, "bed_top", Statistic::Mean, &late).unwrap_err();
        assert!(error.contains("0 rows") && error.contains("last row is at 3"), "{error}");
        let one = Window { from: Some(3.0), ..Window::default() };
        assert!(statistic_of(&table, "bed_top", Statistic::Deviation, &one).is_err());
        assert!(statistic_of(&table, "height", Statistic::Mean, &one).is_err());
    }
}
