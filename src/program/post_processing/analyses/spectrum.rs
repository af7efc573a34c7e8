//! Power spectra of columns of `series.csv`.

use crate::post_processing::evenly_spaced::EvenRows;
use crate::post_processing::{Analysis, Findings, Kind, Results, Unmeasured};
use talcum_engine::fields::{Column, Unit};
use talcum_results::analysis::NoValue;
use talcum_results::analysis::spectrum::{PowerSpectrum, welch};
use talcum_results::analysis::statistics::moments;
use talcum_results::output::ResultTable;

pub(super) const ANALYSIS: Analysis = Analysis {
    name: "spectrum",
    title: "Power spectra of series.csv: the highest peak of each column",
    scalars: || COLUMNS.to_vec(),
    of_case: |_| Ok(()),
    find,
};

const COLUMNS: [Kind; 7] = [
    of("grid_pressure_drop"),
    of("gas_force"),
    of("plate_stress"),
    of("centre_height"),
    of("bed_bottom"),
    of("bed_top"),
    of("fluctuating_kinetic_energy"),
];

const fn of(column: &'static str) -> Kind {
    Kind::number(column, Unit::Frequency, "frequency of the highest peak of this column's spectrum")
}

/// Number of quarters of the series: a spectrum is the mean over seven segments of a quarter each, which overlap by
/// half.
const PARTS: usize = 4;
/// Level of the confidence band.
const CONFIDENCE: f64 = 0.95;
/// Ratio of the deviation to the largest magnitude below which a column is constant except for rounding.
const CONSTANT: f64 = 1.0e-12;

fn find(results: &Results) -> Result<Findings, Unmeasured> {
    let series = results.series()?;
    let even = EvenRows::of(&results.column("time")?)?;
    let mut found = Findings::new(results.units());
    let segment = even.rows.len() / PARTS;
    for kind in COLUMNS {
        let Some(values) = series.column(kind.name) else { continue };
        let values = even.pick(&values);
        let spectrum =
            check_varies(&values).and_then(|()| welch(&values, even.interval, segment, CONFIDENCE));
        let peak = spectrum.as_ref().map_err(Clone::clone).and_then(PowerSpectrum::dominant);
        found.add(&kind, peak.map(|peak| peak.frequency));
        if let Ok(spectrum) = spectrum {
            let unit = series.position(kind.name).map_or("", |place| &series.columns[place].1);
            found.tables.push(table(
                kind.name,
                &spectrum,
                unit,
                results.units().of(Unit::AngularSpeed),
            ));
        }
    }
    found.note(format!(
        "{} rows, an interval of {}, segments of {segment}; bands hold the true density at a frequency with {} %",
        even.rows.len(),
        even.interval,
        100.0 * CONFIDENCE
    ));
    Ok(found)
}

fn check_varies(values: &[f64]) -> Result<(), NoValue> {
    let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    if moments(values)?.deviation <= CONSTANT * largest {
        Err(NoValue::because("the column is constant"))
    } else {
        Ok(())
    }
}

fn table(name: &str, spectrum: &PowerSpectrum, unit: &str, frequency_unit: &str) -> ResultTable {
    let density_unit = format!("({unit})^2 / ({frequency_unit})");
    let times = |factor: f64| spectrum.density.iter().map(|density| density * factor).collect();
    let column = |name: &str, about: &str, factor: f64| {
        Column::numbers(name, &density_unit, about, times(factor))
    };
    let columns = vec![
        Column::numbers(
            "frequency",
            frequency_unit,
            "cycles per time",
            spectrum.frequencies.clone(),
        ),
        column("density", "one-sided power spectral density", 1.0),
        column("lower", "lower end of the confidence band", spectrum.lower_factor),
        column("upper", "upper end of the confidence band", spectrum.upper_factor),
    ];
    ResultTable::new(&format!("spectrum/{name}"), columns)
}
