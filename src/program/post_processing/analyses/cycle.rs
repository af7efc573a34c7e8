//! Means over the phase of the plate's vibration.

use crate::post_processing::{Analysis, Findings, Kind, Results, Unmeasured, Value};
use talcum_engine::domain::Vibration;
use talcum_engine::fields::{Column, Unit};
use talcum_results::analysis::NoValue;
use talcum_results::analysis::phase_average::{PhaseAverage, PhaseOptions, phase_average};
use talcum_results::output::{ResultTable, TableColumn};
use talcum_runs::case::{Case, Stage};

pub(super) const ANALYSIS: Analysis = Analysis {
    name: "cycle",
    title: "The cycle of the vibrated plate",
    scalars: || vec![FREQUENCY, CYCLES, PLATE_PEAK, PLATE_PEAK_PHASE, LIFT, FLOW_SWING],
    of_case: require_vibration,
    find,
};

const FREQUENCY: Kind = Kind::number("frequency", Unit::Frequency, "of the plate");
const CYCLES: Kind = Kind::number("cycles", Unit::One, "complete cycles that were averaged");
const PLATE_PEAK: Kind =
    Kind::number("plate_stress_peak", Unit::One, "largest mean stress on the plate");
const PLATE_PEAK_PHASE: Kind =
    Kind::number("plate_stress_peak_phase", Unit::One, "at this part of the cycle");
const LIFT: Kind =
    Kind::number("lift", Unit::Length, "largest less smallest mean height of the bed's bottom");

const FLOW_SWING: Kind = Kind::number(
    "flow_swing",
    Unit::Speed,
    "largest less smallest mean superficial velocity: 0 if the gas is driven at a constant one",
);

/// Columns that are averaged.
const COLUMNS: [&str; 10] = [
    "plate_stress",
    "gas_force",
    "grid_pressure_drop",
    "superficial_velocity",
    "plenum_pressure",
    "effective_gravity",
    "bed_bottom",
    "bed_top",
    "centre_height",
    "centre_velocity",
];
/// Number of bins of a cycle.
const BINS: usize = 40;

fn find(results: &Results) -> Result<Findings, Unmeasured> {
    let times = results.column("time")?;
    let Vibrating { vibration, from, to } = last_vibration(results, times[times.len() - 1])?;
    // The row at the start of a stage belongs to the previous stage.
    let rows =
        times.partition_point(|&time| time <= from)..times.partition_point(|&time| time <= to);
    let options = PhaseOptions {
        frequency: vibration.frequency,
        origin: vibration.start,
        bins: BINS,
        skipped_cycles: 0,
    };
    if rows.len() < 2 {
        return Err(NoValue::because("the plate vibrates at none of these times").into());
    }
    let series = results.series()?;
    let mut found = Findings::new(results.units());
    let mut columns: Vec<TableColumn> = Vec::new();
    let mut averages = Vec::new();
    for name in COLUMNS {
        let Some(values) = series.column(name) else { continue };
        let average = phase_average(&times[rows.clone()], &values[rows.clone()], &options)?;
        if columns.is_empty() {
            columns.push(Column::numbers("phase", "1", "part of a cycle", average.phases.clone()));
        }
        let unit = series.position(name).map_or("1", |place| &series.columns[place].1);
        columns.extend(columns_of(name, unit, &average));
        averages.push((name, average));
    }
    let of = |name: &str| averages.iter().find(|(known, _)| *known == name).map(|(_, a)| a);
    found.add(&FREQUENCY, vibration.frequency);
    found.add(&CYCLES, averages.first().map_or(0.0, |(_, average)| average.cycles.len() as f64));
    let peak = of("plate_stress").and_then(peak);
    found.add(&PLATE_PEAK, peak.clone().map_or_else(nothing, |(_, value)| value));
    found.add(&PLATE_PEAK_PHASE, peak.map_or_else(nothing, |(phase, _)| phase.into()));
    found.add(&LIFT, of("bed_bottom").and_then(swing).unwrap_or_else(nothing));
    found.add(&FLOW_SWING, of("superficial_velocity").and_then(swing).unwrap_or_else(nothing));
    found.tables.push(ResultTable::new("cycle/phases", columns));
    Ok(found)
}

fn require_vibration(case: &Case) -> Result<(), NoValue> {
    let vibrates = case.stages.iter().any(|stage| stage.physics.gravity.vibration.is_some());
    if vibrates { Ok(()) } else { Err(NoValue::because("the plate vibrates in no stage")) }
}

fn nothing() -> Value {
    Value::Nothing(NoValue::because("no phase of the cycle has rows"))
}

/// A vibration of the plate, and its times.
struct Vibrating {
    vibration: Vibration,
    from: f64,
    to: f64,
}

/// The vibration of the last stage that has one and has begun at `last_row`, over that stage and those immediately
/// before it with the same vibration.
fn last_vibration(results: &Results, last_row: f64) -> Result<Vibrating, Unmeasured> {
    let stages: Vec<&Stage> = results.stages()?.filter(|stage| stage.start < last_row).collect();
    let vibration_of = |place: usize| stages[place].physics.gravity.vibration;
    let none = || NoValue::because("the plate does not vibrate at these times");
    let vibrating = |place: usize| Some((place, vibration_of(place)?));
    let (last, vibration) = (0..stages.len()).rev().find_map(vibrating).ok_or_else(none)?;
    let same = |place: &usize| vibration_of(*place) == Some(vibration);
    let first = (0..=last).rev().take_while(same).last().unwrap_or(last);
    let from = stages[first].start.max(vibration.start);
    Ok(Vibrating { vibration, from, to: stages[last].end })
}

fn columns_of(name: &str, unit: &str, average: &PhaseAverage) -> [TableColumn; 2] {
    let numbers = |values: &[Option<f64>]| -> Vec<f64> {
        values.iter().map(|value| value.unwrap_or(f64::NAN)).collect()
    };
    let error = format!("{name}_error");
    [
        Column::numbers(name, unit, "mean over the cycles", numbers(&average.means)),
        Column::numbers(
            &error,
            unit,
            "its standard error between cycles",
            numbers(&average.errors),
        ),
    ]
}

/// Phase and value of the largest mean, with its error.
fn peak(average: &PhaseAverage) -> Option<(f64, Value)> {
    let known = average.means.iter().enumerate().filter_map(|(bin, mean)| Some((bin, (*mean)?)));
    let (bin, value) = known.max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some((average.phases[bin], Value::Number { value, error: average.errors[bin] }))
}

/// Largest less smallest mean; the error is that of these two means, treated as independent.
fn swing(average: &PhaseAverage) -> Option<Value> {
    let known = || {
        average
            .means
            .iter()
            .zip(&average.errors)
            .filter_map(|(mean, error)| Some(((*mean)?, *error)))
    };
    let (highest, of_highest) = known().max_by(|a, b| a.0.total_cmp(&b.0))?;
    let (lowest, of_lowest) = known().min_by(|a, b| a.0.total_cmp(&b.0))?;
    let error = of_highest.zip(of_lowest).map(|(one, other)| one.hypot(other));
    Some(Value::Number { value: highest - lowest, error })
}
