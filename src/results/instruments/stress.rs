//! Stress in its three parts, and granular temperature: as profiles over height, as fields on cells, in the frame of a
//! wave, or over the phase of the vibration.
//!
//! Formulas: [`analysis::stress`](crate::analysis::stress), after Moon, Kevrekidis & Sundaresan (2006), eq. (19).

mod cells;
mod columns;
mod frame;
mod profile;

use super::average::{AVERAGE, looks_per_row};
use super::registered::{InstrumentValues, RegisteredInstrument};
use super::stored::Stored;
use super::view::View;
use super::{Instrument, Layout, Needs, Readings, Setting};
use crate::analysis::stress::{CellGrid, CellStress};
use frame::{FRAMES, FrameSettings};
use profile::Profiles;
use talcum_engine::contact::VanDerWaals;
use talcum_engine::parallel::Communicator;
use talcum_engine::schema::{Key, Kind, Value};

/// Settings of the kind `stress`.
#[derive(Clone, Debug, PartialEq)]
pub struct Stress {
    frame: FrameSettings,
    cells: Cells,
    looks_per_row: u64,
}

/// Largest number of layers, over all phases; each rank has all of them.
const MOST_LAYERS: usize = 100_000;

/// Largest number of cells; rank 0 writes their fields one after another.
const MOST_CELLS: usize = 10_000_000;

/// The cells on which the stress is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Cells {
    /// Layers, one for about each largest diameter.
    LayersOfDiameter,
    /// A given number of layers.
    Layers(usize),
    /// Cells along x, y and z.
    Boxes([usize; 3]),
}

impl RegisteredInstrument for Stress {
    const MEANING: &'static str =
        "kinetic, contact and cohesive stress and granular temperature, over height or on cells";

    const KEYS: &'static [Key] = &[
        AVERAGE,
        Key::new("layers", Kind::Count(1, MOST_LAYERS as u64), "Number of layers of equal height")
            .or(&["cells"])
            .default(Value::Derived("one for about each largest diameter")),
        Key::new(
            "cells",
            Kind::Counts(1, 10_000),
            "Cells along x, y and z instead of layers; fields go to `measure-NAME.vtkhdf`",
        )
        .or(&["layers"])
        .optional(),
        Key::word("frame", FRAMES, "Frame in which layers or cells are at rest")
            .default(Value::Word("laboratory")),
    ];

    fn from_keys(values: &dyn InstrumentValues) -> Option<Self> {
        let looks_per_row = looks_per_row(values);
        let frame = FrameSettings::from_keys(values);
        let cells = match values.given(&["layers", "cells"]) {
            Some("cells") => Cells::Boxes(values.counts("cells")?),
            Some(_) => Cells::Layers(values.count("layers")? as usize),
            None => Cells::LayersOfDiameter,
        };
        if !is_room_for(cells, frame.as_ref(), values) {
            return None;
        }
        if matches!(cells, Cells::Boxes(_)) && frame.is_some_and(|frame| frame.has_phases()) {
            values.fail(
                "cells",
                "have no phases: leave phases or frame = \"phase\" out, or give layers".to_owned(),
            );
            return None;
        }
        Some(Self { frame: frame?, cells, looks_per_row: looks_per_row? })
    }

    fn begin(&self, setting: &Setting<'_>) -> Box<dyn Instrument> {
        let lengths = setting.bounds.lengths();
        let extent = self.frame.extent(lengths.z);
        let counts = match self.cells {
            Cells::Boxes(counts) => counts,
            Cells::Layers(layers) => [1, 1, layers],
            Cells::LayersOfDiameter => {
                let layers = (extent / setting.sizes.largest_diameter).floor();
                [1, 1, (layers.max(1.0) as usize).min(MOST_LAYERS / self.frame.phases())]
            }
        };
        let edges = [lengths.x, lengths.y, extent];
        let grid = CellGrid {
            origin: [0.0; 3].into(),
            spacing: std::array::from_fn(|axis| edges[axis] / counts[axis] as f64).into(),
            counts,
            periodic: std::array::from_fn(|axis| {
                setting.bounds.is_periodic(axis) || axis == 2 && self.frame.repeats()
            }),
        };
        match self.cells {
            Cells::Boxes(_) => {
                let waves = self.frame.waves(lengths.z);
                Box::new(cells::Fields::new(self.frame, grid, waves, self.looks_per_row))
            }
            _ => Box::new(Layers::new(self, grid, lengths.z)),
        }
    }
}

