//! The tables of the file of agglomerates.

use super::Agglomerates;
use crate::instruments::layout::{Layout, Table};
use talcum_engine::fields::Column;
use talcum_engine::fields::Unit::{self, Length, Mass, One, Rate, Speed, Time};

/// Numbers of the tables.
pub(super) const RESULTS: usize = 0;
pub(super) const SINGLE: usize = 1;
pub(super) const WINDOWS: usize = 2;
pub(super) const RATES: usize = 3;
pub(super) const EVENTS: usize = 4;
pub(super) const FRAGMENTS: usize = 5;

type Described = (&'static str, Unit, &'static str);

const OF_LOOK: [Described; 15] = [
    ("lag", Time, "time since the reference time t_0"),
    ("agglomerates", One, "N_agg, number of agglomerates"),
    ("mass", Mass, "their mass"),
    ("mass_fraction", One, "their part of the mass of all particles"),
    ("members", One, "number of members, weighted by mass"),
    ("largest", One, "number of members of the largest"),
    ("diameter", Length, "d_agg, twice the radius of gyration, weighted by mass"),
    ("coordination_number", One, "C_N of all contacts, weighted by mass"),
    ("coordination_within", One, "C_N of contacts within agglomerates, weighted by mass"),
    ("packing_fraction", One, "p, weighted by mass"),
    ("fractal_dimension", One, "D_f of single agglomerates, weighted by mass"),
    ("population_dimension", One, "D_f of the population, from n over radius of gyration"),
    ("population_error", One, "its standard error"),
    ("vertical_velocity", Speed, "velocity upwards, weighted by mass"),
    ("speed", Speed, "speed of the centres of mass, weighted by mass"),
];

const OF_SINGLE: [Described; 11] = [
    ("label", One, "the smallest id of the members"),
    ("members", One, "number of members"),
    ("mass", Mass, "mass"),
    ("diameter", Length, "d_agg, twice the radius of gyration"),
    ("coordination_number", One, "C_N of all contacts of members"),
    ("coordination_within", One, "C_N of contacts within"),
    ("persistent_contacts", One, "contacts kept since t_0, per member as C_N"),
    ("packing_fraction", One, "p"),
    ("fractal_dimension", One, "D_f; undefined if the agglomerate is too compact"),
    ("lag", Time, "time since t_0"),
    ("winds", One, "number of axes along which it winds around the periodic box"),
];

const OF_WINDOW: [Described; 5] = [
    ("reference_time", Time, "t_0"),
    ("most", Time, "tau_Nmax, lag of the largest number of agglomerates"),
    ("few", Time, "tau_N15, lag from which there are fewer than `few`"),
    ("steady", Time, "tau_ds, lag from which the diameter is steady"),
    ("mass_radius_dimension", One, "D_f of the largest at the end, from its mass within a radius"),
];

const BY_SIZE: [Described; 9] = [
    ("observed", One, "agglomerates seen over a window"),
    ("breakage", Rate, "events of breakage per agglomerate and time"),
    ("breakage_error", Rate, "standard error"),
    ("growth", Rate, "events of growth per agglomerate and time"),
    ("growth_error", Rate, "standard error"),
    ("lost", Rate, "members lost per agglomerate and time"),
    ("lost_error", Rate, "standard error"),
    ("gained", Rate, "members gained per agglomerate and time"),
    ("gained_error", Rate, "standard error"),
];

const CROSSING: [Described; 2] = [
    ("crossing", One, "number of members at which growth and breakage are equal"),
    ("crossing_error", One, "its standard error"),
];

const OF_EVENT: [Described; 7] = [
    ("label", One, "label at the end of the window before"),
    ("size", One, "members then"),
    ("size_after", One, "members of the successor; 0 if there is none"),
    ("fragments", One, "agglomerates that hold members of it"),
    ("released", One, "members that are in none"),
    ("lost", One, "members that are not in the successor"),
    ("gained", One, "members of the successor that come from elsewhere"),
];

const OF_FRAGMENT: [Described; 4] = [
    ("label", One, "label of the agglomerate of the event at the end of the window before"),
    ("fragment", One, "label of an agglomerate that holds members of it now"),
    ("size", One, "members of the fragment, also those from elsewhere"),
    ("shared", One, "members that both share"),
];

fn scalars(described: &[Described]) -> impl Iterator<Item = Column> + '_ {
    described.iter().map(|&(name, unit, meaning)| Column::scalar(name, unit, meaning))
}

fn arrays(described: &[Described], bins: usize) -> impl Iterator<Item = Column> + '_ {
    let array =
        move |&(name, unit, meaning): &Described| Column::array(name, &[bins], unit, meaning);
    described.iter().map(array)
}

/// The contents of the file.
pub(super) fn layout(settings: &Agglomerates) -> Layout {
    let bins = settings.sizes.len() - 1;
    let distributions = [
        ("number_by_size", One, "number of agglomerates in each bin of members"),
        ("mass_by_size", Mass, "mass of the agglomerates in each bin"),
    ];
    let vectors = [
        Column::array("centre", &[3], Length, "centre of mass"),
        Column::array("velocity", &[3], Speed, "velocity of the centre of mass"),
    ];
    let tables = vec![
        table("results", scalars(&OF_LOOK).chain(arrays(&distributions, bins))),
        table("agglomerates", scalars(&OF_SINGLE).chain(vectors)),
        table("windows", scalars(&OF_WINDOW)),
        table("rates", arrays(&BY_SIZE, bins).chain(scalars(&CROSSING))),
        table("events", scalars(&OF_EVENT)),
        table("fragments", scalars(&OF_FRAGMENT)),
    ];
    let meaning =
        "limits of the bins of the number of members: bin k holds limits[k] <= n < limits[k + 1]";
    let limits = settings.sizes.iter().map(|&size| size as f64).collect();
    let limits = Column::with("size_limits", One, &[], meaning, limits);
    Layout { fixed: vec![limits], tables, ..Layout::default() }
}

fn table(name: &'static str, columns: impl Iterator<Item = Column>) -> Table {
    Table { name, columns: columns.collect() }
}
