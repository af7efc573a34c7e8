//! Means over the cycles of the vibration, with standard errors: plate stress, gas force, pressure drop, and position
//! and velocity of the bed.
//!
//! Formula: [`analysis::phase_average`](crate::analysis::phase_average), over one block of cycles after another.

use super::layout::{Layout, Rows, Table};
use super::registered::{InstrumentValues, RegisteredInstrument};
use super::stored::Stored;
use super::view::View;
use super::{Instrument, Needs, Readings, Setting};
use crate::analysis::SeriesRow;
use crate::analysis::phase_average::{PhaseAverage, PhaseOptions, phase_average};
use talcum_engine::fields::{Column, Unit};
use talcum_engine::parallel::Communicator;
use talcum_engine::schema::{Allowed, Key, Kind, Value};

/// Settings of the kind `phase_average`.
#[derive(Clone, Debug, PartialEq)]
pub struct PhaseAverages {
    options: PhaseOptions,
    cycles: u64,
}

/// One number of the series, in the form in which it is averaged.
struct Averaged {
    name: &'static str,
    error: &'static str,
    mean: &'static str,
    mean_error: &'static str,
    unit: Unit,
    meaning: &'static str,
    of: fn(&SeriesRow) -> f64,
}

macro_rules! averaged {
    ($($name:literal $unit:ident $meaning:literal $of:expr;)*) => {
        [$(Averaged {
            name: $name,
            error: concat!($name, "_error"),
            mean: concat!($name, "_mean"),
            mean_error: concat!($name, "_mean_error"),
            unit: Unit::$unit,
            meaning: $meaning,
            of: $of,
        }),*]
    };
}

const AVERAGED: [Averaged; 8] = averaged! {
    "plate_stress" One "force on the base plate over the bed's weight" |row| row.plate_stress;
    "gas_force" One "vertical gas force over the bed's weight" |row| row.gas_force;
    "pressure_drop" One "pressure drop times cross-section over the bed's weight" |row| row.grid_pressure_drop;
    "bed_bottom" Length "lift: height of the bed's bottom above the plate" |row| row.bed_bottom;
    "bed_top" Length "height of the bed's top above the plate" |row| row.bed_top;
    "centre_height" Length "height of the centre of mass above the plate" |row| row.centre_height;
    "centre_velocity" Speed "mean vertical velocity, by mass, relative to the plate" |row| row.centre_velocity;
    "granular_energy" Energy "kinetic energy about the mean motion" |row| row.fluctuating_kinetic_energy;
};

/// The samples of the present block of cycles, and one before it.
struct Block {
    settings: PhaseAverages,
    /// Number of the first cycle; `None` before the first sample.
    first: Option<f64>,
    /// Time, then the numbers.
    samples: Vec<[f64; AVERAGED.len() + 1]>,
}

impl RegisteredInstrument for PhaseAverages {
    const MEANING: &'static str =
        "means over vibration cycles with standard errors: plate stress, gas force, lift, velocity";

    const KEYS: &'static [Key] = &[
        Key::new("cycles", Kind::Count(2, 1_000_000), "Number of cycles that one row averages")
            .default(Value::Count(20)),
        Key::new(
            "phases",
            Kind::Count(2, 1000),
            "Bins of the phase; bin b is centred on b / phases",
        )
        .default(Value::Count(25)),
        Key::number("frequency", Allowed::POSITIVE, "Cycles per time")
            .unit("1/time")
            .default(Value::Derived("that of `[vibration]`")),
    ];

    fn from_keys(values: &dyn InstrumentValues) -> Option<Self> {
        let vibration = values.vibration();
        let frequency = if values.is_given("frequency") {
            values.number("frequency")
        } else {
            vibration.map(|vibration| vibration.frequency)
        };
        if frequency.is_none() {
            values.fail("frequency", "is needed: no stage has a [vibration]".to_owned());
        }
        let (frequency, every) = (frequency?, values.number("every")?);
        let bins = values.count("phases")? as usize;
        if every * frequency * bins as f64 > 1.000_001 {
            let most = 1.0 / (frequency * bins as f64);
            let message = format!("must be at most {most:.6}, or a bin of the phase has no sample");
            values.fail("every", message);
            return None;
        }
        let origin = vibration.map_or(0.0, |vibration| vibration.start);
        let options = PhaseOptions { frequency, origin, bins, skipped_cycles: 0 };
        Some(Self { options, cycles: values.count("cycles")? })
    }

    fn begin(&self, _: &Setting<'_>) -> Box<dyn Instrument> {
        Box::new(Block { settings: self.clone(), first: None, samples: Vec::new() })
    }
}

/// Fraction of a cycle by which a sample may miss the end of the cycle.
const TOLERANCE: f64 = 1.0e-6;

