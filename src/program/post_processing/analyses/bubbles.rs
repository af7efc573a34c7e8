//! Bubbles in a volume-averaged gas.

use crate::post_processing::result_file::ResultFile;
use crate::post_processing::{Analysis, Findings, Kind, Results, Unmeasured, Value};
use std::f64::consts::PI;
use talcum_engine::fields::{Column, Unit};
use talcum_results::analysis::NoValue;
use talcum_results::analysis::bubbles::{
    Bubble, BubbleOptions, Track, TrackingOptions, VoidageField, find_bubbles, track_bubbles,
};
use talcum_results::analysis::statistics::SampleMean;
use talcum_results::output::{Cells, ColumnUnits, ResultTable};

pub(super) const ANALYSIS: Analysis = Analysis {
    name: "bubbles",
    title: "Bubbles: regions of a voidage above 0.7, of four cells or more",
    scalars: || vec![COUNT, DIAMETER, ASPECT, RISE],
    of_case: |case| ResultFile::Gas.require_of(case),
    find,
};

const COUNT: Kind = Kind::number("count", Unit::One, "mean number at a time");
const DIAMETER: Kind = Kind::number(
    "diameter",
    Unit::Length,
    "mean over all bubbles, of the sphere (in a bed of one cell's depth the circle) of equal size",
);
const ASPECT: Kind = Kind::number("aspect_ratio", Unit::One, "mean vertical over horizontal size");
const RISE: Kind =
    Kind::number("rise_velocity", Unit::Speed, "mean of the bubbles that were followed");

/// Largest factor by which a bubble's volume may change between two times: beyond it, the bubble has merged or split.
const LARGEST_GROWTH: f64 = 2.0;
/// Smallest number of times in a track.
const FEWEST_TIMES: usize = 3;

/// A bubble with the time at which it was found.
struct Seen {
    time: f64,
    bubble: Bubble,
}

fn find(results: &Results) -> Result<Findings, Unmeasured> {
    let snapshots = results.gas_snapshots()?;
    let bounds = &results.case()?.domain.bounds;
    let mut frames = Vec::new();
    for number in 0..snapshots.times.len() {
        let field = VoidageField {
            values: &snapshots.voidage(number)?,
            cells: snapshots.cells,
            origin: [0.0; 3],
            spacing: snapshots.spacing,
            periodic: [bounds.is_periodic(0), bounds.is_periodic(1)],
        };
        frames.push(find_bubbles(&field, &BubbleOptions::default())?);
    }
    let seen: Vec<Seen> = frames
        .iter()
        .zip(&snapshots.times)
        .flat_map(|(frame, &time)| frame.iter().map(move |&bubble| Seen { time, bubble }))
        .collect();
    let mut found = Findings::new(results.units());
    found.add(&COUNT, seen.len() as f64 / frames.len() as f64);
    let mean = |of: fn(&Bubble) -> f64| {
        let values: Vec<f64> = seen.iter().map(|seen| of(&seen.bubble)).collect();
        SampleMean::of(&values).map(|sample| sample.mean)
    };
    let diameter = mean(|bubble| bubble.equivalent_diameter);
    found.add(&DIAMETER, diameter.clone());
    found.add(&ASPECT, mean(|bubble| bubble.aspect_ratio));
    let period = |axis: usize| bounds.is_periodic(axis).then(|| bounds.lengths()[axis]);
    let tracks = diameter.and_then(|diameter| {
        let options = TrackingOptions {
            farthest: diameter.value,
            largest_growth: LARGEST_GROWTH,
            periods: [period(0), period(1)],
            fewest_times: FEWEST_TIMES,
        };
        track_bubbles(&snapshots.times, &frames, &options)
    });
    found.add(&RISE, rise(&tracks));
    found.tables = vec![bubble_table(&seen, results.units())];
    found.tables.extend(tracks.ok().map(|tracks| track_table(&tracks, results.units())));
    found.note(
        "a bubble is followed to the nearest one within a mean diameter: it must not rise farther between two times"
            .to_owned(),
    );
    Ok(found)
}

fn rise(tracks: &Result<Vec<Track>, NoValue>) -> Value {
    let rises = |tracks: &Vec<Track>| {
        let rises: Vec<f64> = tracks.iter().map(|track| track.rise_velocity.value).collect();
        SampleMean::of(&rises).map(|sample| sample.mean).map_err(|_| {
            NoValue::because(format!(
                "{} bubbles could be followed over {FEWEST_TIMES} times; two are needed",
                rises.len()
            ))
        })
    };
    tracks.as_ref().map_err(Clone::clone).and_then(rises).into()
}

fn bubble_table(seen: &[Seen], units: ColumnUnits) -> ResultTable {
    let numbers = |name: &str, unit: &str, about: &str, of: &dyn Fn(&Seen) -> f64| {
        Column::numbers(name, unit, about, seen.iter().map(of).collect())
    };
    let place = |axis: usize| move |seen: &Seen| seen.bubble.centroid[axis];
    let encircles = seen.iter().map(|seen| u64::from(seen.bubble.encircles)).collect();
    let columns = vec![
        numbers("time", units.of(Unit::Time), "of the snapshot", &|seen| seen.time),
        numbers("x", units.of(Unit::Length), "centroid", &place(0)),
        numbers("y", units.of(Unit::Length), "centroid", &place(1)),
        numbers("z", units.of(Unit::Length), "centroid", &place(2)),
        numbers(
            "diameter",
            units.of(Unit::Length),
            "of the sphere or circle of equal size",
            &|seen| seen.bubble.equivalent_diameter,
        ),
        numbers(
            "area",
            units.of(Unit::Area),
            "of the circle of that diameter: of the bubble in a flat bed",
            &|seen| 0.25 * PI * seen.bubble.equivalent_diameter.powi(2),
        ),
        numbers("volume", units.of(Unit::Volume), "of its cells", &|seen| seen.bubble.volume),
        numbers("aspect_ratio", "1", "vertical over horizontal size", &|seen| {
            seen.bubble.aspect_ratio
        }),
        Column::new("encircles", "1 if it meets itself around the box", Cells::Whole(encircles)),
    ];
    ResultTable::new("bubbles/seen", columns)
}

fn track_table(tracks: &[Track], units: ColumnUnits) -> ResultTable {
    let numbers = |name: &str, unit: &str, about: &str, of: fn(&Track) -> f64| {
        Column::numbers(name, unit, about, tracks.iter().map(of).collect())
    };
    let mean = |track: &Track, of: fn(&Bubble) -> f64| {
        track.bubbles.iter().map(of).sum::<f64>() / track.bubbles.len() as f64
    };
    let diameters = tracks.iter().map(|track| mean(track, |bubble| bubble.equivalent_diameter));
    let heights = tracks.iter().map(|track| mean(track, |bubble| bubble.centroid[2]));
    let columns = vec![
        numbers("first_time", units.of(Unit::Time), "at which it was seen", |track| track.times[0]),
        numbers("last_time", units.of(Unit::Time), "at which it was seen", |track| {
            track.times.last().copied().unwrap_or(f64::NAN)
        }),
        Column::numbers("height", units.of(Unit::Length), "mean over its times", heights.collect()),
        Column::numbers(
            "diameter",
            units.of(Unit::Length),
            "mean over its times",
            diameters.collect(),
        ),
        numbers("rise_velocity", units.of(Unit::Speed), "slope of its height", |t| {
            t.rise_velocity.value
        }),
        numbers("rise_error", units.of(Unit::Speed), "its standard error", |t| {
            t.rise_velocity.error
        }),
    ];
    ResultTable::new("bubbles/tracks", columns)
}
