//! Probes: gas and solids at a point or on a plane.
//!
//! At a point: the values of the gas's cell that contains it, and the solids whose centres lie within a radius. On a
//! plane with area A, with a_i = pi (r_i^2 - h_i^2) the section of particle i, whose centre is at the distance
//! h_i < r_i:
//!
//! ```text
//! area fraction of the solids  sum a_i / A,    volume flux  sum a_i v_i / A
//! ```
//!
//! with the velocity v_i normal to the plane. The mean section over all positions of a particle is its volume divided
//! by its height, so these are unbiased values of the fraction and the flux through the plane.

use super::average::{AVERAGE, Average, looks_per_row};
use super::layout::{Layout, Rows, Table};
use super::registered::{InstrumentValues, RegisteredInstrument};
use super::stored::Stored;
use super::view::View;
use super::{Instrument, Needs, Readings, Setting};
use crate::analysis::{Periodicity, totals};
use nalgebra::Vector3;
use std::f64::consts::PI;
use talcum_engine::domain::Bounds;
use talcum_engine::fields::{Column, Unit};
use talcum_engine::grid::BoxGrid;
use talcum_engine::parallel::{CellSample, Communicator};
use talcum_engine::particles::sphere_volume;
use talcum_engine::schema::{Allowed, Key, Kind, Word};

/// Settings of the kind `probe`.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    at: Place,
    looks_per_row: u64,
}

/// Position of the probe.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    Point { point: [f64; 3], radius: f64 },
    Plane { axis: usize, position: f64 },
}

const AXES: &[Word] = &[Word::new("x", ""), Word::new("y", ""), Word::new("z", "")];

const PLACES: &[Word] = &[
    Word::with(
        "point",
        "the cell of the gas that holds a point, and the particles around it",
        &[
            Key::new("point", Kind::Vector(Allowed::FINITE, 3), "The point, inside of the box")
                .unit("length"),
            Key::number("radius", Allowed::POSITIVE, "Particles count whose centres are so near")
                .unit("length"),
        ],
    ),
    Word::with(
        "plane",
        "a plane through the whole box",
        &[
            Key::word("axis", AXES, "Its normal"),
            Key::number("position", Allowed::NOT_NEGATIVE, "Where it crosses that axis")
                .unit("length"),
        ],
    ),
];

/// Means over samples.
struct Looks {
    settings: Probe,
    bounds: Bounds,
    periodicity: Periodicity,
    gas_grid: Option<BoxGrid>,
    /// Fraction of a horizontal section of the box that lies in the column.
    horizontal_part: f64,
    average: Average,
}

type Described = (&'static str, Unit, &'static str);

const AT_POINT: [Described; 9] = [
    ("pressure", Unit::Pressure, "pressure of the gas less its hydrostatic head"),
    ("voidage", Unit::One, "voidage of the cell of the gas"),
    ("gas_velocity_x", Unit::Speed, "velocity of the gas"),
    ("gas_velocity_y", Unit::Speed, "velocity of the gas"),
    ("gas_velocity_z", Unit::Speed, "velocity of the gas"),
    ("solids_fraction", Unit::One, "volume of the particles near over that of the sphere"),
    ("solids_velocity_x", Unit::Speed, "mean velocity of the particles near, by mass"),
    ("solids_velocity_y", Unit::Speed, "mean velocity of the particles near, by mass"),
    ("solids_velocity_z", Unit::Speed, "mean velocity of the particles near, by mass"),
];

const AT_PLANE: [Described; 6] = [
    ("pressure", Unit::Pressure, "mean pressure of the gas less its hydrostatic head"),
    ("voidage", Unit::One, "mean voidage of the cells of the gas at the plane"),
    ("gas_flux", Unit::Speed, "volume flux of the gas through the plane, per area"),
    ("solids_fraction", Unit::One, "part of the plane that lies in particles"),
    ("solids_flux", Unit::Speed, "volume flux of the solids through the plane, per area"),
    ("solids_velocity", Unit::Speed, "flux over area fraction: mean velocity of the solids"),
];

impl RegisteredInstrument for Probe {
    const MEANING: &'static str =
        "pressure, voidage, velocities and solids flux at a point or a plane";

    const KEYS: &'static [Key] = &[AVERAGE, Key::word("at", PLACES, "Where the probe is")];

    fn from_keys(values: &dyn InstrumentValues) -> Option<Self> {
        let looks_per_row = looks_per_row(values);
        let lengths = values.bounds().lengths();
        let at = match values.word("at")? {
            "point" => {
                let point: [f64; 3] = values.numbers("point")?.try_into().ok()?;
                if (0..3).any(|axis| !(0.0..=lengths[axis]).contains(&point[axis])) {
                    values.fail("point", "must lie inside of the box".to_owned());
                    return None;
                }
                Place::Point { point, radius: values.number("radius")? }
            }
            _ => {
                let axis = AXES.iter().position(|word| Some(word.name) == values.word("axis"))?;
                let position = values.number("position")?;
                if position > lengths[axis] {
                    let message =
                        format!("must be at most {}, the length of the box", lengths[axis]);
                    values.fail("position", message);
                    return None;
                }
                Place::Plane { axis, position }
            }
        };
        Some(Self { at, looks_per_row: looks_per_row? })
    }

    fn begin(&self, setting: &Setting<'_>) -> Box<dyn Instrument> {
        Box::new(Looks {
            settings: self.clone(),
            bounds: setting.bounds.clone(),
            periodicity: Periodicity::of(setting.bounds),
            gas_grid: setting.gas_grid.cloned(),
            horizontal_part: setting.column.cross_section() / setting.bounds.cross_section(),
            average: Average::new(self.looks_per_row),
        })
    }
}

