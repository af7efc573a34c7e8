//! The file of stress on layers.

use super::profile::MeanProfiles;
use super::{Adhesion, NUMBERS};
use crate::analysis::stress::{CellGrid, rumpf_strength};
use crate::instruments::layout::{Layout, Rows, Table};
use talcum_engine::fields::Column;
use talcum_engine::fields::Unit::{Length, One, Pressure, Speed, SquaredSpeed, Time};

/// The fields derived from the numbers of a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Derived {
    pub(super) solids_fraction: f64,
    pub(super) velocity: [f64; 3],
    pub(super) temperature: f64,
    /// Kinetic, contact, cohesive; by rows.
    pub(super) stresses: [[f64; 9]; 3],
}

impl Derived {
    pub(super) fn of(numbers: &[f64]) -> Self {
        let density = numbers[1];
        let per_density = |x: f64| if density == 0.0 { 0.0 } else { x / density };
        let by_rows = |first: usize| -> [f64; 9] {
            std::array::from_fn(|k| numbers[first + k % 3 * 3 + k / 3])
        };
        let stresses = [5, 14, 23].map(by_rows);
        let trace = stresses[0][0] + stresses[0][4] + stresses[0][8];
        Self {
            solids_fraction: numbers[0],
            velocity: [2, 3, 4].map(|k| per_density(numbers[k])),
            temperature: per_density(trace) / 3.0,
            stresses,
        }
    }

    /// tr(sigma) / 3 of each part.
    fn pressures(&self) -> [f64; 3] {
        self.stresses.map(|stress| (stress[0] + stress[4] + stress[8]) / 3.0)
    }

    /// sigma_zz, summed over all parts.
    fn vertical(&self) -> f64 {
        self.stresses.iter().map(|stress| stress[8]).sum()
    }
}

/// The fields of a cell, as columns of this shape before their components.
pub(super) fn fields(shape: &[usize]) -> Vec<Column> {
    let with = |inner: &[usize]| [shape, inner].concat();
    vec![
        Column::array("solids_fraction", shape, One, "volume of solids per volume"),
        Column::array("velocity", &with(&[3]), Speed, "mean velocity by mass, in the frame"),
        Column::array(
            "granular_temperature",
            shape,
            SquaredSpeed,
            "a third of the mean square of velocities about the mean of the layer or cell, by mass",
        ),
        Column::array("kinetic", &with(&[3, 3]), Pressure, "kinetic part of the stress"),
        Column::array("contact", &with(&[3, 3]), Pressure, "part of spring, dashpot and friction"),
        Column::array("cohesive", &with(&[3, 3]), Pressure, "part of cohesion"),
    ]
}

/// The contents of the file of layers.
pub(super) fn of_layers(grid: &CellGrid, phases: usize) -> Layout {
    let layers = grid.counts[2];
    let (shape, along): (Vec<usize>, &[&str]) = match phases {
        1 => (vec![layers], &["height"]),
        _ => (vec![phases, layers], &["phase", "height"]),
    };
    let scalars = [
        ("from", Time, "time of the first sample that is averaged"),
        ("looks", One, "number of samples that are averaged"),
        ("granular_temperature_mean", SquaredSpeed, "mean over layers, by their solids"),
        ("kinetic_pressure", Pressure, "tr(sigma)/3 of the kinetic part, mean by solids"),
        ("contact_pressure", Pressure, "the same of contacts"),
        ("cohesive_pressure", Pressure, "the same of cohesion"),
        ("bottom_stress", Pressure, "sigma_zz of the lowest layer"),
        ("largest_stress", Pressure, "largest sigma_zz of a layer"),
        ("tensile_strength", Pressure, "largest tension that a layer bears: -sigma_zz, or 0"),
        ("rumpf_strength", Pressure, "Rumpf's estimate phi k F / (pi d^2) with means by solids"),
    ];
    let scalars =
        scalars.into_iter().map(|(name, unit, meaning)| Column::scalar(name, unit, meaning));
    let columns =
        scalars.chain(fields(&shape).into_iter().map(|field| field.along(along))).collect();
    let middle = |layer: usize| (layer as f64 + 0.5) * grid.spacing.z;
    let heights = Column::scalar("height", Length, "middle heights of the layers, in the frame");
    let heights = heights.holding((0..layers).map(middle).collect());
    let phase =
        Column::scalar("phase", One, "middle of each bin of the phase, as a part of a cycle");
    let values = (0..phases).map(|k| (k as f64 + 0.5) / phases as f64).collect();
    let fixed = match phases {
        1 => vec![heights],
        _ => vec![heights, phase.holding(values)],
    };
    Layout { fixed, tables: vec![Table { name: "results", columns }], ..Layout::default() }
}

/// The row of an interval.
pub(super) fn row(profiles: &MeanProfiles, adhesion: Adhesion) -> Rows {
    let derived: Vec<Derived> =
        profiles.means.iter().map(|numbers: &[f64; NUMBERS]| Derived::of(numbers)).collect();
    let known = || derived.iter().filter(|layer| layer.solids_fraction > 0.0);
    let solids: f64 = known().map(|layer| layer.solids_fraction).sum();
    let mean = |of: &dyn Fn(&Derived) -> f64| {
        known().map(|layer| layer.solids_fraction * of(layer)).sum::<f64>() / solids
    };
    let vertical = || known().map(Derived::vertical);
    let tension = vertical().map(|stress| -stress).fold(0.0, f64::max);
    let fraction = mean(&|layer| layer.solids_fraction);
    let Adhesion { coordination, force, diameter } = adhesion;
    let scalars = [
        profiles.from,
        profiles.looks as f64,
        mean(&|layer| layer.temperature),
        mean(&|layer| layer.pressures()[0]),
        mean(&|layer| layer.pressures()[1]),
        mean(&|layer| layer.pressures()[2]),
        derived.first().map_or(0.0, Derived::vertical),
        vertical().fold(f64::NEG_INFINITY, f64::max),
        tension,
        rumpf_strength(fraction, coordination, force, diameter),
    ];
    let mut values: Vec<Vec<f64>> = scalars.map(|value| vec![value]).to_vec();
    values.extend(arrays(&derived));
    Rows::one(0, values)
}

/// The numbers of each field.
fn arrays(derived: &[Derived]) -> Vec<Vec<f64>> {
    let mut values = vec![
        derived.iter().map(|cell| cell.solids_fraction).collect(),
        derived.iter().flat_map(|cell| cell.velocity).collect(),
        derived.iter().map(|cell| cell.temperature).collect(),
    ];
    values.extend(
        [0, 1, 2].map(|part| derived.iter().flat_map(|cell| cell.stresses[part]).collect()),
    );
    values
}
