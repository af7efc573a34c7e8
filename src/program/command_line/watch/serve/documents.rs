//! Documents requested by the page, as JSON. Numbers are rounded to the resolution of a screen.

use crate::command_line::report::six_digits;
use crate::command_line::watch::columns::{self, Curve};
use crate::command_line::watch::run::{Bed, Version, WatchedRun};
use crate::command_line::watch::thinning::{parts, thin};
use serde_json::{Value, json};
use talcum_results::output::readers::ProfileTable;

/// Largest number of points of a curve that a screen can show.
const POINTS: usize = 1_000;
/// Largest numbers of times and heights of the profiles, likewise.
const TIMES: usize = 500;
const HEIGHTS: usize = 250;

/// Progress of the run, and the present versions of the other documents.
pub(super) fn state(run: &WatchedRun) -> Value {
    let overview = run.overview();
    let [series, profile, bed] = run.versions().map(text);
    json!({
        "folder": overview.folder,
        "title": overview.title,
        "state": overview.state.word(),
        "state_text": overview.state.text(),
        "time": overview.time,
        "end": overview.end,
        "part_done": overview.part_done(),
        "progress_text": overview.progress_text(),
        "stage": overview.stage.as_ref().map(|(name, _)| name),
        "pace_text": overview.pace_text(),
        "seconds_left": overview.seconds_left(),
        "warnings": overview.warnings,
        "versions": { "series": series, "profile": profile, "bed": bed },
    })
}

/// All columns of series.csv over time, and those to be drawn.
pub(super) fn series(run: &WatchedRun, wanted: &[String]) -> Value {
    let Some(series) = run.series() else { return Value::Null };
    let chosen = columns::chosen(wanted, series);
    let names: Vec<&str> = chosen.iter().map(|curve| curve.name.as_str()).collect();
    let curves: Vec<Value> = columns::all(series).iter().map(curve).collect();
    json!({
        "version": text(run.series_version()),
        "time_unit": run.overview().time_unit,
        "chosen": names,
        "curves": curves,
    })
}

fn curve(curve: &Curve) -> Value {
    let points = thin(&curve.points, POINTS);
    let (times, values): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
    json!({ "name": curve.name, "title": curve.title(), "times": times, "values": values })
}

/// The solids fraction over height and time, averaged over parts that a screen cannot resolve.
pub(super) fn profile(run: &mut WatchedRun) -> Value {
    let Some((table, version)) = run.profiles() else { return Value::Null };
    let times: Vec<f64> =
        parts(table.times.len(), TIMES).map(|part| table.times[part.start]).collect();
    let heights: Vec<f64> =
        parts(table.heights.len(), HEIGHTS).map(|part| table.heights[part.start]).collect();
    json!({
        "version": version.to_string(),
        "times": times,
        "last_time": table.times.last(),
        "heights": heights,
        "top": table.heights.last(),
        "solids_fraction": fractions(table),
    })
}

/// Means of the solids fraction, one row for each part of the times.
fn fractions(table: &ProfileTable) -> Vec<Vec<f64>> {
    let mean = |times: &std::ops::Range<usize>, heights: std::ops::Range<usize>| {
        let count = (times.len() * heights.len()).max(1) as f64;
        let rows = times.clone().map(|row| &table.solids_fraction(row)[heights.clone()]);
        let sum: f64 = rows.flatten().sum();
        (1.0e4 * sum / count).round() / 1.0e4
    };
    let row =
        |times| parts(table.heights.len(), HEIGHTS).map(|heights| mean(&times, heights)).collect();
    parts(table.times.len(), TIMES).map(row).collect()
}

/// The particles in front, from back to front.
pub(super) fn bed(run: &mut WatchedRun) -> Value {
    let lengths = run.box_lengths();
    let Some((bed, version)) = run.bed() else { return Value::Null };
    let numbers = |number: fn(&Bed, usize) -> f64| -> Vec<f64> {
        (0..bed.seen.len()).map(|place| six_digits(number(bed, place))).collect()
    };
    json!({
        "version": version.to_string(),
        "time": bed.time,
        "box": lengths,
        "count": bed.count,
        "x": numbers(|bed, place| bed.seen[place].position[0]),
        "z": numbers(|bed, place| bed.seen[place].position[2]),
        "radius": numbers(|bed, place| bed.seen[place].radius),
        "speed": numbers(|bed, place| bed.seen[place].speed),
    })
}

fn text(version: Option<Version>) -> Option<String> {
    version.map(|version| version.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_profiles_become_means_over_parts() {
        let (times, heights) = (2 * TIMES, 3);
        let table = ProfileTable {
            heights: vec![0.0, 1.0, 2.0],
            times: (0..times).map(|n| n as f64).collect(),
            superficial_velocities: vec![0.0; times],
            solids_fractions: (0..times * heights)
                .map(|n| (n / heights % 2) as f64 * 0.5)
                .collect(),
            solids_velocities: vec![0.0; times * heights],
        };
        let means = fractions(&table);
        assert_eq!((means.len(), means[0].as_slice()), (TIMES, [0.25; 3].as_slice()));
        // Negative control: a short table keeps its rows.
        let short = table.between(0.0, 1.0);
        assert_eq!(fractions(&short), [[0.0; 3], [0.5; 3]]);
    }
}
