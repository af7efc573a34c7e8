//! Height of the bed by three definitions, expansion, solids fraction of the bulk, and pressure drop.

use crate::analysis::bed_height::{
    BedHeight, BedHeightOptions, Profile, bed_height, bulk_solids_fraction, expansion,
};
use crate::analysis::statistics::{correlated_mean, moments};
use crate::analysis::{Estimate, NoValue, Quantity};
use crate::output::readers::ProfileTable;
use crate::output::{Column, ColumnUnits, ResultTable};
use crate::post_processing::evenly_spaced::nearest;
use crate::post_processing::{Findings, Kind, Measure, Results, Unmeasured, Value};

pub(super) const MEASURE: Measure = Measure {
    name: "bed",
    title: "The bed: means over the times that count",
    scalars: || {
        vec![
            HEIGHT,
            BY_CENTRE,
            BY_THRESHOLD,
            BOTTOM,
            EXPANSION,
            SOLIDS_FRACTION,
            WEIGHT,
            PRESSURE_DROP,
            OVER_WEIGHT,
        ]
    },
    find,
};

const HEIGHT: Kind =
    Kind::number("height", Quantity::Length, "height below which 95 % of the mass lie, over 0.95");
const BY_CENTRE: Kind =
    Kind::number("height_by_centre", Quantity::Length, "twice the height of the centre of mass");
const BY_THRESHOLD: Kind = Kind::number(
    "height_by_threshold",
    Quantity::Length,
    "where the solids fraction falls through output.bed_threshold",
);
const BOTTOM: Kind =
    Kind::number("bottom", Quantity::Length, "where the solids fraction rises through it");
const EXPANSION: Kind = Kind::number(
    "expansion",
    Quantity::Number,
    "bed.height over its least value of the whole run, less 1",
);
const SOLIDS_FRACTION: Kind = Kind::number(
    "solids_fraction",
    Quantity::Number,
    "of the bulk: without the layers at plate and surface",
);
const WEIGHT: Kind =
    Kind::number("weight_per_area", Quantity::Pressure, "weight of the bed over the cross-section");
const PRESSURE_DROP: Kind =
    Kind::number("pressure_drop", Quantity::Pressure, "mean pressure drop of the gas");
const OVER_WEIGHT: Kind = Kind::number(
    "pressure_drop_over_weight",
    Quantity::Number,
    "the same over the weight per area",
);

/// What is read off one profile.
#[derive(Clone, Copy)]
struct Shape {
    height: BedHeight,
    /// Height by mass, of a uniform bed its whole height.
    by_mass: f64,
    bulk: f64,
    /// Volume of solids over the cross-section.
    solids: f64,
}

fn find(results: &Results) -> Result<Findings, Unmeasured> {
    let case = results.case()?;
    let options =
        BedHeightOptions { threshold: case.output.bed_threshold, ..BedHeightOptions::default() };
    let part = results.lowest_node_part()?;
    let whole = results.whole_profiles()?;
    let shapes: Result<Vec<Shape>, NoValue> =
        (0..whole.times.len()).map(|row| shape_of(whole, row, part, &options)).collect();
    let shapes = shapes?;
    let profiles = results.profiles()?;
    let first = whole.times.partition_point(|&time| time < profiles.times[0]);
    let shown = &shapes[first..first + profiles.times.len()];
    let least = shapes.iter().map(|shape| shape.by_mass).fold(f64::INFINITY, f64::min);

    let mut found = Findings::new(results.units());
    let mean = |of: &dyn Fn(&Shape) -> f64| mean_of(&shown.iter().map(of).collect::<Vec<_>>());
    let height = mean(&|shape| shape.by_mass);
    found.add(&HEIGHT, height.clone());
    found.add(&BY_CENTRE, mean(&|shape| shape.height.by_centre_of_mass));
    found.add(&BY_THRESHOLD, mean(&|shape| shape.height.by_threshold));
    found.add(&BOTTOM, mean(&|shape| shape.height.bottom));
    found.add(&EXPANSION, height.and_then(|height| expanded(height, least)));
    found.add(&SOLIDS_FRACTION, mean(&|shape| shape.bulk));
    let stage = results.stages()?.last().or(case.stages.last());
    let gravity = stage.map_or(0.0, |stage| stage.physics.gravity.magnitude);
    let weight = |shape: &Shape| case.particles.density * gravity * shape.solids;
    found.add(&WEIGHT, mean(&weight));
    let weights = shapes.iter().map(weight).collect();
    add_pressure_drop(&mut found, results, &WeightOverTime { times: &whole.times, weights });
    found.tables.push(table(&profiles.times, shown, &results.units()));
    Ok(found)
}

