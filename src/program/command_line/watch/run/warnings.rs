//! Warnings about the results of a run.

use talcum_results::output::readers::SeriesTable;

/// Errors of balances, which are of the size of rounding, 1e-16 to 1e-9, in a sound run.
const BALANCES: [&str; 3] = ["momentum_error", "mass_error", "exchange_error"];
const LARGEST_ERROR: f64 = 1.0e-6;

/// Warnings about the rows of the series.
pub(super) fn of_series(series: &SeriesTable) -> Vec<String> {
    let mut warnings = Vec::new();
    warnings.extend(raised_cells(series));
    warnings.extend(departed(series));
    warnings.extend(BALANCES.iter().filter_map(|name| balance(series, name)));
    warnings.extend(undefined(series));
    warnings
}

/// A warning about cells in which the drag was computed with more gas than there is.
fn raised_cells(series: &SeriesTable) -> Option<String> {
    let counts = series.column("raised_cells")?;
    let rows = counts.iter().filter(|&&count| count > 0.0).count();
    let largest = counts.iter().fold(0.0, |most: f64, &count| most.max(count));
    (rows > 0).then(|| {
        format!(
            "the voidage of up to {largest} cells was raised to gas.least_voidage, in {rows} of {} rows",
            counts.len()
        )
    })
}

fn departed(series: &SeriesTable) -> Option<String> {
    let count = *series.column("departed")?.last()?;
    let particles = *series.column("particles")?.last()?;
    (count > 0.0).then(|| {
        format!("{count} particles have left through open faces, {particles} are in the box")
    })
}

fn balance(series: &SeriesTable, name: &str) -> Option<String> {
    let errors = series.column(name)?;
    let largest = errors.iter().fold(0.0, |most: f64, error| most.max(error.abs()));
    (largest > LARGEST_ERROR).then(|| {
        format!("{name} is up to {largest:.1e}, but no more than a rounding error in a sound run")
    })
}

/// Columns whose last value is not a number.
fn undefined(series: &SeriesTable) -> Option<String> {
    let last = series.rows.last()?;
    let named = series.columns.iter().zip(last).filter(|(_, value)| !value.is_finite());
    let names: Vec<&str> = named.map(|((name, _), _)| name.as_str()).collect();
    (!names.is_empty()).then(|| format!("not a number in the last row: {}", names.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn warnings(rows: &str) -> Vec<String> {
        let head =
            "time [s],particles [1],departed [1],raised_cells [1],mass_error [1],bed_top [m]\n";
        of_series(&SeriesTable::parse(&format!("{head}{rows}")).unwrap())
    }

    #[test]
    fn a_sound_run_gives_no_warning() {
        assert_eq!(warnings("0,900,0,0,-2e-15,1\n1,900,0,0,1e-12,1\n"), [""; 0]);
        assert_eq!(warnings(""), [""; 0]);
    }

    #[test]
    fn raised_voidages_departures_errors_and_undefined_numbers_are_named() {
        let raised = warnings("0,900,0,2,0,1\n1,900,0,5,0,1\n2,900,0,0,0,1\n");
        assert!(raised.len() == 1 && raised[0].contains("up to 5 cells"), "{raised:?}");
        assert!(raised[0].contains("2 of 3 rows"), "{raised:?}");
        let left = warnings("0,900,0,0,0,1\n1,898,2,0,0,1\n");
        assert!(left.len() == 1 && left[0].starts_with("2 particles have left"), "{left:?}");
        let error = warnings("0,900,0,0,-1e-3,1\n1,900,0,0,0,1\n");
        assert!(error.len() == 1 && error[0].contains("mass_error is up to 1.0e-3"), "{error:?}");
        let undefined = warnings("0,900,0,0,0,1\n1,900,0,0,0,NaN\n");
        assert!(undefined.len() == 1 && undefined[0].ends_with("bed_top"), "{undefined:?}");
    }
}
