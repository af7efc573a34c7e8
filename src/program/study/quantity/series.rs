//! A statistic of a column of `series.csv` over a window of time.

use super::reduction::{Reduction, STATISTIC};
use super::window::WINDOW;
use super::{Measured, Quantity};
use crate::study::run_outline::RunOutline;
use std::path::Path;
use talcum_engine::schema::{Key, Kind};
use talcum_results::analysis::SeriesRow;
use talcum_results::output::OutputError;
use talcum_results::output::readers::SeriesTable;
use talcum_runs::input::{Section, advice};

/// The columns of `series.csv`, without `time`.
fn series_columns() -> Vec<&'static str> {
    SeriesRow::COLUMNS.iter().map(|known| &*known.name).filter(|name| *name != "time").collect()
}

/// Keys of the source `series`.
pub(super) const KEYS: &[Key] =
    &[Key::new("column", Kind::Text, "A column of `series.csv`"), STATISTIC, WINDOW];

/// The quantity of a section.
pub(super) fn read(section: &Section<'_>) -> Option<Box<dyn Quantity>> {
    let (column, reduction) = (section.text("column"), Reduction::of_section(section));
    let (column, known) = (column?, series_columns());
    if !known.contains(&column.as_str()) {
        section.fail("column", format!("no such column: {}", advice(&column, &known)));
        return None;
    }
    Some(Box::new(ColumnStatistic { column, reduction: reduction? }))
}

/// One statistic of one column.
#[derive(Clone, Debug, PartialEq)]
struct ColumnStatistic {
    column: String,
    reduction: Reduction,
}

impl Quantity for ColumnStatistic {
    fn value(&self, results: &Path) -> Result<Measured, OutputError> {
        let path = results.join("series.csv");
        let table = SeriesTable::read(&path)?;
        let value = reduced(&table, &self.column, &self.reduction);
        value.map_err(|message| OutputError { path, message })
    }

    fn describe(&self) -> String {
        self.reduction.describe(&self.column)
    }

    fn check(&self, run: &RunOutline) -> Result<(), String> {
        self.reduction.window.check(run.end_time)
    }
}

/// The statistic of a column over a window.
///
/// # Errors
/// If there is no such column, or if too few rows lie in the window.
pub(crate) fn reduced(
    table: &SeriesTable,
    column: &str,
    reduction: &Reduction,
) -> Result<Measured, String> {
    let time = table.position("time").ok_or("it has no column time")?;
    let at = table.position(column).ok_or(format!("it has no column {column}"))?;
    let end = table.rows.last().map_or(f64::NAN, |row| row[time]);
    let value = reduction.value(table.rows.iter().map(|row| (row[time], row[at])), end)?;
    Ok(Measured::number(value, &table.columns[at].1))
}

#[cfg(test)]
mod tests {
    use super::super::{Statistic, Value, Window};
    use super::*;

    const TEXT: &str = "# commit: abc\n# case: title = \"x\"\ntime [sqrt(d/g)],bed_top [d]\n0,10\n1,20\n2,40\n3,30\n";

    #[test]
    fn statistics_over_windows() {
        let table = SeriesTable::parse(TEXT).unwrap();
        let value = |statistic, window| {
            let reduction = Reduction { statistic, window };
            reduced(&table, "bed_top", &reduction).map(|measured| measured.value)
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
        let mean = Reduction { statistic: Statistic::Mean, window: all };
        let unit = reduced(&table, "bed_top", &mean).unwrap().unit;
        assert_eq!(unit, "d");
    }

    #[test]
    fn an_empty_window_and_an_unknown_column_are_errors() {
        let table = SeriesTable::parse(TEXT).unwrap();
        let late = Window { from: Some(5.0), ..Window::default() };
        let over = |statistic, window| Reduction { statistic, window };
        let error = reduced(&table, "bed_top", &over(Statistic::Mean, late)).unwrap_err();
        assert!(error.contains("0 rows") && error.contains("last row is at 3"), "{error}");
        let one = Window { from: Some(3.0), ..Window::default() };
        assert!(reduced(&table, "bed_top", &over(Statistic::Deviation, one)).is_err());
        assert!(reduced(&table, "height", &over(Statistic::Mean, one)).is_err());
    }
}