impl Instrument for Looks {
    fn layout(&self) -> Layout {
        let described = match self.settings.at {
            Place::Point { .. } => &AT_POINT[..],
            Place::Plane { .. } => &AT_PLANE[..],
        };
        let mut columns = vec![
            Column::scalar("from", Unit::Time, "time of the first sample that is averaged"),
            Column::scalar("looks", Unit::One, "number of samples that are averaged"),
        ];
        let column = |&(name, unit, meaning): &Described| Column::scalar(name, unit, meaning);
        columns.extend(described.iter().map(column));
        let deviations = Column::array(
            "deviations",
            &[described.len()],
            Unit::One,
            "standard deviations between samples of the columns from pressure on, each in the column's unit",
        );
        columns.push(deviations);
        Layout { tables: vec![Table { name: "results", columns }], ..Layout::default() }
    }

    fn needs(&self) -> Needs {
        Needs { gas_cells: self.gas_grid.is_some(), ..Needs::default() }
    }

    fn look(&mut self, view: &View<'_>, ranks: &dyn Communicator) -> Readings {
        let values = match self.settings.at {
            Place::Point { point, radius } => self.at_point(point.into(), radius, view, ranks),
            Place::Plane { axis, position } => self.at_plane(axis, position, view, ranks),
        };
        let Some(averaged) = self.average.add(view.time(), &values) else {
            return Readings::default();
        };
        let head = [averaged.from, averaged.looks as f64];
        let mut row: Vec<Vec<f64>> =
            head.iter().chain(&averaged.means).map(|&value| vec![value]).collect();
        row.push(averaged.deviations);
        Readings { rows: vec![Rows::one(0, row)], ..Readings::default() }
    }

    fn stored(&self, ranks: &dyn Communicator) -> Stored {
        let mut stored = Stored::default();
        self.average.store("average", &mut stored, ranks);
        stored
    }

    fn restore(&mut self, stored: &Stored, ranks: &dyn Communicator) -> Option<()> {
        self.average.restore("average", stored, ranks)
    }
}

/// A sum divided by a sum; undefined if the latter is zero.
fn ratio(sum: f64, total: f64) -> f64 {
    if total > 0.0 { sum / total } else { f64::NAN }
}

impl Looks {
    fn at_point(
        &self,
        point: Vector3<f64>,
        radius: f64,
        view: &View<'_>,
        ranks: &dyn Communicator,
    ) -> Vec<f64> {
        let is_here = |cell: &CellSample| {
            self.gas_grid.as_ref().is_some_and(|grid| {
                let [nx, ny, nz] = grid.counts();
                let index = |axis: usize, count: usize| {
                    ((point[axis] / grid.spacing()[axis]) as usize).min(count - 1)
                };
                let place = [index(0, nx), index(1, ny), index(2, nz)];
                let number = (place[0] + nx * (place[1] + ny * place[2])) as u64;
                cell.cell == number && cell.open_fraction > 0.0
            })
        };
        let cells = view.gas_cells.unwrap_or_default().iter().filter(|cell| is_here(cell));
        let of_gas = cells.map(|cell| {
            let [x, y, z] = cell.velocity;
            [1.0, cell.pressure, cell.voidage, x, y, z]
        });
        let [found, gas @ ..] = totals(of_gas, ranks);
        let near = view.samples().iter().filter(|particle| {
            self.periodicity.displacement(&point, &particle.position).norm() <= radius
        });
        let of_solids = near.map(|particle| {
            let momentum = particle.mass * particle.velocity;
            [particle.mass, sphere_volume(particle.radius), momentum.x, momentum.y, momentum.z]
        });
        let [mass, volume, momentum @ ..] = totals(of_solids, ranks);
        let gas = gas.map(|sum| ratio(sum, found));
        let velocity = momentum.map(|sum| ratio(sum, mass));
        gas.into_iter().chain([volume / sphere_volume(radius)]).chain(velocity).collect()
    }

    fn at_plane(
        &self,
        axis: usize,
        position: f64,
        view: &View<'_>,
        ranks: &dyn Communicator,
    ) -> Vec<f64> {
        let is_cut = |cell: &CellSample| {
            self.gas_grid.as_ref().is_some_and(|grid| {
                let counts = grid.counts().map(|count| count as u64);
                let stride: u64 = counts[..axis].iter().product();
                let layer = ((position / grid.spacing()[axis]) as u64).min(counts[axis] - 1);
                cell.cell / stride % counts[axis] == layer
            })
        };
        let cells = view.gas_cells.unwrap_or_default().iter().filter(|cell| is_cut(cell));
        let of_gas = cells.map(|cell| {
            let flux = cell.voidage * cell.velocity[axis];
            let open = cell.open_fraction;
            [open, open * cell.pressure, open * cell.voidage, open * flux]
        });
        let [found, gas @ ..] = totals(of_gas, ranks);
        let lengths = self.bounds.lengths();
        let part = if axis == 2 { self.horizontal_part } else { 1.0 };
        let area = part * (self.bounds.volume() / lengths[axis]);
        let mut plane = Vector3::zeros();
        plane[axis] = position;
        let sections = view.samples().iter().filter_map(|particle| {
            let distance = self.periodicity.displacement(&plane, &particle.position)[axis];
            let section = PI * (particle.radius * particle.radius - distance * distance);
            (section > 0.0).then(|| [section, section * particle.velocity[axis]])
        });
        let [section, flux] = totals(sections, ranks);
        let gas = gas.map(|sum| ratio(sum, found));
        gas.into_iter().chain([section / area, flux / area, ratio(flux, section)]).collect()
    }
}
