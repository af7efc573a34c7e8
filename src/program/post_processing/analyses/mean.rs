//! Means of the columns of `series.csv`, with standard errors.

use crate::post_processing::evenly_spaced::EvenRows;
use crate::post_processing::{Analysis, Findings, Kind, Results, Unmeasured, Value};
use talcum_engine::fields::{Column, Unit};
use talcum_results::analysis::statistics::{CorrelatedMean, correlated_mean, moments};
use talcum_results::analysis::{Estimate, NoValue, SeriesRow};
use talcum_results::output::{Cells, ResultTable};

pub(super) const ANALYSIS: Analysis = Analysis {
    name: "mean",
    title: "Means of series.csv",
    scalars: || kinds().collect(),
    of_case: |_| Ok(()),
    find,
};

/// One kind for each column.
fn kinds() -> impl Iterator<Item = Kind> {
    let columns = SeriesRow::COLUMNS.iter().filter(|column| column.name != "time");
    columns.map(|column| Kind::number(&column.name, column.unit, "mean of this column"))
}

/// Statistics of one column.
struct Row {
    name: &'static str,
    unit: String,
    mean: Estimate,
    deviation: f64,
    /// Correlation time of the series, in units of time.
    correlation_time: f64,
    independent: f64,
    reason: String,
}

fn find(results: &Results) -> Result<Findings, Unmeasured> {
    let series = results.series()?;
    let even = EvenRows::of(&results.column("time")?)?;
    let mut found = Findings::new(results.units());
    let mut rows = Vec::new();
    for kind in kinds() {
        let Some(place) = series.position(kind.name) else { continue };
        let values = even.pick(&series.column(kind.name).unwrap_or_default());
        let row = row_of(kind.name, &values, even.interval)?;
        found.add(&kind, Value::from(row.mean));
        rows.push(Row { unit: series.columns[place].1.clone(), ..row });
    }
    found.tables.push(table(&rows, results.units().of(Unit::Time)));
    Ok(found)
}

/// Mean and error, or only the mean and the reason why it has no error.
fn row_of(name: &'static str, values: &[f64], interval: f64) -> Result<Row, NoValue> {
    let unit = String::new();
    match correlated_mean(values) {
        Ok(CorrelatedMean { mean, deviation, correlation_time, effective_count }) => Ok(Row {
            name,
            unit,
            mean,
            deviation,
            correlation_time: correlation_time * interval,
            independent: effective_count,
            reason: String::new(),
        }),
        Err(reason) => {
            let found = moments(values)?;
            let mean = Estimate { value: found.mean, error: f64::INFINITY };
            let (correlation_time, independent) = (f64::NAN, f64::NAN);
            let (deviation, reason) = (found.deviation, reason.reason().to_owned());
            Ok(Row { name, unit, mean, deviation, correlation_time, independent, reason })
        }
    }
}

fn table(rows: &[Row], time_unit: &str) -> ResultTable {
    let texts = |name: &str, about: &str, of: &dyn Fn(&Row) -> &str| {
        Column::new(name, about, Cells::Text(rows.iter().map(|row| of(row).to_owned()).collect()))
    };
    let numbers = |name: &str, unit: &str, about: &str, of: &dyn Fn(&Row) -> f64| {
        Column::numbers(name, unit, about, rows.iter().map(of).collect())
    };
    let error = |row: &Row| if row.mean.error.is_finite() { row.mean.error } else { f64::NAN };
    let columns = vec![
        texts("column", "of series.csv", &|row| row.name),
        texts("unit", "of mean, error and deviation", &|row| &row.unit),
        numbers("mean", "see unit", "mean over the rows", &|row| row.mean.value),
        numbers("error", "see unit", "its standard error, correlation counted", &error),
        numbers("deviation", "see unit", "standard deviation of the rows", &|row| row.deviation),
        numbers("correlation_time", time_unit, "integrated, of the rows", &|row| {
            row.correlation_time
        }),
        numbers("independent_values", "1", "that would have this error", &|row| row.independent),
        texts("no_error_because", "why there is no error", &|row| &row.reason),
    ];
    ResultTable::new("mean/columns", columns)
}
