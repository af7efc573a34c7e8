//! Hydrodynamic clusters: connected regions of a high solids fraction on the cells of a volume-averaged gas.
//!
//! They differ from agglomerates in that nothing holds their particles together. Two cells are connected if they share
//! a face, also through periodic faces of the box.

use super::layout::{Layout, Rows, Table};
use super::registered::{InstrumentValues, RegisteredInstrument};
use super::stored::Stored;
use super::view::View;
use super::{Instrument, Needs, Readings, Setting};
use crate::analysis::components::{Link, components};
use crate::analysis::{Keyed, send_to_rendezvous, totals, totals_by_key};
use talcum_engine::fields::{Column, Unit};
use talcum_engine::grid::BoxGrid;
use talcum_engine::parallel::{CellSample, Communicator, records_of_bytes};
use talcum_engine::schema::{Allowed, Key, Kind, Value};

/// Settings of the kind `clusters`.
#[derive(Clone, Debug, PartialEq)]
pub struct Clusters {
    threshold: f64,
    smallest: u64,
}

struct Looks {
    settings: Clusters,
    grid: BoxGrid,
}

impl RegisteredInstrument for Clusters {
    const MEANING: &'static str =
        "hydrodynamic clusters: connected cells of high solids fraction of a volume-averaged gas";

    const KEYS: &'static [Key] = &[
        Key::number(
            "threshold",
            Allowed::positive_up_to(0.74),
            "Cells of at least this solids fraction belong to a cluster",
        ),
        Key::new("smallest", Kind::Count(1, 1_000_000), "Fewer cells are no cluster")
            .default(Value::Count(4)),
    ];

    fn from_keys(values: &dyn InstrumentValues) -> Option<Self> {
        if values.gas_grid().is_none() {
            values.fail("kind", "needs a volume-averaged gas".to_owned());
            return None;
        }
        Some(Self { threshold: values.number("threshold")?, smallest: values.count("smallest")? })
    }

    fn begin(&self, setting: &Setting<'_>) -> Box<dyn Instrument> {
        let whole = || BoxGrid::new(setting.bounds, [1; 3]);
        let grid = setting.gas_grid.cloned().unwrap_or_else(whole);
        Box::new(Looks { settings: self.clone(), grid })
    }
}

/// Number of sums over the cells of a cluster: number, solids fraction, and height and velocity of the solids weighted
/// by solids.
const NUMBERS: usize = 6;

impl Instrument for Looks {
    fn layout(&self) -> Layout {
        let results = [
            ("clusters", Unit::One, "number of clusters"),
            ("volume_fraction", Unit::One, "their part of the box"),
            ("solids_part", Unit::One, "their part of the solids"),
            ("largest", Unit::Volume, "volume of the largest"),
            ("mean_volume", Unit::Volume, "mean volume"),
            ("solids_fraction", Unit::One, "mean solids fraction in them"),
            ("vertical_velocity", Unit::Speed, "mean velocity upwards of the solids in them"),
            ("velocity_outside", Unit::Speed, "that of the solids outside"),
        ];
        let single = [
            ("label", Unit::One, "smallest number of its cells"),
            ("cells", Unit::One, "its open volume in cells"),
            ("volume", Unit::Volume, "volume"),
            ("solids_fraction", Unit::One, "mean solids fraction"),
            ("height", Unit::Length, "mean height of its solids"),
            ("velocity_x", Unit::Speed, "mean velocity of its solids"),
            ("velocity_y", Unit::Speed, "mean velocity of its solids"),
            ("velocity_z", Unit::Speed, "mean velocity of its solids"),
        ];
        let column = |(name, unit, meaning)| Column::scalar(name, unit, meaning);
        let tables = vec![
            Table { name: "results", columns: results.map(column).to_vec() },
            Table { name: "clusters", columns: single.map(column).to_vec() },
        ];
        Layout { tables, ..Layout::default() }
    }

    fn needs(&self) -> Needs {
        Needs { gas_cells: true, ..Needs::default() }
    }

    /// Stages without such a gas have no clusters and no rows.
    fn look(&mut self, view: &View<'_>, ranks: &dyn Communicator) -> Readings {
        let Some(cells) = view.gas_cells else { return Readings::default() };
        let single = self.single(cells, ranks);
        let all = cells.iter().map(|cell| {
            let solids = cell.open_fraction * (1.0 - cell.voidage);
            [cell.open_fraction, solids, solids * cell.solids_velocity[2]]
        });
        let rows =
            vec![self.summary(&single, totals(all, ranks), ranks), self.table(single, ranks)];
        Readings { rows, ..Readings::default() }
    }

    fn stored(&self, _: &dyn Communicator) -> Stored {
        Stored::default()
    }

    fn restore(&mut self, _: &Stored, _: &dyn Communicator) -> Option<()> {
        Some(())
    }
}

