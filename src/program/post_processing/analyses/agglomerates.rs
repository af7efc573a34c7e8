//! Agglomerates: sets of particles held together by contacts that persist from one checkpoint to the next.

use crate::post_processing::{Analysis, Findings, Kind, Results, Unmeasured, Value};
use talcum_engine::fields::{Column, Unit};
use talcum_engine::parallel::OneRank;
use talcum_results::analysis::agglomerates::{
    Agglomerate, Agglomerates, MassWeightedMeans, ParticleSample, Search,
};
use talcum_results::analysis::breakage::{Changes, Look, RateCounts, RatesOfSize};
use talcum_results::analysis::{
    NoValue, Ownership, Pair, Periodicity, Persistence, PersistentContacts, PopulationFit,
};
use talcum_results::output::checkpoint::Checkpoint;
use talcum_results::output::{Cells, ColumnUnits, ResultTable};

pub(super) const ANALYSIS: Analysis = Analysis {
    name: "agglomerates",
    title: "Agglomerates of 15 particles or more, by contacts kept between the last two checkpoints that count",
    scalars: || {
        vec![
            COUNT,
            MASS_SHARE,
            MEMBERS,
            DIAMETER,
            COORDINATION,
            WITHIN,
            PACKING,
            SINGLE_DIMENSION,
            DIMENSION,
        ]
    },
    of_case: |_| Ok(()),
    find,
};

const COUNT: Kind = Kind::number("count", Unit::One, "N_agg, number of agglomerates");
const MASS_SHARE: Kind =
    Kind::number("mass_share", Unit::One, "part of the bed's mass that is in agglomerates");
const MEMBERS: Kind = Kind::number("members", Unit::One, "number of members, weighted by mass");
const DIAMETER: Kind =
    Kind::number("diameter", Unit::Length, "d_agg, twice the radius of gyration, weighted by mass");
const COORDINATION: Kind = Kind::number(
    "coordination_number",
    Unit::One,
    "C_N, touching neighbours of a member, weighted by mass",
);
const WITHIN: Kind = Kind::number(
    "coordination_within",
    Unit::One,
    "those of them that are members, weighted by mass",
);
const PACKING: Kind = Kind::number(
    "packing_fraction",
    Unit::One,
    "volume of the members over that of the sphere of gyration, weighted by mass",
);
const SINGLE_DIMENSION: Kind = Kind::number(
    "fractal_dimension",
    Unit::One,
    "ln n / ln(R / r) of single agglomerates, weighted by mass",
);
const DIMENSION: Kind = Kind::number(
    "fractal_dimension_fit",
    Unit::One,
    "from the growth of the radius with the number of members over all agglomerates",
);

/// Sets of fewer particles do not count as agglomerates.
const SMALLEST: u64 = 15;
/// Limits of the sizes for which rates of breakage and growth are given.
const SIZES: [u64; 9] = [15, 30, 60, 120, 250, 500, 1000, 4000, u64::MAX];
/// Number of members that must be lost or gained for an event.
const EVENT: u64 = 2;

/// The agglomerates at a checkpoint, from the contacts kept since the previous one.
struct AtTime {
    time: f64,
    since: f64,
    mass: f64,
    agglomerates: Agglomerates,
    look: Look,
}

fn find(results: &Results) -> Result<Findings, Unmeasured> {
    let periodicity = results.periodicity()?;
    let mut before: Option<Checkpoint> = None;
    let mut all: Vec<AtTime> = Vec::new();
    for path in results.checkpoints()? {
        let Some(now) = results.checkpoint(path)? else { continue };
        all.extend(before.as_ref().map(|before| search(before, &now, periodicity)));
        before = Some(now);
    }
    let Some(last) = all.last() else {
        return Err(NoValue::because(
            "persistent contacts need two checkpoints: [checkpoint] every and keep of the case give them",
        )
        .into());
    };
    let mut found = Findings::new(results.units());
    add_means(&mut found, last);
    found.note(format!("contacts that touch at time {} and at time {}", last.since, last.time));
    found.tables = vec![
        times_table(&all, results.units()),
        list_table(&last.agglomerates.found, results.units()),
    ];
    found.tables.extend(rates(&all).map(|rates| rates_table(&rates, results.units())));
    Ok(found)
}

