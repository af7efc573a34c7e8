//! Solids flux through planes, and residence times between them, from snapshots of the particles.

use crate::post_processing::result_file::ResultFile;
use crate::post_processing::{Analysis, Findings, Kind, Results, Unmeasured, Value};
use std::f64::consts::PI;
use talcum_engine::fields::{Column, Unit};
use talcum_results::analysis::NoValue;
use talcum_results::analysis::bed_height::{BedHeightOptions, Profile, bed_height};
use talcum_results::analysis::residence::{
    Crossing, Gate, ResidenceTimes, SolidsFlux, residence_times, solids_flux,
};
use talcum_results::output::readers::{ParticleSnapshot, ParticleSnapshotReader};
use talcum_results::output::{Cells, ColumnUnits, ResultTable};

pub(super) const ANALYSIS: Analysis = Analysis {
    name: "flux",
    title: "Solids flux through planes in the bed, and residence time between them",
    scalars: || vec![UP, NET, RESIDENCE, PASSAGES],
    of_case: |case| ResultFile::Particles.require_of(case),
    find,
};

const UP: Kind =
    Kind::number("up", Unit::MassFlux, "upwards, through the plane at half the bed's height");
const NET: Kind = Kind::number("net", Unit::MassFlux, "upwards less downwards, there");
const RESIDENCE: Kind = Kind::number(
    "residence_time",
    Unit::Time,
    "mean, from the plane at a quarter of the bed's height up to that at three quarters",
);
const PASSAGES: Kind =
    Kind::number("passages", Unit::One, "number of such passages that are complete");

/// Heights of the planes, as fractions of the bed's height at the first snapshot.
const PLANES: [f64; 3] = [0.25, 0.5, 0.75];
/// Number of bins of the distribution of residence times.
const BINS: usize = 20;
/// Number of cells over the height in which the bed's height is determined.
const LAYERS: f64 = 100.0;

fn find(results: &Results) -> Result<Findings, Unmeasured> {
    let snapshots = results.particle_snapshots()?;
    let domain = &results.case()?.domain;
    let (bounds, area) = (&domain.bounds, domain.cross_section());
    if bounds.is_periodic(2) {
        return Err(NoValue::because("the box repeats along z: there is no lowest plane").into());
    }
    let (first, duration) = match snapshots.times[..] {
        [first, .., last] => (snapshots.snapshot(0)?, last - first),
        _ => return Err(NoValue::because("there is one snapshot; crossings need two").into()),
    };
    let height = height_of(&first, bounds.lengths().z, area)?;
    let planes = PLANES.map(|part| part * height);
    let particles = &results.case()?.particles;
    if particles.has_several_densities() && first.masses.is_none() {
        let reason = "particles differ in density, and snapshots do not show their masses: output.particle_fields = [\"mass\"]";
        return Err(NoValue::because(reason).into());
    }
    let crossings = crossings(&snapshots, &planes, particles.density)?;
    let fluxes = solids_flux(&crossings, planes.len(), area, duration)?;
    let entrance = Gate { plane: 0, upwards: true };
    let exit = Gate { plane: planes.len() - 1, upwards: true };
    let residence = residence_times(&crossings, entrance, exit, BINS);

    let mut found = Findings::new(results.units());
    found.add(&UP, fluxes[1].up);
    found.add(&NET, fluxes[1].net);
    found.add(&RESIDENCE, residence.as_ref().map(|times| times.mean).map_err(Clone::clone));
    let passages = residence.as_ref().map(|times| Value::from(times.passages as f64));
    found.add(&PASSAGES, passages.map_err(Clone::clone));
    found.tables.push(flux_table(&planes, &fluxes, results.units()));
    if let Ok(times) = &residence {
        found.tables.push(residence_table(times, results.units()));
        found.note(format!(
            "{} particles went back through the entrance, {} were still inside at the end: unless they are few, the mean \
             residence time is too small",
            times.returned, times.inside
        ));
    }
    found.note(format!(
        "from {} snapshots: passages up and down between two of them are not seen",
        snapshots.times.len()
    ));
    Ok(found)
}

