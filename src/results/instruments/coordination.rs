//! Coordination number and its distribution, as functions of time.

use super::average::{AVERAGE, Average, looks_per_row};
use super::layout::{Layout, Rows, Table};
use super::registered::{InstrumentValues, RegisteredInstrument};
use super::stored::Stored;
use super::view::View;
use super::{Instrument, Readings, Setting};
use crate::analysis::Coordination as Distribution;
use talcum_engine::fields::{Column, Unit};
use talcum_engine::parallel::Communicator;
use talcum_engine::schema::{Key, Kind, Value};

/// Settings of the kind `coordination`.
#[derive(Clone, Debug, PartialEq)]
pub struct Coordination {
    most: usize,
    looks_per_row: u64,
}

/// Coordination numbers, averaged over samples.
struct Looks {
    settings: Coordination,
    average: Average,
}

impl RegisteredInstrument for Coordination {
    const MEANING: &'static str = "how many particles a particle touches: mean and distribution";

    const KEYS: &'static [Key] = &[
        AVERAGE,
        Key::new(
            "most",
            Kind::Count(1, 64),
            "Particles with so many neighbours or more are counted together",
        )
        .default(Value::Count(12)),
    ];

    fn from_keys(values: &dyn InstrumentValues) -> Option<Self> {
        let looks_per_row = looks_per_row(values);
        Some(Self { most: values.count("most")? as usize, looks_per_row: looks_per_row? })
    }

    fn begin(&self, _: &Setting<'_>) -> Box<dyn Instrument> {
        let average = Average::new(self.looks_per_row);
        Box::new(Looks { settings: self.clone(), average })
    }
}

impl Instrument for Looks {
    fn layout(&self) -> Layout {
        let number = Unit::One;
        let columns = vec![
            Column::scalar("from", Unit::Time, "time of the first sample that is averaged"),
            Column::scalar("looks", number, "number of samples that are averaged"),
            Column::scalar(
                "coordination_number",
                number,
                "mean number of touching particles per particle",
            ),
            Column::scalar(
                "coordination_deviation",
                number,
                "standard deviation of that mean between samples",
            ),
            Column::scalar("contacts", number, "number of touching pairs of particles"),
            Column::scalar("without_contact", number, "part of the particles that touch no other"),
            Column::array(
                "distribution",
                &[self.settings.most + 1],
                number,
                "part of the particles with 0, 1, 2 ... neighbours; the last with as many or more",
            ),
        ];
        Layout { tables: vec![Table { name: "results", columns }], ..Layout::default() }
    }

    fn look(&mut self, view: &View<'_>, ranks: &dyn Communicator) -> Readings {
        let values = self.distribution(view, ranks);
        let Some(averaged) = self.average.add(view.time(), &values) else {
            return Readings::default();
        };
        let [mean, contacts, fractions @ ..] = &averaged.means[..] else {
            return Readings::default();
        };
        let row = [averaged.from, averaged.looks as f64, *mean, averaged.deviations[0], *contacts];
        let mut row: Vec<Vec<f64>> = row.map(|value| vec![value]).to_vec();
        row.push(vec![fractions[0]]);
        row.push(fractions.to_vec());
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

impl Looks {
    /// Mean, number of contacts, and fractions of the particles with 0, 1, 2 ... neighbours. Collective.
    fn distribution(&self, view: &View<'_>, ranks: &dyn Communicator) -> Vec<f64> {
        let numbers = view.run().coordination_numbers(ranks);
        let whole = Distribution::of(numbers, self.settings.most).total(ranks);
        let head = [whole.mean(), 0.5 * whole.neighbours as f64];
        head.into_iter().chain(whole.fractions()).collect()
    }
}
