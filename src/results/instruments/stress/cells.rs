//! Stress and granular temperature on cells, averaged over samples: fields for ParaView.

use super::columns::{Derived, fields};
use super::frame::FrameSettings;
use super::{NUMBERS, numbers_of};
use crate::analysis::stress::CellGrid;
use crate::analysis::totals;
use crate::instruments::cell_sums::CellSums;
use crate::instruments::layout::{Image, Layout, Rows, Table};
use crate::instruments::{CellValues, Instrument, Needs, Readings, Stored, View};
use talcum_engine::fields::Column;
use talcum_engine::fields::Unit::{One, Pressure, SquaredSpeed, Time};
use talcum_engine::parallel::Communicator;

/// Sums of the present interval, on the rendezvous ranks of the cells.
pub(super) struct Fields {
    frame: FrameSettings,
    grid: CellGrid,
    /// Number of superposed waves, as for layers.
    waves: f64,
    looks_per_row: u64,
    looks: u64,
    from: f64,
    sums: CellSums,
}

impl Fields {
    /// Fields in a frame without phases.
    pub(super) fn new(
        frame: FrameSettings,
        grid: CellGrid,
        waves: f64,
        looks_per_row: u64,
    ) -> Self {
        let sums = CellSums::default();
        Self { frame, grid, waves, looks_per_row, looks: 0, from: 0.0, sums }
    }

    /// The means of the interval, which then ends. Collective.
    fn take(&mut self, ranks: &dyn Communicator) -> Readings {
        let looks = self.looks as f64;
        self.looks = 0;
        let mean = |(cell, sums): (u64, Vec<f64>)| {
            let means: Vec<f64> = sums.iter().map(|sum| sum / looks).collect();
            (cell, Derived::of(&means))
        };
        let cells: Vec<(u64, Derived)> = self.sums.take().into_iter().map(mean).collect();
        let solids = cells.iter().map(|(_, cell)| {
            let phi = cell.solids_fraction;
            let trace: f64 = cell.stresses.iter().map(|s| s[0] + s[4] + s[8]).sum();
            [phi, phi * cell.temperature, phi * trace / 3.0]
        });
        let [solids, temperature, pressure] = totals(solids, ranks);
        let row = [self.from, looks, temperature / solids, pressure / solids];
        let cells = cells
            .into_iter()
            .map(|(cell, derived)| CellValues { cell, values: values_of(&derived) });
        Readings {
            rows: vec![Rows::of(0, &[row])],
            cells: Some(cells.collect()),
            ..Readings::default()
        }
    }
}

fn values_of(cell: &Derived) -> Vec<f64> {
    let head = [cell.solids_fraction].into_iter().chain(cell.velocity).chain([cell.temperature]);
    head.chain(cell.stresses.into_iter().flatten()).collect()
}

impl Instrument for Fields {
    fn layout(&self) -> Layout {
        let columns = vec![
            Column::scalar("from", Time, "time of the first sample that is averaged"),
            Column::scalar("looks", One, "number of samples that are averaged"),
            Column::scalar(
                "granular_temperature_mean",
                SquaredSpeed,
                "mean over cells, by their solids",
            ),
            Column::scalar("pressure", Pressure, "tr(sigma)/3 of all parts, mean by solids"),
        ];
        let flat = |field: Column| Column { shape: vec![field.width()].into(), ..field };
        let image = Image {
            origin: self.grid.origin.into(),
            spacing: self.grid.spacing.into(),
            counts: self.grid.counts,
            fields: fields(&[]).into_iter().map(flat).collect(),
        };
        let tables = vec![Table { name: "results", columns }];
        Layout { tables, image: Some(image), ..Layout::default() }
    }

    fn needs(&self) -> Needs {
        Needs { contact_forces: true, ..Needs::default() }
    }

    fn look(&mut self, view: &View<'_>, ranks: &dyn Communicator) -> Readings {
        let measurement = self.frame.measurement(self.grid, view);
        let field = measurement.run(view.moving_particles(), view.contact_forces(), ranks);
        if self.looks == 0 {
            self.from = view.time();
        }
        self.looks += 1;
        for cell in &field.cells {
            let numbers: [f64; NUMBERS] = numbers_of(cell, 1.0 / self.waves);
            self.sums.add(cell.cell, &numbers);
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
