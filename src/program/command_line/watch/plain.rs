//! One report as plain text, for pipes, logs and batch systems.

use super::columns::{Curve, chosen};
use super::run::{WatchedRun, brief};
use std::fmt::Write;

/// The present state of the run.
pub(super) fn report(run: &WatchedRun, columns: &[String]) -> String {
    let overview = run.overview();
    let mut report = format!("{}\n", overview.title);
    let mut line = |name: &str, text: &str| {
        let _ = writeln!(report, "  {name:<28}{text}");
    };
    line("folder", &overview.folder);
    line("state", &overview.state.text());
    line("progress", &overview.progress_text());
    if let Some((stage, _)) = &overview.stage {
        line("stage", stage);
    }
    if let Some(pace) = overview.pace_text() {
        line("rate", &pace);
    }
    for warning in &overview.warnings {
        line("warning", warning);
    }
    for curve in run.series().map(|series| chosen(columns, series)).unwrap_or_default() {
        line(&curve.name, &value(&curve));
    }
    report
}

/// A text such as `0.988, between 0 and 1.05`, with the unit.
fn value(curve: &Curve) -> String {
    let (Some(last), Some((least, largest))) = (curve.last(), curve.range()) else {
        return "no number yet".to_owned();
    };
    let unit = if curve.unit.is_empty() { String::new() } else { format!(" {}", curve.unit) };
    format!("{}{unit}, so far between {} and {}", brief(last), brief(least), brief(largest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_printed_with_its_range_and_unit() {
        let curve = |points: &[(f64, f64)], unit: &str| {
            value(&Curve { name: "x".to_owned(), unit: unit.to_owned(), points: points.to_vec() })
        };
        let points = [(0.0, 2.0), (1.0, -1.5), (2.0, 1.0)];
        assert_eq!(curve(&points, "m"), "1 m, so far between -1.5 and 2");
        assert_eq!(curve(&points[..1], ""), "2, so far between 2 and 2");
        assert_eq!(curve(&[], "m"), "no number yet");
    }
}
