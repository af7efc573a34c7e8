//! Mixing and dispersion of the particles, from their snapshots.

use crate::post_processing::result_file::ResultFile;
use crate::post_processing::{Analysis, Findings, Kind, Results, Unmeasured, Value};
use std::f64::consts::PI;
use talcum_engine::fields::{Column, Unit};
use talcum_engine::parallel::OneRank;
use talcum_results::analysis::mixing::{
    Dispersion, Displacements, LaceyIndex, MeanDisplacement, Positioned, Sample, lacey_index,
};
use talcum_results::analysis::statistics::{SampleMean, median};
use talcum_results::analysis::{NoValue, Ownership, Periodicity};
use talcum_results::output::readers::{ParticleSnapshot, ParticleSnapshotReader};
use talcum_results::output::{ColumnUnits, ResultTable};

pub(super) const ANALYSIS: Analysis = Analysis {
    name: "mixing",
    title: "Mixing and dispersion of the particles",
    scalars: || {
        let (fitted, secant) = (DISPERSION.into_iter(), SECANT.into_iter());
        fitted.chain(secant).chain([LACEY, LACEY_BY_SIZE]).collect()
    },
    of_case: |case| ResultFile::Particles.require_of(case),
    find,
};

const DISPERSION: [Kind; 3] =
    [fitted("dispersion_x"), fitted("dispersion_y"), fitted("dispersion_z")];
const SECANT: [Kind; 3] = [secant("secant_x"), secant("secant_y"), secant("secant_z")];

const fn fitted(name: &'static str) -> Kind {
    let meaning =
        "D: slope of half the mean square displacement, over the second half of each window";
    Kind::number(name, Unit::Diffusivity, meaning)
}

const fn secant(name: &'static str) -> Kind {
    let meaning = "D by the largest secant, as Liu et al. (2016) take it";
    Kind::number(name, Unit::Diffusivity, meaning)
}

const LACEY: Kind = Kind::number(
    "lacey",
    Unit::One,
    "Lacey index at the end, of the particles that were in the lower half of the bed at the start",
);
const LACEY_BY_SIZE: Kind = Kind::number(
    "lacey_by_size",
    Unit::One,
    "Lacey index at the end, of the particles no larger than the median, or smaller if none is larger",
);

/// Number of successive windows, whose scatter gives the error of D.
const WINDOWS: usize = 5;
/// Smallest number of snapshots in a window, including its start.
const FEWEST: usize = 4;
/// Mean number of particles in a cell for the Lacey index, and the smallest number in a cell that counts.
const PER_CELL: f64 = 30.0;
const LEAST_PER_CELL: u64 = 8;

fn find(results: &Results) -> Result<Findings, Unmeasured> {
    let snapshots = results.particle_snapshots()?;
    let periodicity = results.periodicity()?;
    let count = snapshots.times.len();
    if count < 2 {
        return Err(NoValue::because("there is one snapshot; displacements need two").into());
    }
    let first = snapshots.snapshot(0)?;
    let mut found = Findings::new(results.units());
    let paths = Paths::follow(&snapshots, periodicity)?;
    let dispersed = |sample: Option<SampleMean>| {
        let few = || {
            NoValue::because(format!(
                "{count} snapshots are too few: {WINDOWS} windows of {FEWEST} are needed, and some motion in them"
            ))
        };
        Value::from(sample.map(|sample| sample.mean).ok_or_else(few))
    };
    for (axis, kind) in DISPERSION.iter().enumerate() {
        found.add(kind, dispersed(paths.dispersion.fitted(axis, paths.fit_from)));
    }
    for (axis, kind) in SECANT.iter().enumerate() {
        found.add(kind, dispersed(paths.dispersion.by_secants(axis)));
    }
    let cells = MixingCells::of(&first, results)?;
    let lacey = |found: Option<LaceyIndex>| {
        let none = || {
            NoValue::because("the cells hold one class of particles only, or there is but one cell")
        };
        found.ok_or_else(none)
    };
    let indices = cells.over_time(&snapshots, &first)?;
    let last = |of: fn(&MixingRow) -> Option<LaceyIndex>| {
        lacey(indices.last().and_then(of))
            .map(|found| Value::Number { value: found.index, error: Some(found.error) })
    };
    found.add(&LACEY, last(|row| row.by_place));
    found.add(&LACEY_BY_SIZE, last(|row| row.by_size));
    found.tables = vec![
        displacement_table(&paths.curve, results.units()),
        lacey_table(&indices, results.units()),
    ];
    found.note(format!(
        "{WINDOWS} windows of {:.4} each; cells of the Lacey index have edges of {:.4}",
        paths.window, cells.edge
    ));
    found.notes.extend(paths.warning);
    Ok(found)
}