/// Reports an error if there are more layers or cells than fit into memory.
fn is_room_for(cells: Cells, frame: Option<&FrameSettings>, values: &dyn InstrumentValues) -> bool {
    match cells {
        Cells::Boxes(counts) if counts.iter().product::<usize>() > MOST_CELLS => {
            values.fail("cells", format!("must be at most {MOST_CELLS} in all"));
            false
        }
        Cells::Layers(layers) if frame.is_some_and(|f| f.phases() * layers > MOST_LAYERS) => {
            let message = format!("times phases must be at most {MOST_LAYERS}");
            values.fail("layers", message);
            false
        }
        _ => true,
    }
}

/// Stress on layers.
struct Layers {
    frame: FrameSettings,
    grid: CellGrid,
    looks_per_row: u64,
    /// Ratio of the volume of the box to that of the layers: the number of waves that are superposed in each layer.
    waves: f64,
    profiles: Profiles,
}

impl Layers {
    fn new(settings: &Stress, grid: CellGrid, height: f64) -> Self {
        let Stress { frame, looks_per_row, .. } = settings.clone();
        let waves = frame.waves(height);
        let profiles = Profiles::new(frame.phases(), grid.counts[2]);
        Self { frame, grid, looks_per_row, waves, profiles }
    }
}

impl Instrument for Layers {
    fn layout(&self) -> Layout {
        columns::of_layers(&self.grid, self.frame.phases())
    }

    fn needs(&self) -> Needs {
        Needs { contact_forces: true, ..Needs::default() }
    }

    fn look(&mut self, view: &View<'_>, ranks: &dyn Communicator) -> Readings {
        let measurement = self.frame.measurement(self.grid, view);
        let field = measurement.run(view.moving_particles(), view.contact_forces(), ranks);
        let phase = self.frame.phase_at(view.time());
        let cells = field.gathered(ranks);
        self.profiles.add(view.time(), phase, &cells, self.waves);
        if self.profiles.looks() < self.looks_per_row {
            return Readings::default();
        }
        let rows = vec![columns::row(&self.profiles.take(), rumpf(view, ranks))];
        Readings { rows, ..Readings::default() }
    }

    fn stored(&self, ranks: &dyn Communicator) -> Stored {
        let mut stored = Stored::default();
        stored.add_numbers("profiles", &self.profiles.numbers(), ranks);
        stored
    }

    fn restore(&mut self, stored: &Stored, ranks: &dyn Communicator) -> Option<()> {
        self.profiles.restore(&stored.numbers("profiles", ranks)?)
    }
}

/// Quantities for Rumpf's estimate besides the solids fraction: the coordination number, the attraction of two
/// particles of the largest size in contact, for the species that attract most strongly, and their diameter.
#[derive(Clone, Copy, Debug)]
struct Adhesion {
    coordination: f64,
    force: f64,
    diameter: f64,
}

/// Computes these quantities. Collective.
fn rumpf(view: &View<'_>, ranks: &dyn Communicator) -> Adhesion {
    let run = view.run();
    let mut counts =
        [run.state.particles.owned_count() as i64, 2 * run.state.contacts.touching_count() as i64];
    ranks.sum_integers(&mut counts);
    let diameter = run.state.sizes.largest_diameter;
    let radius = 0.5 * diameter;
    let of_pair = |law: &VanDerWaals| law.at(view.time()).between_particles(radius, radius, 0.0);
    let attractions = run.models.physics.attractions();
    let force = attractions.iter().map(of_pair).fold(0.0, f64::max);
    Adhesion { coordination: counts[1] as f64 / counts[0].max(1) as f64, force, diameter }
}

/// Number of averaged values of a cell: solids fraction, density, momentum per volume, and the stresses by columns.
const NUMBERS: usize = 32;

fn numbers_of(cell: &CellStress, scale: f64) -> [f64; NUMBERS] {
    let density = cell.density();
    let mut numbers = [0.0; NUMBERS];
    numbers[0] = cell.solids_fraction;
    numbers[1] = density;
    numbers[2..5].copy_from_slice((density * cell.velocity).as_slice());
    numbers[5..14].copy_from_slice(cell.kinetic.as_slice());
    numbers[14..23].copy_from_slice(cell.contact.as_slice());
    numbers[23..32].copy_from_slice(cell.cohesive.as_slice());
    numbers.iter_mut().for_each(|number| *number *= scale);
    numbers
}
