//! Rows of the file of agglomerates.

use super::columns::{EVENTS, FRAGMENTS, RATES, RESULTS, SINGLE, WINDOWS};
use super::{Agglomerates, Found};
use crate::analysis::agglomerates::{Agglomerate, MassWeightedMeans, Search, SizeDistribution};
use crate::analysis::breakage::{AtLag, CriticalTimes, Fate, Fragment, RatesOfSize, crossing};
use crate::analysis::{MassRadius, PopulationFit, totals};
use crate::instruments::Rows;
use talcum_engine::parallel::{Communicator, Message, records_of_bytes};

/// Largest number of members for the mass within a radius: the rank of an agglomerate's label gathers its members, and
/// computes up to 2000 distances from each. This excludes a whole bed.
const MOST_MEMBERS: u64 = 20_000;

const UNDEFINED: f64 = f64::NAN;

/// The rows of a sample, and the data that critical times need. Collective.
pub(super) fn of_look(
    found: &Found,
    search: &Search<'_>,
    lag: f64,
    settings: &Agglomerates,
    ranks: &dyn Communicator,
) -> (Vec<Rows>, AtLag) {
    let all = &found.found[..];
    let means = MassWeightedMeans::of(all, ranks);
    let population = PopulationFit::of(all, ranks);
    let [whole] = totals(search.particles.iter().map(|particle| [particle.mass]), ranks);
    let motion = all.iter().map(|a| [a.mass * a.velocity.z, a.mass * a.velocity.norm()]);
    let [up, speed] = totals(motion, ranks);
    let largest = largest_of(all, ranks);
    let mean = |of: fn(&MassWeightedMeans) -> f64| means.as_ref().map_or(UNDEFINED, of);
    let count = means.as_ref().map_or(0, |means| means.count);
    let mass = means.as_ref().map_or(0.0, |means| means.mass);
    let per_mass = |sum: f64| if mass > 0.0 { sum / mass } else { UNDEFINED };
    let scalars = [
        lag,
        count as f64,
        mass,
        mass / whole,
        mean(|means| means.members),
        largest.members as f64,
        mean(|means| means.diameter),
        mean(|means| means.coordination_number),
        mean(|means| means.coordination_within),
        mean(|means| means.packing_fraction),
        mean(|means| means.fractal_dimension),
        population.map_or(UNDEFINED, |fit| fit.dimension),
        population.map_or(UNDEFINED, |fit| fit.error),
        per_mass(up),
        per_mass(speed),
    ];
    let mut row: Vec<Vec<f64>> = scalars.map(|value| vec![value]).to_vec();
    let limits: Vec<f64> = settings.sizes.iter().map(|&size| size as f64).collect();
    let sizes = SizeDistribution::of(all, |a| a.members as f64, &limits, ranks);
    row.push(sizes.number.iter().map(|&number| number as f64).collect());
    row.push(sizes.mass);
    let rows = vec![Rows::one(RESULTS, row), single(all, lag, ranks)];
    (rows, AtLag { lag, count, diameter: mean(|means| means.diameter) })
}

/// The largest agglomerate.
#[derive(Clone, Copy, Debug)]
struct Largest {
    label: u64,
    /// Number of members; 0 if there is no agglomerate.
    members: u64,
}

/// Finds the largest agglomerate; among equal ones, the one with the smallest label. Collective.
fn largest_of(found: &[Agglomerate], ranks: &dyn Communicator) -> Largest {
    // Numbers of particles and ids are exact in double precision.
    let mut members = [found.iter().map(|a| a.members).max().unwrap_or(0) as f64];
    ranks.maximum(&mut members);
    let members = members[0] as u64;
    let labels = found.iter().filter(|a| a.members == members).map(|a| -(a.label as f64));
    let mut label = [labels.fold(f64::NEG_INFINITY, f64::max)];
    ranks.maximum(&mut label);
    Largest { label: -label[0] as u64, members }
}

/// D_f of the largest agglomerate by its mass within a radius; undefined if it is too small or too large. Collective.
fn mass_radius_dimension(found: &Found, search: &Search<'_>, ranks: &dyn Communicator) -> f64 {
    let Largest { label, members } = largest_of(&found.found, ranks);
    if members == 0 || members > MOST_MEMBERS {
        return UNDEFINED;
    }
    let positions = found.members(label, search.particles, ranks);
    let positions: Vec<_> = positions.into_iter().map(|(_, position)| position).collect();
    let here = found.found.iter().find(|agglomerate| agglomerate.label == label);
    let fit = here.and_then(|agglomerate| MassRadius::of(&positions, agglomerate.member_radius()));
    // One rank has it, and a maximum sends it to the others.
    let mut dimension = [fit.map_or(f64::NEG_INFINITY, |fit| fit.dimension)];
    ranks.maximum(&mut dimension);
    if dimension[0].is_finite() { dimension[0] } else { UNDEFINED }
}