/// Displacements of the particles.
struct Paths {
    dispersion: Dispersion,
    /// Duration of a window, and the lag from which the line is fitted.
    window: f64,
    fit_from: f64,
    /// Time since the first snapshot, and moments of the displacements since then.
    curve: Vec<(f64, MeanDisplacement)>,
    warning: Option<String>,
}

impl Paths {
    /// Follows the particles through all snapshots.
    fn follow(
        snapshots: &ParticleSnapshotReader,
        periodicity: Periodicity,
    ) -> Result<Self, Unmeasured> {
        let times = &snapshots.times;
        let steps = ((times.len() - 1) / WINDOWS).max(1);
        let start = positions(&snapshots.snapshot(0)?);
        let mut since_start = Displacements::begin(&start, periodicity);
        let mut in_window = since_start.clone();
        let (mut dispersion, mut curve) = (Dispersion::default(), Vec::new());
        let (mut window_start, mut fastest) = (0, 0.0_f64);
        for number in 1..times.len() {
            let snapshot = snapshots.snapshot(number)?;
            let interval = times[number] - times[number - 1];
            fastest = fastest.max(interval * fastest_across(&snapshot, &periodicity));
            let now = positions(&snapshot);
            let owned = Ownership::of(now.iter().map(|particle| particle.id).collect());
            since_start.look(&now, &owned, &OneRank);
            in_window.look(&now, &owned, &OneRank);
            let Some(total) = since_start.mean(&OneRank) else { break };
            curve.push((times[number] - times[0], total));
            if let Some(mean) = in_window.mean(&OneRank) {
                dispersion.add(times[number] - times[window_start], mean.half_square().into());
            }
            if number - window_start == steps {
                if steps + 1 >= FEWEST {
                    dispersion.end_window();
                }
                in_window.restart();
                window_start = number;
            }
        }
        let window = times[steps] - times[0];
        let warning = (fastest > 0.5).then(|| format!(
            "some particle may move {fastest:.2} of a periodic length between two snapshots: beyond 0.5 displacements are \
             not certain; write snapshots more often"
        ));
        Ok(Self { dispersion, window, fit_from: 0.5 * window, curve, warning })
    }
}

/// Positions of the particles, by ascending id.
fn positions(snapshot: &ParticleSnapshot) -> Vec<Positioned> {
    let particles = snapshot.ids.iter().zip(&snapshot.positions);
    let positioned =
        |(&id, &position): (&u64, &[f64; 3])| Positioned { id, position: position.into() };
    let mut positions: Vec<Positioned> = particles.map(positioned).collect();
    positions.sort_by_key(|particle| particle.id);
    positions
}

/// The largest ratio of a velocity component to the periodic length of its axis.
fn fastest_across(snapshot: &ParticleSnapshot, periodicity: &Periodicity) -> f64 {
    let fastest = |axis: usize| {
        snapshot.velocities.iter().map(|velocity| velocity[axis].abs()).fold(0.0, f64::max)
    };
    periodicity.periodic_axes().map(|(axis, length)| fastest(axis) / length).fold(0.0, f64::max)
}

/// Cells in which tracers are counted.
struct MixingCells {
    edge: f64,
    counts: [usize; 3],
    sizes: [f64; 3],
    /// Height that separates the tracers from the others at the start.
    middle: f64,
    /// Largest radius of the particles that count as small: the median, or the next smaller radius if none is above it.
    small_radius: f64,
}

/// Lacey indices at one time.
struct MixingRow {
    time: f64,
    by_place: Option<LaceyIndex>,
    by_size: Option<LaceyIndex>,
}

