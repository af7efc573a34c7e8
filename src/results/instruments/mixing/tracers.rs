//! The particles whose mixing is measured.

use crate::analysis::agglomerates::ParticleSample;
use crate::analysis::mixing::{LaceyIndex, Sample, lacey_index};
use crate::analysis::stress::CellGrid;
use crate::analysis::{Periodicity, send_to_rendezvous};
use crate::instruments::Stored;
use crate::instruments::registered::InstrumentValues;
use talcum_engine::domain::Bounds;
use talcum_engine::parallel::Communicator;
use talcum_engine::schema::{Allowed, Key, Kind, Value, Word};

const CELLS: Key =
    Key::new("cells", Kind::Counts(1, 10_000), "Cells along x, y and z that are compared");
const LEAST: Key =
    Key::new("least", Kind::Count(1, 1_000_000), "Cells of fewer particles are left out")
        .default(Value::Count(5));

/// Largest number of cells; each rank counts in all of them.
const MOST_CELLS: usize = 1_000_000;

/// The words of `tracers`, each with its keys.
pub(super) const TRACERS: &[Word] = &[
    Word::new("none", "no Lacey index"),
    Word::with(
        "size",
        "particles above a diameter",
        &[
            Key::number("above_diameter", Allowed::POSITIVE, "Larger particles are tracers")
                .unit("length"),
            CELLS,
            LEAST,
        ],
    ),
    Word::with(
        "region",
        "particles that were in a part of the box at the first sample",
        &[
            Key::new("lower_corner", Kind::Vector(Allowed::FINITE, 3), "Its lower corner")
                .unit("length"),
            Key::new("upper_corner", Kind::Vector(Allowed::FINITE, 3), "Its upper corner")
                .unit("length"),
            CELLS,
            LEAST,
        ],
    ),
];

/// Selection of the tracers, and the cells in which they are counted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TracerSettings {
    class: Class,
    cells: [usize; 3],
    least: u64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Class {
    None,
    AboveDiameter(f64),
    Region([[f64; 3]; 2]),
}

impl TracerSettings {
    pub(super) fn from_keys(values: &dyn InstrumentValues) -> Option<Self> {
        let vector = |key| -> Option<[f64; 3]> { values.numbers(key)?.try_into().ok() };
        let class = match values.word("tracers")? {
            "size" => Class::AboveDiameter(values.number("above_diameter")?),
            "region" => Class::Region([vector("lower_corner")?, vector("upper_corner")?]),
            _ => return Some(Self { class: Class::None, cells: [1; 3], least: 1 }),
        };
        let (cells, least) = (values.counts("cells")?, values.count("least")?);
        if cells.iter().product::<usize>() > MOST_CELLS {
            values.fail("cells", format!("must be at most {MOST_CELLS} in all"));
            return None;
        }
        if cells == [1, 1, 1] {
            values.fail("cells", "must be two or more, to be compared".to_owned());
            return None;
        }
        Some(Self { class, cells, least })
    }
}

/// The tracers of a run.
pub(super) struct Tracers {
    settings: TracerSettings,
    grid: CellGrid,
    periodicity: Periodicity,
    /// Ids of the tracers of a region on their rendezvous ranks, ascending; `None` before the first sample.
    marked: Option<Vec<u64>>,
}

impl Tracers {
    pub(super) fn new(settings: &TracerSettings, bounds: &Bounds) -> Self {
        let counts = settings.cells;
        let lengths = bounds.lengths();
        let grid = CellGrid {
            origin: [0.0; 3].into(),
            spacing: std::array::from_fn(|axis| lengths[axis] / counts[axis] as f64).into(),
            counts,
            periodic: std::array::from_fn(|axis| bounds.is_periodic(axis)),
        };
        let periodicity = Periodicity::of(bounds);
        Self { settings: *settings, grid, periodicity, marked: None }
    }

    /// Periodicity of the box.
    pub(super) fn periodicity(&self) -> Periodicity {
        self.periodicity
    }

    /// At the first sample, marks the particles in the region. Collective.
    pub(super) fn mark(&mut self, samples: &[ParticleSample], ranks: &dyn Communicator) {
        let Class::Region([lower, upper]) = self.settings.class else { return };
        if self.marked.is_some() {
            return;
        }
        let is_inside = |particle: &&ParticleSample| {
            let within =
                |axis: usize| (lower[axis]..upper[axis]).contains(&particle.position[axis]);
            (0..3).all(within)
        };
        let ids = samples.iter().filter(is_inside).map(|particle| particle.id);
        let mut marked = send_to_rendezvous(ids, |&id| id, ranks);
        marked.sort_unstable();
        self.marked = Some(marked);
    }

    /// The Lacey index now. Collective.
    pub(super) fn lacey(
        &self,
        samples: &[ParticleSample],
        ranks: &dyn Communicator,
    ) -> Option<LaceyIndex> {
        let cell =
            |particle: &ParticleSample| self.grid.cell_of(&particle.position).unwrap_or(u64::MAX);
        let counted: Vec<Sample> = match (self.settings.class, &self.marked) {
            (Class::AboveDiameter(diameter), _) => samples
                .iter()
                .map(|particle| Sample {
                    cell: cell(particle),
                    tracer: 2.0 * particle.radius > diameter,
                })
                .collect(),
            (Class::Region(_), Some(marked)) => {
                let records = samples.iter().map(|particle| [particle.id, cell(particle)]);
                let here = send_to_rendezvous(records, |record| record[0], ranks);
                let is_marked = |id: u64| marked.binary_search(&id).is_ok();
                here.into_iter().map(|[id, cell]| Sample { cell, tracer: is_marked(id) }).collect()
            }
            _ => return None,
        };
        let cells = self.grid.counts.iter().product();
        lacey_index(&counted, cells, self.settings.least, ranks)
    }

    /// Stores the tracers of a region.
    pub(super) fn store(&self, stored: &mut Stored) {
        if let Some(marked) = &self.marked {
            let records: Vec<[u64; 2]> = marked.iter().map(|&id| [id, 0]).collect();
            stored.add_records("tracers", &records);
        }
    }

    /// Continues from stored data. Collective.
    pub(super) fn restore(&mut self, stored: &Stored, ranks: &dyn Communicator) -> Option<()> {
        let records: Option<Vec<[u64; 2]>> = stored.records("tracers");
        self.marked = records.map(|records| {
            let ids = records.into_iter().map(|[id, _]| id);
            let mut ids = send_to_rendezvous(ids, |&id| id, ranks);
            ids.sort_unstable();
            ids
        });
        Some(())
    }
}
