//! A statistic of a column of `series.csv` over a window of time.

use super::{Measure, MeasureError, MeasureSource, Measured};
use crate::analysis::Measures;
use crate::study::section::{Entry, Section, advice};
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

/// Which rows count, by their time; both ends belong to it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Window {
    /// First time; the start of the run if it is not given.
    pub(crate) from: Option<f64>,
    /// Last time; the end of the run if it is not given.
    pub(crate) to: Option<f64>,
    /// Instead: so much time before the last row.
    pub(crate) last: Option<f64>,
}

impl Window {
    /// The smallest and the largest time of a run that ends at `end`.
    fn bounds(&self, end: f64) -> (f64, f64) {
        let from = self.last.map(|duration| end - duration).or(self.from);
        (from.unwrap_or(f64::NEG_INFINITY), self.to.unwrap_or(f64::INFINITY))
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

/// `{ from, to }` or `{ last }`.
fn window(entry: &Entry<'_>) -> Option<Window> {
    let section = entry.section()?;
    let number = |key| section.optional(key).map(|entry| entry.number());
    let (from, to, last) = (number("from"), number("to"), number("last"));
    section.finish();
    let flat = |given: Option<Option<f64>>| given.map_or(Some(None), |number| number.map(Some));
    let window = Window { from: flat(from)?, to: flat(to)?, last: flat(last)? };
    match window {
        Window { from: None, to: None, last: None }
        | Window { from: Some(_), last: Some(_), .. }
        | Window { to: Some(_), last: Some(_), .. } => {
            entry.fail("must have from, to, or both, or last");
            None
        }
        Window { from: Some(from), to: Some(to), .. } if from > to => {
            entry.fail("from must not be after to");
            None
        }
        Window { last: Some(last), .. } if last <= 0.0 => {
            entry.fail("last must be above 0");
            None
        }
        _ => Some(window),
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
    fn value(&self, results: &Path) -> Result<Measured, MeasureError> {
        let path = results.join("series.csv");
        let table = Table::read(&path)?;
        let value = table.statistic(&self.column, self.statistic, &self.window);
        value.map_err(|message| MeasureError::new(&path, message))
    }

    fn describe(&self) -> String {
        let name = Statistic::NAMES.iter().find(|(_, known)| *known == self.statistic);
        let name = name.map_or("", |(name, _)| name);
        let ends = [("from", self.window.from), ("to", self.window.to), ("last", self.window.last)];
        let ends = ends.into_iter().filter_map(|(end, time)| Some(format!(" {end} {}", time?)));
        format!("{name} of {}{}", self.column, ends.collect::<String>())
    }

    fn check(&self, end_time: f64) -> Result<(), String> {
        // Rows lie at multiples of an interval that rounding may move by a little.
        let beyond = |time: f64| time > end_time * (1.0 + 1.0e-9);
        match self.window {
            Window { from: Some(from), .. } if beyond(from) => {
                Err(format!("the window begins at {from}, but the run ends at {end_time}"))
            }
            Window { to: Some(to), .. } if to < 0.0 => {
                Err(format!("the window ends at {to}, before the run begins"))
            }
            _ => Ok(()),
        }
    }
}

/// The rows of `series.csv`, and what it says about its run.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Table {
    /// Names and texts of the lines `# name: text`, without the case.
    pub(crate) provenance: Vec<(String, String)>,
    /// Names of the columns with their units.
    pub(crate) columns: Vec<(String, String)>,
    /// The rows in the order of time.
    pub(crate) rows: Vec<Vec<f64>>,
}

impl Table {
    /// Reads the file.
    ///
    /// # Errors
    /// If it cannot be read, or is not such a table.
    pub(crate) fn read(path: &Path) -> Result<Self, MeasureError> {
        let wrong = |message: String| MeasureError::new(path, message);
        let text = std::fs::read_to_string(path);
        let text = text.map_err(|error| wrong(format!("cannot be read: {error}")))?;
        Self::parse(&text).map_err(wrong)
    }

    fn parse(text: &str) -> Result<Self, String> {
        let mut table = Self::default();
        for (index, line) in text.lines().enumerate() {
            if let Some(comment) = line.strip_prefix('#') {
                let pair = comment.split_once(':').unwrap_or((comment, ""));
                let (name, text) = (pair.0.trim(), pair.1.trim());
                if name != "case" {
                    table.provenance.push((name.to_owned(), text.to_owned()));
                }
            } else if table.columns.is_empty() {
                table.columns = line.split(',').map(name_and_unit).collect();
            } else {
                let row: Result<Vec<f64>, _> = line.split(',').map(str::parse).collect();
                let row = row.ok().filter(|row| row.len() == table.columns.len());
                table.rows.push(row.ok_or(format!("line {} is not a row of numbers", index + 1))?);
            }
        }
        Ok(table)
    }

    /// A line of provenance.
    pub(crate) fn entry(&self, name: &str) -> Option<&str> {
        self.provenance.iter().find(|(known, _)| known == name).map(|(_, text)| text.as_str())
    }

    /// The statistic of a column over a window.
    ///
    /// # Errors
    /// If there is no such column, or if too few rows lie in the window.
    pub(crate) fn statistic(
        &self,
        column: &str,
        statistic: Statistic,
        window: &Window,
    ) -> Result<Measured, String> {
        let position = |name: &str| self.columns.iter().position(|(known, _)| known == name);
        let time = position("time").ok_or("it has no column time")?;
        let at = position(column).ok_or(format!("it has no column {column}"))?;
        let end = self.rows.last().map_or(f64::NAN, |row| row[time]);
        let (from, to) = window.bounds(end);
        // The times of rows are sums of steps: one part in 10^9 is far below any interval between rows.
        let slack = 1.0e-9 * end.abs();
        let inside = |row: &&Vec<f64>| row[time] >= from - slack && row[time] <= to + slack;
        let values: Vec<f64> = self.rows.iter().filter(inside).map(|row| row[at]).collect();
        let value = statistic.of(&values).ok_or(format!(
            "{} rows between the times {from} and {to} are too few; the last row is at {end}",
            values.len()
        ))?;
        Ok(Measured { value, unit: self.columns[at].1.clone() })
    }
}

/// Splits `name [unit]`.
fn name_and_unit(heading: &str) -> (String, String) {
    match heading.split_once('[') {
        Some((name, unit)) => {
            (name.trim().to_owned(), unit.trim().trim_end_matches(']').to_owned())
        }
        None => (heading.trim().to_owned(), String::new()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "# commit: abc\n# case: title = \"x\"\ntime [sqrt(d/g)],bed_top [d]\n0,10\n1,20\n2,40\n3,30\n";

    #[test]
    fn statistics_over_windows() {
        let table = Table::parse(TEXT).unwrap();
        assert_eq!((table.entry("commit"), table.entry("case")), (Some("abc"), None));
        let value = |statistic, window| {
            table.statistic("bed_top", statistic, &window).map(|measured| measured.value)
        };
        let all = Window::default();
        let from_one = Window { from: Some(1.0), ..all };
        assert_eq!(value(Statistic::Mean, all), Ok(25.0));
        assert_eq!(value(Statistic::Mean, from_one), Ok(30.0));
        assert_eq!(value(Statistic::Last, all), Ok(30.0));
        assert_eq!(value(Statistic::Max, all), Ok(40.0));
        assert_eq!(value(Statistic::Min, Window { last: Some(2.0), ..all }), Ok(20.0));
        // Deviation of 20, 40, 30: sqrt((100 + 100 + 0) / 2).
        assert_eq!(value(Statistic::Deviation, from_one), Ok(10.0));
        let unit = table.statistic("bed_top", Statistic::Mean, &all).unwrap().unit;
        assert_eq!(unit, "d");
    }

    #[test]
    fn an_empty_window_and_a_foreign_file_are_errors() {
        let table = Table::parse(TEXT).unwrap();
        let late = Window { from: Some(5.0), ..Window::default() };
        let error = table.statistic("bed_top", Statistic::Mean, &late).unwrap_err();
        assert!(error.contains("0 rows") && error.contains("last row is at 3"), "{error}");
        let one = Window { from: Some(3.0), ..Window::default() };
        assert!(table.statistic("bed_top", Statistic::Deviation, &one).is_err());
        assert!(table.statistic("height", Statistic::Mean, &one).is_err());
        assert!(Table::parse("time [s]\n1,2\n").is_err());
        assert!(Table::parse("time [s]\nx\n").is_err());
    }
}