impl MixingCells {
    /// Nearly cubic cells that contain [`PER_CELL`] particles on average: across the box, up to the top of the bed.
    fn of(first: &ParticleSnapshot, results: &Results) -> Result<Self, Unmeasured> {
        let lengths = results.case()?.domain.bounds.lengths();
        let heights: Vec<f64> = first.positions.iter().map(|position| position[2]).collect();
        let (Some(middle), Some(median_radius)) = (median(&heights), median(&first.radii)) else {
            return Err(NoValue::because("the first snapshot holds no particles").into());
        };
        let volume: f64 = first.radii.iter().map(|radius| 4.0 / 3.0 * PI * radius.powi(3)).sum();
        // The bed is assumed to be half solid; the number of particles in a cell need not be exact.
        let edge = libm::cbrt(PER_CELL * 2.0 * volume / first.ids.len() as f64);
        let counts = [0, 1, 2].map(|axis| libm::round(lengths[axis] / edge).max(1.0) as usize);
        let sizes = [0, 1, 2].map(|axis| lengths[axis] / counts[axis] as f64);
        let below = first.radii.iter().copied().filter(|&radius| radius < median_radius);
        let small_radius = if first.radii.iter().any(|&radius| radius > median_radius) {
            median_radius
        } else {
            below.fold(f64::NEG_INFINITY, f64::max)
        };
        Ok(Self { edge, counts, sizes, middle, small_radius })
    }

    fn cell_of(&self, position: &[f64; 3]) -> u64 {
        let index = |axis: usize| {
            let place = (position[axis] / self.sizes[axis]).max(0.0) as usize;
            place.min(self.counts[axis] - 1)
        };
        ((index(2) * self.counts[1] + index(1)) * self.counts[0] + index(0)) as u64
    }

    fn over_time(
        &self,
        snapshots: &ParticleSnapshotReader,
        first: &ParticleSnapshot,
    ) -> Result<Vec<MixingRow>, Unmeasured> {
        let was_below = |id: u64| {
            let place = first.ids.binary_search(&id);
            place.is_ok_and(|place| first.positions[place][2] < self.middle)
        };
        let mut rows = Vec::new();
        for (number, &time) in snapshots.times.iter().enumerate() {
            let now = snapshots.snapshot(number)?;
            let by_place = self.index(&now, &|index| was_below(now.ids[index]));
            let by_size = self.index(&now, &|index| now.radii[index] <= self.small_radius);
            rows.push(MixingRow { time, by_place, by_size });
        }
        Ok(rows)
    }

    fn index(
        &self,
        now: &ParticleSnapshot,
        is_tracer: &dyn Fn(usize) -> bool,
    ) -> Option<LaceyIndex> {
        let sample =
            |(index, position)| Sample { cell: self.cell_of(position), tracer: is_tracer(index) };
        let samples: Vec<Sample> = now.positions.iter().enumerate().map(sample).collect();
        lacey_index(&samples, self.counts.iter().product(), LEAST_PER_CELL, &OneRank)
    }
}

fn displacement_table(curve: &[(f64, MeanDisplacement)], units: ColumnUnits) -> ResultTable {
    let area = format!("({})^2", units.of(Unit::Length));
    let lags = curve.iter().map(|(lag, _)| *lag).collect();
    let mut columns =
        vec![Column::numbers("lag", units.of(Unit::Time), "since the first snapshot", lags)];
    for (axis, name) in ["half_square_x", "half_square_y", "half_square_z"].into_iter().enumerate()
    {
        let values = curve.iter().map(|(_, mean)| mean.half_square()[axis]).collect();
        columns.push(Column::numbers(name, &area, "half the mean square displacement", values));
    }
    ResultTable::new("mixing/displacements", columns)
}

fn lacey_table(rows: &[MixingRow], units: ColumnUnits) -> ResultTable {
    let index = |name: &str, about: &str, of: fn(&MixingRow) -> Option<LaceyIndex>| {
        let values = rows.iter().map(|row| of(row).map_or(f64::NAN, |found| found.index)).collect();
        Column::numbers(name, "1", about, values)
    };
    let times = rows.iter().map(|row| row.time).collect();
    let columns = vec![
        Column::numbers("time", units.of(Unit::Time), "of the snapshot", times),
        index("lacey", "of what was below at the start", |row| row.by_place),
        index("lacey_by_size", "of the smaller particles", |row| row.by_size),
    ];
    ResultTable::new("mixing/lacey", columns)
}