/// The bed's height by mass at the first snapshot.
fn height_of(first: &ParticleSnapshot, box_height: f64, area: f64) -> Result<f64, NoValue> {
    let spacing = box_height / LAYERS;
    let mut volumes = vec![0.0; LAYERS as usize + 1];
    for (position, radius) in first.positions.iter().zip(&first.radii) {
        let layer = libm::round(position[2] / spacing).clamp(0.0, LAYERS) as usize;
        volumes[layer] += 4.0 / 3.0 * PI * radius.powi(3);
    }
    let solids_fractions: Vec<f64> =
        volumes.iter().map(|volume| volume / (area * spacing)).collect();
    // Any solids belong to the bed: only the mass is needed.
    let options = BedHeightOptions { threshold: f64::MIN_POSITIVE, ..BedHeightOptions::default() };
    let profile = Profile { solids_fractions: &solids_fractions, spacing };
    Ok(bed_height(&profile, &options)?.by_mass / options.mass_share)
}

/// Crossings of planes by centres between two snapshots; their times are found by linear interpolation.
fn crossings(
    snapshots: &ParticleSnapshotReader,
    planes: &[f64],
    density: f64,
) -> Result<Vec<Crossing>, Unmeasured> {
    let mut crossings = Vec::new();
    let mut before = snapshots.snapshot(0)?;
    for number in 1..snapshots.times.len() {
        let after = snapshots.snapshot(number)?;
        let interval = [snapshots.times[number - 1], snapshots.times[number]];
        for (index, &id) in after.ids.iter().enumerate() {
            let Ok(place) = before.ids.binary_search(&id) else { continue };
            let heights = [before.positions[place][2], after.positions[index][2]];
            let sphere = density * 4.0 / 3.0 * PI * after.radii[index].powi(3);
            let mass = after.masses.as_ref().map_or(sphere, |masses| masses[index]);
            let passed = planes.iter().enumerate();
            crossings.extend(passed.filter_map(|(plane, &height)| {
                let time = time_of_passage(heights, height, interval)?;
                let upwards = heights[1] > heights[0];
                Some(Crossing { particle: id, plane, time, upwards, mass })
            }));
        }
        before = after;
    }
    Ok(crossings)
}

/// Time at which a straight line between two heights passes a plane; a centre on the plane counts as above it.
fn time_of_passage(heights: [f64; 2], plane: f64, interval: [f64; 2]) -> Option<f64> {
    let [below_before, below_after] = heights.map(|height| height < plane);
    let part = (plane - heights[0]) / (heights[1] - heights[0]);
    (below_before != below_after).then(|| interval[0] + part * (interval[1] - interval[0]))
}

fn flux_table(planes: &[f64], fluxes: &[SolidsFlux], units: ColumnUnits) -> ResultTable {
    let flux = |name: &str, of: fn(&SolidsFlux) -> f64| {
        let values = fluxes.iter().map(of).collect();
        Column::numbers(name, units.of(Unit::MassFlux), "of the solids through the plane", values)
    };
    let count = |name: &str, side: usize| {
        let counts = fluxes.iter().map(|flux| flux.crossings[side]).collect();
        Column::new(name, "number of crossings", Cells::Whole(counts))
    };
    let columns = vec![
        Column::numbers("height", units.of(Unit::Length), "of the plane", planes.to_vec()),
        flux("up", |flux| flux.up),
        flux("down", |flux| flux.down),
        flux("net", |flux| flux.net),
        count("crossings_up", 0),
        count("crossings_down", 1),
    ];
    ResultTable::new("flux/planes", columns)
}

fn residence_table(times: &ResidenceTimes, units: ColumnUnits) -> ResultTable {
    let per_time = format!("1/({})", units.of(Unit::Time));
    let columns = vec![
        Column::numbers("time", units.of(Unit::Time), "lower end of the bin", times.times.clone()),
        Column::numbers(
            "density",
            &per_time,
            "of residence times, integral 1",
            times.density.clone(),
        ),
    ];
    ResultTable::new("flux/residence_times", columns)
}
