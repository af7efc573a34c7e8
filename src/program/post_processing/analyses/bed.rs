//! Height of the bed by three definitions, expansion, solids fraction of the bulk, and pressure drop.

use crate::post_processing::result_file::ResultFile;
use crate::post_processing::{Analysis, Findings, Kind, Results, Unmeasured};
use talcum_engine::fields::{Column, Unit};
use talcum_results::analysis::bed_height::{
    BedHeight, BedHeightOptions, Profile, bed_height, bulk_solids_fraction, expansion,
};
use talcum_results::analysis::statistics::{correlated_mean, moments};
use talcum_results::analysis::{Estimate, NoValue};
use talcum_results::output::readers::ProfileTable;
use talcum_results::output::{ColumnUnits, ResultTable};

pub(super) const ANALYSIS: Analysis = Analysis {
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
    of_case: |case| ResultFile::Profiles.require_of(case),
    find,
};

const HEIGHT: Kind =
    Kind::number("height", Unit::Length, "height below which 95 % of the mass lie, over 0.95");
const BY_CENTRE: Kind =
    Kind::number("height_by_centre", Unit::Length, "twice the height of the centre of mass");
const BY_THRESHOLD: Kind = Kind::number(
    "height_by_threshold",
    Unit::Length,
    "where the solids fraction falls through output.bed_threshold",
);
const BOTTOM: Kind =
    Kind::number("bottom", Unit::Length, "where the solids fraction rises through it");
const EXPANSION: Kind = Kind::number(
    "expansion",
    Unit::One,
    "bed.height over its least value of the whole run, less 1",
);
const SOLIDS_FRACTION: Kind = Kind::number(
    "solids_fraction",
    Unit::One,
    "of the bulk: without the layers at plate and surface",
);
const WEIGHT: Kind =
    Kind::number("weight_per_area", Unit::Pressure, "weight of the bed over the cross-section");
const PRESSURE_DROP: Kind =
    Kind::number("pressure_drop", Unit::Pressure, "mean pressure drop of the gas");
const OVER_WEIGHT: Kind =
    Kind::number("pressure_drop_over_weight", Unit::One, "the same over the weight per area");

/// Data from one profile.
#[derive(Clone, Copy)]
struct Shape {
    height: BedHeight,
    /// Height by mass; for a uniform bed its whole height.
    by_mass: f64,
    bulk: f64,
}

fn find(results: &Results) -> Result<Findings, Unmeasured> {
    let case = results.case()?;
    let options =
        BedHeightOptions { threshold: case.output.bed_threshold, ..BedHeightOptions::default() };
    let part = results.lowest_node_part()?;
    let whole = results.whole_profiles()?;
    let profiles = results.profiles()?;
    let first = whole.times.partition_point(|&time| time < profiles.times[0]);
    let shapes: Vec<Result<Shape, NoValue>> =
        (0..whole.times.len()).map(|row| shape_of(whole, row, part, &options)).collect();
    let with_bed = shapes.iter().flatten().map(|shape| shape.by_mass);
    let least = with_bed.fold(f64::INFINITY, f64::min);
    // Particles that still fall, or are scattered, are not a bed.
    let counted = &shapes[first..first + profiles.times.len()];
    let timed = profiles.times.iter().zip(counted);
    let (times, shown): (Vec<f64>, Vec<Shape>) =
        timed.filter_map(|(time, shape)| Some((*time, *shape.as_ref().ok()?))).unzip();
    if let (true, Some(Err(reason))) = (shown.is_empty(), counted.last()) {
        return Err(reason.clone().into());
    }

    let mut found = Findings::new(results.units());
    let mean = |of: &dyn Fn(&Shape) -> f64| mean_of(&shown.iter().map(of).collect::<Vec<_>>());
    let height = mean(&|shape| shape.by_mass);
    found.add(&HEIGHT, height.clone());
    found.add(&BY_CENTRE, mean(&|shape| shape.height.by_centre_of_mass));
    found.add(&BY_THRESHOLD, mean(&|shape| shape.height.by_threshold));
    found.add(&BOTTOM, mean(&|shape| shape.height.bottom));
    found.add(&EXPANSION, height.and_then(|height| expanded(height, least)));
    found.add(&SOLIDS_FRACTION, mean(&|shape| shape.bulk));
    add_weight_and_pressure_drop(&mut found, results)?;
    found.tables.push(table(&times, &shown, results.units()));
    if shown.len() < counted.len() {
        let without = counted.len() - shown.len();
        found.note(format!(
            "{without} of {} profiles count for nothing: the solids fraction is nowhere above {}, or there is no bulk",
            counted.len(),
            options.threshold
        ));
    }
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
    // The lowest node then represents half a spacing, whatever its averaging volume.
    solids_fractions[0] *= lowest_part;
    let spacing = second - first;
    let profile = Profile { solids_fractions: &solids_fractions, spacing };
    let height = bed_height(&profile, options)?;
    let by_mass = height.by_mass / options.mass_share;
    let bulk = bulk_solids_fraction(&profile, options)?;
    Ok(Shape { height, by_mass, bulk })
}

/// The mean with its error; without an error if the values do not give one.
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

/// Means over the rows of the series.
fn add_weight_and_pressure_drop(found: &mut Findings, results: &Results) -> Result<(), Unmeasured> {
    let area = results.case()?.domain.cross_section();
    let columns = || -> Result<[Vec<f64>; 2], Unmeasured> {
        Ok([results.column("weight")?, results.column("grid_pressure_drop")?])
    };
    let means = match columns() {
        Ok([weights, drops]) => {
            let weights: Vec<f64> = weights.iter().map(|weight| weight / area).collect();
            let pressures = weights.iter().zip(&drops).map(|(weight, drop)| drop * weight);
            [mean_of(&weights), mean_of(&pressures.collect::<Vec<_>>()), mean_of(&drops)]
        }
        Err(unmeasured) => {
            let reason = match unmeasured {
                Unmeasured::Nothing(reason) => reason,
                Unmeasured::Unreadable(error) => NoValue::because(error.to_string()),
            };
            [(); 3].map(|()| Err(reason.clone()))
        }
    };
    for (kind, mean) in [WEIGHT, PRESSURE_DROP, OVER_WEIGHT].iter().zip(means) {
        found.add(kind, mean);
    }
    Ok(())
}

fn table(times: &[f64], shapes: &[Shape], units: ColumnUnits) -> ResultTable {
    let lengths = |name: &str, about: &str, of: &dyn Fn(&Shape) -> f64| {
        Column::numbers(name, units.of(Unit::Length), about, shapes.iter().map(of).collect())
    };
    let bulk = shapes.iter().map(|shape| shape.bulk).collect();
    let columns = vec![
        Column::numbers("time", units.of(Unit::Time), "of the profile", times.to_vec()),
        lengths("height", HEIGHT.meaning, &|shape| shape.by_mass),
        lengths("height_by_centre", BY_CENTRE.meaning, &|shape| shape.height.by_centre_of_mass),
        lengths("height_by_threshold", BY_THRESHOLD.meaning, &|shape| shape.height.by_threshold),
        lengths("bottom", BOTTOM.meaning, &|shape| shape.height.bottom),
        Column::numbers("solids_fraction", "1", SOLIDS_FRACTION.meaning, bulk),
    ];
    ResultTable::new("bed/times", columns)
}