impl Block {
    /// A time in cycles, with the lower edge of the first bin at 0.
    fn place(&self, time: f64) -> f64 {
        let PhaseOptions { frequency, origin, bins, .. } = self.settings.options;
        (time - origin) * frequency + 0.5 / bins as f64
    }

    /// The row of a complete block.
    fn row(&self) -> Rows {
        let times: Vec<f64> = self.samples.iter().map(|sample| sample[0]).collect();
        let bins = self.settings.options.bins;
        let (mut scalars, mut arrays) = (Vec::new(), Vec::new());
        let mut cycles = 0;
        for place in 0..AVERAGED.len() {
            let values: Vec<f64> = self.samples.iter().map(|sample| sample[place + 1]).collect();
            let average = phase_average(&times, &values, &self.settings.options).ok();
            cycles = cycles.max(average.as_ref().map_or(0, |average| average.cycles.len()));
            let mean = average.as_ref().and_then(|average| average.cycle_mean);
            scalars.push(vec![mean.map_or(f64::NAN, |mean| mean.value)]);
            scalars.push(vec![mean.map_or(f64::NAN, |mean| mean.error)]);
            arrays.push(by_bin(average.as_ref(), |average| &average.means, bins));
            arrays.push(by_bin(average.as_ref(), |average| &average.errors, bins));
        }
        let head = vec![vec![self.first.unwrap_or(f64::NAN)], vec![cycles as f64]];
        Rows::one(0, [head, scalars, arrays].concat())
    }
}

fn by_bin(
    average: Option<&PhaseAverage>,
    of: fn(&PhaseAverage) -> &Vec<Option<f64>>,
    bins: usize,
) -> Vec<f64> {
    let undefined = || vec![f64::NAN; bins];
    average.map_or_else(undefined, |average| {
        of(average).iter().map(|value| value.unwrap_or(f64::NAN)).collect()
    })
}

impl Instrument for Block {
    fn layout(&self) -> Layout {
        let bins = self.settings.options.bins;
        let mut columns = vec![
            Column::scalar("first_cycle", Unit::One, "number of the first cycle"),
            Column::scalar("cycles", Unit::One, "number of cycles that are averaged"),
        ];
        for averaged in &AVERAGED {
            let Averaged { mean, mean_error, unit, meaning, .. } = *averaged;
            columns.push(Column::scalar(mean, unit, meaning));
            let meaning =
                "standard error of the mean over the cycle, from the spread between cycles";
            columns.push(Column::scalar(mean_error, unit, meaning));
        }
        for Averaged { name, error, unit, meaning, .. } in &AVERAGED {
            let array =
                |name, meaning| Column::array(name, &[bins], *unit, meaning).along(&["phase"]);
            columns.push(array(name, meaning));
            columns
                .push(array(error, "standard error of each bin, from the spread between cycles"));
        }
        let phase = Column::scalar("phase", Unit::One, "middle of each bin, part of a cycle");
        let values = (0..bins).map(|bin| bin as f64 / bins as f64).collect();
        let tables = vec![Table { name: "results", columns }];
        Layout { fixed: vec![phase.holding(values)], tables, ..Layout::default() }
    }

    fn needs(&self) -> Needs {
        Needs { series: true, ..Needs::default() }
    }

    fn look(&mut self, view: &View<'_>, _: &dyn Communicator) -> Readings {
        let Some(series) = view.series else { return Readings::default() };
        let place = self.place(view.time());
        let first = *self.first.get_or_insert((place - TOLERANCE).ceil());
        let mut sample = [view.time(); AVERAGED.len() + 1];
        for (number, averaged) in sample[1..].iter_mut().zip(&AVERAGED) {
            *number = (averaged.of)(series);
        }
        self.samples.push(sample);
        let next = first + self.settings.cycles as f64;
        if place < next - TOLERANCE {
            return Readings::default();
        }
        let row = self.row();
        // The sample before the border shows that the next block begins there.
        self.samples.drain(..self.samples.len().saturating_sub(2));
        self.first = Some(next);
        Readings { rows: vec![row], ..Readings::default() }
    }

    fn stored(&self, ranks: &dyn Communicator) -> Stored {
        let mut stored = Stored::default();
        let first = self.first.unwrap_or(f64::NAN);
        let samples = self.samples.as_flattened();
        let numbers: Vec<f64> = std::iter::once(&first).chain(samples).copied().collect();
        stored.add_numbers("samples", &numbers, ranks);
        stored
    }

    fn restore(&mut self, stored: &Stored, ranks: &dyn Communicator) -> Option<()> {
        let numbers = stored.numbers("samples", ranks)?;
        let (&first, samples) = numbers.split_first()?;
        self.first = (!first.is_nan()).then_some(first);
        let samples = samples.chunks_exact(AVERAGED.len() + 1);
        self.samples = samples.filter_map(|sample| sample.try_into().ok()).collect();
        Some(())
    }
}