/// A row for each agglomerate, on rank 0, by ascending label. Collective.
fn single(all: &[Agglomerate], lag: f64, ranks: &dyn Communicator) -> Rows {
    let gathered = ranks.gather_to_root(&Message::of(0, all).bytes).unwrap_or_default();
    let mut all: Vec<Agglomerate> =
        gathered.iter().flat_map(|bytes| records_of_bytes(bytes)).collect();
    all.sort_unstable_by_key(|agglomerate| agglomerate.label);
    let scalars = all.iter().map(|a| {
        [
            a.label as f64,
            a.members as f64,
            a.mass,
            a.diameter(),
            a.coordination_number(),
            a.coordination_within(),
            a.bonds_per_member(),
            a.packing_fraction(),
            a.fractal_dimension().unwrap_or(UNDEFINED),
            lag,
            a.winds.iter().sum::<u64>() as f64,
        ]
    });
    let mut rows = Rows::of(SINGLE, &scalars.collect::<Vec<_>>());
    rows.values.push(all.iter().flat_map(|a| a.centre.iter().copied()).collect());
    rows.values.push(all.iter().flat_map(|a| a.velocity.iter().copied()).collect());
    rows
}

/// The row of a window that has ended. Collective.
pub(super) fn window(
    time: f64,
    at_lags: &[AtLag],
    found: &Found,
    search: &Search<'_>,
    settings: &Agglomerates,
    ranks: &dyn Communicator,
) -> Rows {
    let times = CriticalTimes::of(at_lags, settings.few, settings.steady);
    let times = [times.most, times.few, times.steady].map(|lag| lag.unwrap_or(UNDEFINED));
    let dimension = mass_radius_dimension(found, search, ranks);
    Rows::of(WINDOWS, &[[time, times[0], times[1], times[2], dimension]])
}

/// The row of rates of all windows so far.
pub(super) fn rates(rates: &[RatesOfSize]) -> Rows {
    let column = |of: fn(&RatesOfSize) -> f64| rates.iter().map(of).collect::<Vec<f64>>();
    let crossing = crossing(rates, |rates| (rates.gained, rates.lost));
    let row = vec![
        column(|rates| rates.observed as f64),
        column(|rates| rates.breakage.value),
        column(|rates| rates.breakage.error),
        column(|rates| rates.growth.value),
        column(|rates| rates.growth.error),
        column(|rates| rates.lost.value),
        column(|rates| rates.lost.error),
        column(|rates| rates.gained.value),
        column(|rates| rates.gained.error),
        vec![crossing.map_or(UNDEFINED, |crossing| crossing.size)],
        vec![crossing.map_or(UNDEFINED, |crossing| crossing.error)],
    ];
    Rows::one(RATES, row)
}

/// A row for each agglomerate that lost or gained at least `threshold` members, and one for each of its fragments, on
/// rank 0. Collective.
pub(super) fn events(fates: &[Fate], threshold: u64, ranks: &dyn Communicator) -> [Rows; 2] {
    let is_event = |fate: &&Fate| fate.lost() >= threshold || fate.gained() >= threshold;
    let events = || fates.iter().filter(is_event);
    let event = |fate: &Fate| {
        let after = fate.successor().map_or(0, |successor| successor.size);
        let fragments = fate.fragments.len() as u64;
        [fate.label, fate.size, after, fragments, fate.released, fate.lost(), fate.gained()]
    };
    let fragments_of = |fate: &Fate| {
        let label = fate.label;
        let row = move |part: &Fragment| [label, part.label, part.size, part.shared];
        fate.fragments.iter().map(row).collect::<Vec<[u64; 4]>>()
    };
    [
        gathered(EVENTS, events().map(event).collect(), ranks),
        gathered(FRAGMENTS, events().flat_map(fragments_of).collect(), ranks),
    ]
}

/// The rows of all ranks, sorted, on rank 0. Collective.
fn gathered<const N: usize>(table: usize, rows: Vec<[u64; N]>, ranks: &dyn Communicator) -> Rows
where
    [u64; N]: bytemuck::Pod,
{
    let gathered = ranks.gather_to_root(bytemuck::cast_slice(&rows)).unwrap_or_default();
    let mut all: Vec<[u64; N]> =
        gathered.iter().flat_map(|bytes| records_of_bytes(bytes)).collect();
    all.sort_unstable();
    let rows: Vec<[f64; N]> = all.into_iter().map(|row| row.map(|value| value as f64)).collect();
    Rows::of(table, &rows)
}