impl Looks {
    /// Sums of the clusters whose labels have their rendezvous on this rank, by ascending label. Collective.
    fn single(&self, cells: &[CellSample], ranks: &dyn Communicator) -> Vec<Keyed<NUMBERS>> {
        let dense = |cell: &&CellSample| {
            cell.open_fraction > 0.0 && 1.0 - cell.voidage >= self.settings.threshold
        };
        let mut dense = send_to_rendezvous(
            cells.iter().filter(dense).copied(),
            |cell: &CellSample| cell.cell,
            ranks,
        );
        dense.sort_unstable_by_key(|cell| cell.cell);
        let ids: Vec<u64> = dense.iter().map(|cell| cell.cell).collect();
        // Each dense cell announces itself to its upper neighbours, which are linked to it if they are dense too.
        let sent = ids
            .iter()
            .flat_map(|&cell| self.upper_neighbours(cell).map(move |other| [other, cell]));
        let sent = send_to_rendezvous(sent, |pair: &[u64; 2]| pair[0], ranks);
        let are_dense = sent.into_iter().filter(|pair| ids.binary_search(&pair[0]).is_ok());
        let links: Vec<Link> = are_dense.map(|pair| Link::new(pair, [0; 3])).collect();
        let sets = components(&ids, &links, ranks);
        let numbers = dense.iter().zip(&sets).map(|(cell, set)| {
            let solids = cell.open_fraction * (1.0 - cell.voidage);
            let [x, y, z] = cell.solids_velocity.map(|velocity| solids * velocity);
            let values = [cell.open_fraction, solids, solids * self.height_of(cell.cell), x, y, z];
            Keyed { key: set.label, values }
        });
        let mut sums = totals_by_key(numbers.collect(), ranks);
        sums.retain(|sums| sums.values[0] >= self.settings.smallest as f64);
        sums
    }

    /// The cells above a cell along x, y and z, if there are any.
    fn upper_neighbours(&self, cell: u64) -> impl Iterator<Item = u64> + use<> {
        let counts = self.grid.counts().map(|count| count as u64);
        let periodic: [bool; 3] = std::array::from_fn(|axis| self.grid.is_periodic(axis));
        (0..3).filter_map(move |axis| {
            let stride: u64 = counts[..axis].iter().product();
            let index = cell / stride % counts[axis];
            if index + 1 < counts[axis] {
                Some(cell + stride)
            } else {
                periodic[axis].then(|| cell - index * stride)
            }
        })
    }

    /// Height of the middle of a cell.
    fn height_of(&self, cell: u64) -> f64 {
        let [nx, ny, _] = self.grid.counts().map(|count| count as u64);
        ((cell / (nx * ny)) as f64 + 0.5) * self.grid.spacing().z
    }

    /// The row of results. Collective.
    fn summary(
        &self,
        single: &[Keyed<NUMBERS>],
        [cells, solids, momentum]: [f64; 3],
        ranks: &dyn Communicator,
    ) -> Rows {
        let sums = single.iter().map(|cluster| {
            let [cells, solids, _, _, _, z] = cluster.values;
            [1.0, cells, solids, z]
        });
        let [count, inside, solids_inside, momentum_inside] = totals(sums, ranks);
        let mut largest = [single.iter().map(|cluster| cluster.values[0]).fold(0.0, f64::max)];
        ranks.maximum(&mut largest);
        let ratio = |sum: f64, total: f64| if total > 0.0 { sum / total } else { f64::NAN };
        let volume = self.grid.cell_volume();
        Rows::of(
            0,
            &[[
                count,
                inside / cells,
                ratio(solids_inside, solids),
                largest[0] * volume,
                ratio(inside * volume, count),
                ratio(solids_inside, inside),
                ratio(momentum_inside, solids_inside),
                ratio(momentum - momentum_inside, solids - solids_inside),
            ]],
        )
    }

    /// A row for each cluster, on rank 0. Collective.
    fn table(&self, single: Vec<Keyed<NUMBERS>>, ranks: &dyn Communicator) -> Rows {
        let words = single.iter().map(|cluster| {
            let mut words = [0.0; NUMBERS + 1];
            words[0] = cluster.key as f64;
            words[1..].copy_from_slice(&cluster.values);
            words
        });
        let words: Vec<[f64; NUMBERS + 1]> = words.collect();
        let gathered = ranks.gather_to_root(bytemuck::cast_slice(&words)).unwrap_or_default();
        let mut all: Vec<[f64; NUMBERS + 1]> =
            gathered.iter().flat_map(|bytes| records_of_bytes(bytes)).collect();
        all.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let row = |&[label, cells, solids, height, x, y, z]: &[f64; NUMBERS + 1]| {
            let volume = cells * self.grid.cell_volume();
            let by_solids = [height, x, y, z].map(|sum| sum / solids);
            let [height, x, y, z] = by_solids;
            [label, cells, volume, solids / cells, height, x, y, z]
        };
        Rows::of(1, &all.iter().map(row).collect::<Vec<_>>())
    }
}