fn shape_of(
    profiles: &ProfileTable,
    row: usize,
    lowest_part: f64,
    options: &BedHeightOptions,
) -> Result<Shape, NoValue> {
    let mut solids_fractions = profiles.solids_fraction(row).to_vec();
    let [first, second, ..] = profiles.heights[..] else {
        return Err(NoValue::because("the profiles have fewer than two heights"));
    };
    // The lowest node then stands for half a spacing, whatever it averages over.
    solids_fractions[0] *= lowest_part;
    let spacing = second - first;
    let profile = Profile { solids_fractions: &solids_fractions, spacing };
    let height = bed_height(&profile, options)?;
    let by_mass = height.by_mass / options.mass_share;
    let bulk = bulk_solids_fraction(&profile, options)?;
    let solids = solids_fractions.iter().sum::<f64>() * spacing;
    Ok(Shape { height, by_mass, bulk, solids })
}

/// The mean with its error; without an error where the values do not tell one.
fn mean_of(values: &[f64]) -> Result<Estimate, NoValue> {
    match correlated_mean(values) {
        Ok(found) => Ok(found.mean),
        Err(_) => moments(values).map(|found| Estimate { value: found.mean, error: f64::INFINITY }),
    }
}

fn expanded(height: Estimate, least: f64) -> Result<Estimate, NoValue> {
    let value = expansion(height.value, least)?;
    Ok(Estimate { value, error: height.error / least })
}

/// Weight per area at the times of the profiles.
struct WeightOverTime<'a> {
    times: &'a [f64],
    weights: Vec<f64>,
}

/// Mean of the series' pressure drop, over the weight and times the weight per area of the nearest profile.
fn add_pressure_drop(found: &mut Findings, results: &Results, bed: &WeightOverTime) {
    let drops = || -> Result<(Vec<f64>, Vec<f64>), Unmeasured> {
        let drops = results.column("grid_pressure_drop")?;
        let times = results.column("time")?;
        let weight = |time: &f64| bed.weights[nearest(bed.times, *time)];
        let pressures = times.iter().zip(&drops).map(|(time, drop)| drop * weight(time));
        Ok((pressures.collect(), drops))
    };
    match drops() {
        Ok((pressures, drops)) => {
            found.add(&PRESSURE_DROP, mean_of(&pressures));
            found.add(&OVER_WEIGHT, mean_of(&drops));
        }
        Err(Unmeasured::Nothing(reason)) => {
            found.add(&PRESSURE_DROP, Value::Nothing(reason.clone()));
            found.add(&OVER_WEIGHT, Value::Nothing(reason));
        }
        Err(Unmeasured::Unreadable(error)) => {
            let reason = NoValue::because(error.to_string());
            found.add(&PRESSURE_DROP, Value::Nothing(reason.clone()));
            found.add(&OVER_WEIGHT, Value::Nothing(reason));
        }
    }
}

fn table(times: &[f64], shapes: &[Shape], units: &ColumnUnits) -> ResultTable {
    let lengths = |name: &str, about: &str, of: &dyn Fn(&Shape) -> f64| {
        Column::numbers(name, units.length, about, shapes.iter().map(of).collect())
    };
    let bulk = shapes.iter().map(|shape| shape.bulk).collect();
    let columns = vec![
        Column::numbers("time", units.time, "of the profile", times.to_vec()),
        lengths("height", HEIGHT.meaning, &|shape| shape.by_mass),
        lengths("height_by_centre", BY_CENTRE.meaning, &|shape| shape.height.by_centre_of_mass),
        lengths("height_by_threshold", BY_THRESHOLD.meaning, &|shape| shape.height.by_threshold),
        lengths("bottom", BOTTOM.meaning, &|shape| shape.height.bottom),
        Column::numbers("solids_fraction", "1", SOLIDS_FRACTION.meaning, bulk),
    ];
    ResultTable::new("bed/times", columns)
}
