//! Means and standard deviations over time of the fields of gas and solids: on the cells of a volume-averaged gas, or
//! over height.
//!
//! For n samples in an interval, the mean is M = sum x / n and the deviation sqrt((sum x^2 - n M^2) / (n - 1)). Means
//! of velocities are means over time, not weighted by the amount of gas or solids.

use super::average::{AVERAGE, Average, looks_per_row};
use super::cell_sums::CellSums;
use super::layout::{Image, Layout, Rows, Table};
use super::registered::{InstrumentValues, RegisteredInstrument};
use super::stored::Stored;
use super::view::View;
use super::{CellValues, Instrument, Needs, Readings, Setting};
use crate::analysis::{send_to_rendezvous, totals};
use talcum_engine::fields::{Column, Unit};
use talcum_engine::parallel::{CellSample, Communicator};
use talcum_engine::schema::{Key, Value, Word};

/// Settings of the kind `time_average`.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeAverage {
    on_cells: bool,
    looks_per_row: u64,
}

const PLACES: &[Word] = &[
    Word::new("cells", "on the cells of a volume-averaged gas, to `measure-NAME.vtkhdf`"),
    Word::new("height", "over height, on the grid of the profiles"),
];

impl RegisteredInstrument for TimeAverage {
    const MEANING: &'static str = "means and deviations of the fields of gas and solids over time";

    const KEYS: &'static [Key] = &[
        AVERAGE,
        Key::word("on", PLACES, "Where the fields are").default(Value::Derived(
            "`\"cells\"` with a volume-averaged gas, otherwise `\"height\"`",
        )),
    ];

    fn from_keys(values: &dyn InstrumentValues) -> Option<Self> {
        let looks_per_row = looks_per_row(values);
        let has_cells = values.gas_grid().is_some();
        let on_cells =
            if values.is_given("on") { values.word("on")? == "cells" } else { has_cells };
        if on_cells && !has_cells {
            values.fail("on", "needs a volume-averaged gas".to_owned());
            return None;
        }
        Some(Self { on_cells, looks_per_row: looks_per_row? })
    }

    fn begin(&self, setting: &Setting<'_>) -> Box<dyn Instrument> {
        if let (true, Some(grid)) = (self.on_cells, setting.gas_grid) {
            let image = Image {
                origin: [0.0; 3],
                spacing: grid.spacing().into(),
                counts: grid.counts(),
                fields: fields(),
            };
            let looks_per_row = self.looks_per_row;
            return Box::new(OnCells {
                image,
                looks_per_row,
                looks: 0,
                from: 0.0,
                sums: CellSums::default(),
            });
        }
        let grid = setting.column;
        let heights: Vec<f64> = (0..grid.nodes()).map(|node| grid.height_of(node)).collect();
        Box::new(OverHeight { heights, average: Average::new(self.looks_per_row) })
    }
}

/// The columns with which every row begins.
fn head() -> Vec<Column> {
    vec![
        Column::scalar("from", Unit::Time, "time of the first sample that is averaged"),
        Column::scalar("looks", Unit::One, "number of samples that are averaged"),
        Column::scalar(
            "solids_fraction_mean",
            Unit::One,
            "mean solids fraction of all cells or nodes",
        ),
        Column::scalar(
            "solids_fraction_fluctuation",
            Unit::One,
            "root mean square over cells or nodes of the deviation of their solids fraction",
        ),
    ]
}

/// Averages over height.
struct OverHeight {
    heights: Vec<f64>,
    average: Average,
}

impl Instrument for OverHeight {
    fn layout(&self) -> Layout {
        let nodes = &[self.heights.len()][..];
        let described = [
            ("solids_fraction", Unit::One, "mean solids fraction"),
            ("solids_velocity", Unit::Speed, "mean vertical velocity of the solids"),
            ("solids_fraction_deviation", Unit::One, "its standard deviation"),
            ("solids_velocity_deviation", Unit::Speed, "its standard deviation"),
        ];
        let array =
            |(name, unit, meaning)| Column::array(name, nodes, unit, meaning).along(&["height"]);
        let columns = head().into_iter().chain(described.map(array)).collect();
        let heights = Column::scalar("height", Unit::Length, "heights of the grid's nodes");
        let fixed = vec![heights.holding(self.heights.clone())];
        let tables = vec![Table { name: "results", columns }];
        Layout { fixed, tables, ..Layout::default() }
    }

    fn needs(&self) -> Needs {
        Needs { series: true, ..Needs::default() }
    }