/// The touching pairs of different particles, ascending, each once.
fn pairs(checkpoint: &Checkpoint) -> Vec<Pair> {
    let pairs = checkpoint.contacts.iter().map(|contact| Pair::of(contact.lower, contact.higher));
    let mut pairs: Vec<Pair> = pairs.filter(|pair| pair.lower != pair.higher).collect();
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

fn search(before: &Checkpoint, now: &Checkpoint, periodicity: Periodicity) -> AtTime {
    let mut samples: Vec<ParticleSample> = now
        .particles
        .iter()
        .map(|record| ParticleSample {
            id: record.id,
            mass: record.mass,
            radius: record.radius,
            position: record.position.into(),
            velocity: record.velocity.into(),
        })
        .collect();
    samples.sort_by_key(|sample| sample.id);
    let ids: Vec<u64> = samples.iter().map(|sample| sample.id).collect();
    let touching = pairs(now);
    let mut kept = PersistentContacts::begin(Persistence::AtBothTimes, &pairs(before));
    let bonds = kept.look(&touching, &Ownership::of(ids.clone()), &OneRank);
    let search = Search {
        particles: &samples,
        bonds: &bonds,
        touching: &touching,
        periodicity,
        smallest: SMALLEST,
    };
    let agglomerates = search.run(&OneRank);
    let look = Look::take(&ids, &agglomerates.labels);
    let mass = samples.iter().map(|sample| sample.mass).sum();
    AtTime { time: now.clock.time(), since: before.clock.time(), mass, agglomerates, look }
}

fn add_means(found: &mut Findings, last: &AtTime) {
    let means = MassWeightedMeans::of(&last.agglomerates.found, &OneRank);
    let of = |value: fn(&MassWeightedMeans) -> f64| match means.as_ref().map(value) {
        Some(value) if value.is_finite() => Value::from(value),
        _ => Value::Nothing(NoValue::because("there are no agglomerates")),
    };
    found.add(&COUNT, last.agglomerates.found.len() as f64);
    found.add(&MASS_SHARE, means.as_ref().map_or(0.0, |means| means.mass / last.mass));
    found.add(&MEMBERS, of(|means| means.members));
    found.add(&DIAMETER, of(|means| means.diameter));
    found.add(&COORDINATION, of(|means| means.coordination_number));
    found.add(&WITHIN, of(|means| means.coordination_within));
    found.add(&PACKING, of(|means| means.packing_fraction));
    found.add(&SINGLE_DIMENSION, of(|means| means.fractal_dimension));
    let fit = PopulationFit::of(&last.agglomerates.found, &OneRank)
        .map(|fit| Value::Number { value: fit.dimension, error: Some(fit.error) });
    let few = || NoValue::because("three agglomerates of different sizes are needed");
    found.add(&DIMENSION, fit.ok_or_else(few));
}

/// Rates over all pairs of successive samples; `None` with fewer than two samples, or if their intervals differ.
fn rates(all: &[AtTime]) -> Option<Vec<RatesOfSize>> {
    let interval = all.get(1)?.time - all.first()?.time;
    let even =
        |pair: &[AtTime]| (pair[1].time - pair[0].time - interval).abs() <= 1.0e-6 * interval;
    let mut counts = RateCounts::new(&SIZES, EVENT);
    for pair in all.windows(2).filter(|pair| even(pair)) {
        counts.add(&Changes::between(&pair[0].look, &pair[1].look, &OneRank).fates);
    }
    Some(counts.rates(interval, &OneRank))
}

fn times_table(all: &[AtTime], units: ColumnUnits) -> ResultTable {
    let means: Vec<Option<MassWeightedMeans>> =
        all.iter().map(|at| MassWeightedMeans::of(&at.agglomerates.found, &OneRank)).collect();
    let mean = |name: &str, unit: &str, about: &str, of: fn(&MassWeightedMeans) -> f64| {
        let values = means.iter().map(|means| means.as_ref().map_or(f64::NAN, of)).collect();
        Column::numbers(name, unit, about, values)
    };
    let counts = all.iter().map(|at| at.agglomerates.found.len() as u64).collect();
    let columns = vec![
        Column::numbers(
            "time",
            units.of(Unit::Time),
            "of the checkpoint",
            all.iter().map(|at| at.time).collect(),
        ),
        Column::numbers(
            "since",
            units.of(Unit::Time),
            "of the one before",
            all.iter().map(|at| at.since).collect(),
        ),
        Column::new("count", COUNT.meaning, Cells::Whole(counts)),
        mean("mass", units.of(Unit::Mass), "in agglomerates", |means| means.mass),
        mean("members", "1", MEMBERS.meaning, |means| means.members),
        mean("diameter", units.of(Unit::Length), DIAMETER.meaning, |means| means.diameter),
        mean("coordination_number", "1", COORDINATION.meaning, |means| means.coordination_number),
        mean("packing_fraction", "1", PACKING.meaning, |means| means.packing_fraction),
        mean("fractal_dimension", "1", SINGLE_DIMENSION.meaning, |means| means.fractal_dimension),
    ];
    ResultTable::new("agglomerates/times", columns)
}

/// A table of all agglomerates at the last time.
fn list_table(found: &[Agglomerate], units: ColumnUnits) -> ResultTable {
    let numbers = |name: &str, unit: &str, about: &str, of: &dyn Fn(&Agglomerate) -> f64| {
        Column::numbers(name, unit, about, found.iter().map(of).collect())
    };
    let whole = |name: &str, about: &str, of: fn(&Agglomerate) -> u64| {
        Column::new(name, about, Cells::Whole(found.iter().map(of).collect()))
    };
    let mut columns = vec![
        whole("label", "smallest id of its members", |a| a.label),
        whole("members", "number of its members", |a| a.members),
        numbers("mass", units.of(Unit::Mass), "of its members", &|a| a.mass),
        numbers(
            "diameter",
            units.of(Unit::Length),
            "twice the radius of gyration",
            &Agglomerate::diameter,
        ),
        numbers("coordination_number", "1", "touching neighbours of a member", &|a| {
            a.coordination_number()
        }),
        numbers("packing_fraction", "1", PACKING.meaning, &Agglomerate::packing_fraction),
        numbers("fractal_dimension", "1", "ln n / ln(R / r)", &|a| {
            a.fractal_dimension().unwrap_or(f64::NAN)
        }),
    ];
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        columns.push(numbers(name, units.of(Unit::Length), "centre of mass", &|a| a.centre[axis]));
        let name = format!("velocity_{name}");
        columns.push(numbers(&name, units.of(Unit::Speed), "of the centre of mass", &|a| {
            a.velocity[axis]
        }));
    }
    ResultTable::new("agglomerates/list", columns)
}

fn rates_table(rates: &[RatesOfSize], units: ColumnUnits) -> ResultTable {
    let per_time = format!("1/({})", units.of(Unit::Time));
    let numbers = |name: &str, about: &str, of: fn(&RatesOfSize) -> f64| {
        let values = rates.iter().map(of).map(|x| if x.is_finite() { x } else { f64::NAN });
        Column::numbers(name, &per_time, about, values.collect())
    };
    let whole = |name: &str, about: &str, of: fn(&RatesOfSize) -> u64| {
        Column::new(name, about, Cells::Whole(rates.iter().map(of).collect()))
    };
    let columns = vec![
        whole("from", "members, from so many", |rates| rates.sizes[0]),
        whole("below", "members, to below so many", |rates| rates.sizes[1]),
        whole("observed", "agglomerates over one interval", |rates| rates.observed),
        numbers("breakage", "events per agglomerate and time", |rates| rates.breakage.value),
        numbers("breakage_error", "its standard error", |rates| rates.breakage.error),
        numbers("growth", "events per agglomerate and time", |rates| rates.growth.value),
        numbers("growth_error", "its standard error", |rates| rates.growth.error),
    ];
    ResultTable::new("agglomerates/rates", columns)
}