    fn look(&mut self, view: &View<'_>, _: &dyn Communicator) -> Readings {
        let bed = view.profile.bed();
        let values = [&bed.solids_fraction[..], &bed.solids_velocity].concat();
        let Some(averaged) = self.average.add(view.time(), &values) else {
            return Readings::default();
        };
        let (fraction, velocity) = averaged.means.split_at(self.heights.len());
        let (of_fraction, of_velocity) = averaged.deviations.split_at(self.heights.len());
        let nodes = self.heights.len() as f64;
        let mean = fraction.iter().sum::<f64>() / nodes;
        let square = of_fraction.iter().map(|x| x * x).sum::<f64>() / nodes;
        let head = [averaged.from, averaged.looks as f64, mean, square.sqrt()];
        let mut row: Vec<Vec<f64>> = head.map(|value| vec![value]).to_vec();
        row.extend([fraction, velocity, of_fraction, of_velocity].map(<[f64]>::to_vec));
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

/// Number of averaged values of a cell.
const NUMBERS: usize = 8;

fn numbers_of(cell: &CellSample) -> [f64; NUMBERS] {
    let ([a, b, c], [x, y, z]) = (cell.velocity, cell.solids_velocity);
    [cell.pressure, a, b, c, cell.voidage, x, y, z]
}

fn fields() -> Vec<Column> {
    let field =
        |name, components: usize, unit, meaning| Column::array(name, &[components], unit, meaning);
    vec![
        field("pressure", 1, Unit::Pressure, "mean pressure of the gas less its hydrostatic head"),
        field("velocity", 3, Unit::Speed, "mean velocity of the gas"),
        field("voidage", 1, Unit::One, "mean voidage"),
        field("solids_velocity", 3, Unit::Speed, "mean velocity of the solids"),
        field("pressure_deviation", 1, Unit::Pressure, "standard deviation of the pressure"),
        field("velocity_deviation", 3, Unit::Speed, "standard deviation of each component"),
        field("voidage_deviation", 1, Unit::One, "standard deviation of the voidage"),
        field("solids_velocity_deviation", 3, Unit::Speed, "standard deviation of each component"),
    ]
}

/// Averages on cells: sums of values and of squares on the rendezvous ranks of the cells.
struct OnCells {
    image: Image,
    looks_per_row: u64,
    looks: u64,
    from: f64,
    sums: CellSums,
}

impl OnCells {
    /// The fields of the interval, which then ends. Collective.
    fn take(&mut self, ranks: &dyn Communicator) -> Readings {
        let looks = std::mem::take(&mut self.looks) as f64;
        let statistics = |(cell, sums): (u64, Vec<f64>)| {
            let (sums, squares) = sums.split_at(NUMBERS);
            let means = sums.iter().map(|sum| sum / looks);
            let deviations = squares.iter().zip(means.clone()).map(|(square, mean)| {
                let variance = (square - looks * mean * mean).max(0.0) / (looks - 1.0).max(1.0);
                if looks > 1.0 { variance.sqrt() } else { 0.0 }
            });
            CellValues { cell, values: means.chain(deviations).collect() }
        };
        let cells: Vec<CellValues> = self.sums.take().into_iter().map(statistics).collect();
        let solids = cells.iter().map(|CellValues { values, .. }| {
            let deviation = values[NUMBERS + 4];
            [1.0, 1.0 - values[4], deviation * deviation]
        });
        let [count, fraction, square] = totals(solids, ranks);
        let row = [self.from, looks, fraction / count, (square / count).sqrt()];
        Readings { rows: vec![Rows::of(0, &[row])], cells: Some(cells), ..Readings::default() }
    }
}

impl Instrument for OnCells {
    fn layout(&self) -> Layout {
        let tables = vec![Table { name: "results", columns: head() }];
        Layout { tables, image: Some(self.image.clone()), ..Layout::default() }
    }

    fn needs(&self) -> Needs {
        Needs { gas_cells: true, ..Needs::default() }
    }

    /// Samples in a stage without such a gas are not counted.
    fn look(&mut self, view: &View<'_>, ranks: &dyn Communicator) -> Readings {
        let Some(cells) = view.gas_cells else { return Readings::default() };
        if self.looks == 0 {
            self.from = view.time();
        }
        self.looks += 1;
        for cell in send_to_rendezvous(cells.iter().copied(), |cell| cell.cell, ranks) {
            let numbers = numbers_of(&cell);
            let squares = numbers.map(|number| number * number);
            self.sums.add(cell.cell, [numbers, squares].as_flattened());
        }
        if self.looks < self.looks_per_row { Readings::default() } else { self.take(ranks) }
    }

    fn stored(&self, ranks: &dyn Communicator) -> Stored {
        let mut stored = Stored::default();
        stored.add_numbers("looks", &[self.looks as f64, self.from], ranks);
        self.sums.store("sums", &mut stored);
        stored
    }

    fn restore(&mut self, stored: &Stored, ranks: &dyn Communicator) -> Option<()> {
        let [looks, from] = stored.numbers("looks", ranks)?[..] else { return None };
        (self.looks, self.from) = (looks as u64, from);
        self.sums.restore("sums", stored, ranks)
    }
}
