//! Mixing: mean square displacement, dispersion coefficients, and the Lacey index.
//!
//! Formulas: [`analysis::mixing`](crate::analysis::mixing), after Liu et al. (2016), eq. (2), and Lacey (1954).

mod tracers;

use super::layout::{Layout, Rows, Table};
use super::registered::{InstrumentValues, RegisteredInstrument};
use super::stored::Stored;
use super::view::View;
use super::{Instrument, Readings, Setting};
use crate::analysis::mixing::{
    Displacements, MeanDisplacement, Positioned, largest_secant, slope_between,
};
use crate::analysis::statistics::SampleMean;
use talcum_engine::fields::Column;
use talcum_engine::fields::Unit::{self, Area, Diffusivity, Length, One, Time};
use talcum_engine::parallel::Communicator;
use talcum_engine::schema::{Allowed, Key, Value, Word};
use tracers::{TRACERS, TracerSettings, Tracers};

/// Probability with which the interval contains the true mean, if the slopes of windows are normally distributed.
const CONFIDENCE: f64 = 0.95;

/// Settings of the kind `mixing`.
#[derive(Clone, Debug, PartialEq)]
pub struct Mixing {
    looks_per_window: u64,
    fit_from: f64,
    /// Whether displacements are relative to their mean.
    about_mean: bool,
    tracers: TracerSettings,
}

/// Displacements over windows of time.
struct Followed {
    settings: Mixing,
    tracers: Tracers,
    /// Displacements since the start of the window; `None` before the first sample.
    displacements: Option<Displacements>,
    reference_time: f64,
    /// Lag and S^2 along x, y and z of the present window.
    curve: Vec<[f64; 4]>,
    /// Slopes and largest secants along x, y and z, window by window.
    slopes: Vec<[f64; 6]>,
}

const ABOUT: &[Word] = &[
    Word::new("start", "displacement from where a particle was at the start of the window"),
    Word::new("mean", "the same less the mean displacement of all particles"),
];

impl RegisteredInstrument for Mixing {
    const MEANING: &'static str = "mean square displacement, dispersion coefficients, and the Lacey index of a class of particles";

    const KEYS: &'static [Key] = &[
        Key::number(
            "window",
            Allowed::POSITIVE,
            "Time after which displacements start again from zero, a whole multiple of `every`; each window gives one value of \
             the dispersion coefficients",
        )
        .unit("time"),
        Key::number(
            "fit_from",
            Allowed::NOT_NEGATIVE,
            "Lag from which a straight line is fitted to half of the mean square displacement",
        )
        .unit("time")
        .default(Value::Derived("a quarter of `window`")),
        Key::word("about", ABOUT, "What displacements are measured from")
            .default(Value::Word("start")),
        Key::word("tracers", TRACERS, "The class of particles whose mixing the Lacey index measures")
            .default(Value::Word("none")),
    ];

    fn from_keys(values: &dyn InstrumentValues) -> Option<Self> {
        let (every, window) = (values.number("every")?, values.number("window")?);
        let looks = window / every;
        if looks < 1.999 || (looks - looks.round()).abs() > 1.0e-6 * looks {
            let message =
                format!("must be a whole multiple of every, {every}, and at least twice it");
            values.fail("window", message);
            return None;
        }
        let fit_from =
            if values.is_given("fit_from") { values.number("fit_from")? } else { 0.25 * window };
        if fit_from > window - 0.999 * every {
            values.fail("fit_from", "leaves fewer than two samples in a window".to_owned());
            return None;
        }
        let about_mean = values.word("about")? == "mean";
        let tracers = TracerSettings::from_keys(values)?;
        Some(Self { looks_per_window: looks.round() as u64, fit_from, about_mean, tracers })
    }

    fn begin(&self, setting: &Setting<'_>) -> Box<dyn Instrument> {
        Box::new(Followed {
            settings: self.clone(),
            tracers: Tracers::new(&self.tracers, setting.bounds),
            displacements: None,
            reference_time: 0.0,
            curve: Vec::new(),
            slopes: Vec::new(),
        })
    }
}

const OF_LOOK: [(&str, Unit, &str); 12] = [
    ("lag", Time, "time since the start of the window"),
    ("square_x", Area, "mean square displacement along x"),
    ("square_y", Area, "mean square displacement along y"),
    ("square_z", Area, "mean square displacement along z"),
    ("mean_x", Length, "mean displacement along x"),
    ("mean_y", Length, "mean displacement along y"),
    ("mean_z", Length, "mean displacement along z"),
    ("particles", One, "particles that have been there since the start of the window"),
    ("lacey_index", One, "Lacey index M: 0 segregated, 1 mixed at random"),
    ("lacey_error", One, "standard deviation of M for a random mixture"),
    ("tracer_fraction", One, "part of the tracers among the particles of the cells used"),
    ("lacey_cells", One, "cells with enough particles"),
];

const OF_WINDOW: [(&str, Unit, &str); 15] = [
    ("windows", One, "number of windows so far"),
    ("fitted_x", Diffusivity, "D_sx of this window, slope of S^2 from `fit_from` on"),
    ("fitted_y", Diffusivity, "D_sy"),
    ("fitted_z", Diffusivity, "D_sz"),
    ("secant_x", Diffusivity, "largest S^2 / t of this window along x"),
    ("secant_y", Diffusivity, "along y"),
    ("secant_z", Diffusivity, "along z"),
    ("dispersion_x", Diffusivity, "D_sx, mean of the fitted values of all windows so far"),
    ("dispersion_x_error", Diffusivity, "its standard error"),
    ("dispersion_y", Diffusivity, "D_sy"),
    ("dispersion_y_error", Diffusivity, "its standard error"),
    ("dispersion_z", Diffusivity, "D_sz"),
    ("dispersion_z_error", Diffusivity, "its standard error"),
    ("half_interval_z", Diffusivity, "half of the 95 % interval of D_sz (Student's t)"),
    ("fit_from", Time, "lag from which the line is fitted"),
];

fn scalars(described: &[(&'static str, Unit, &'static str)]) -> Vec<Column> {
    let column = |&(name, unit, meaning): &(_, _, _)| Column::scalar(name, unit, meaning);
    described.iter().map(column).collect()
}

impl Instrument for Followed {
    fn layout(&self) -> Layout {
        let tables = vec![
            Table { name: "results", columns: scalars(&OF_LOOK) },
            Table { name: "dispersion", columns: scalars(&OF_WINDOW) },
        ];
        Layout { tables, ..Layout::default() }
    }

    fn look(&mut self, view: &View<'_>, ranks: &dyn Communicator) -> Readings {
        let samples = view.samples();
        self.tracers.mark(samples, ranks);
        let positions: Vec<Positioned> = samples
            .iter()
            .map(|particle| Positioned { id: particle.id, position: particle.position })
            .collect();
        let Some(displacements) = &mut self.displacements else {
            self.displacements = Some(Displacements::begin(&positions, view.periodicity()));
            self.reference_time = view.time();
            return Readings::default();
        };
        displacements.look(&positions, view.ownership(), ranks);
        let lag = view.time() - self.reference_time;
        let Some(moved) = displacements.mean(ranks) else { return Readings::default() };
        let half =
            if self.settings.about_mean { moved.half_variance() } else { moved.half_square() };
        self.curve.push([lag, half.x, half.y, half.z]);
        let mut readings = Readings::default();
        readings.rows.push(self.row(lag, &moved, view, ranks));
        if self.curve.len() as u64 >= self.settings.looks_per_window {
            readings.rows.push(self.end_window(view.time()));
        }
        readings
    }

    fn stored(&self, ranks: &dyn Communicator) -> Stored {
        let mut stored = Stored::default();
        let tracks = self.displacements.as_ref().map(Displacements::stored).unwrap_or_default();
        let tracks: Vec<[u64; 7]> = talcum_engine::parallel::records_of_bytes(&tracks).collect();
        stored.add_records("tracks", &tracks);
        let begun = f64::from(u8::from(self.displacements.is_some()));
        stored.add_numbers("window", &[begun, self.reference_time], ranks);
        stored.add_numbers("curve", self.curve.as_flattened(), ranks);
        stored.add_numbers("slopes", self.slopes.as_flattened(), ranks);
        self.tracers.store(&mut stored);
        stored
    }

    fn restore(&mut self, stored: &Stored, ranks: &dyn Communicator) -> Option<()> {
        let [begun, reference_time] = stored.numbers("window", ranks)?[..] else { return None };
        let tracks: Vec<[u64; 7]> = stored.records("tracks")?;
        let periodicity = self.tracers.periodicity();
        let displacements = Displacements::restore(bytemuck::cast_slice(&tracks), periodicity);
        self.displacements = (begun == 1.0).then_some(displacements);
        self.reference_time = reference_time;
        self.curve = rows_of(&stored.numbers("curve", ranks)?);
        self.slopes = rows_of(&stored.numbers("slopes", ranks)?);
        self.tracers.restore(stored, ranks)
    }
}

fn rows_of<const N: usize>(numbers: &[f64]) -> Vec<[f64; N]> {
    numbers.chunks_exact(N).filter_map(|row| row.try_into().ok()).collect()
}

impl Followed {
    /// The row of a sample. Collective.
    fn row(
        &self,
        lag: f64,
        moved: &MeanDisplacement,
        view: &View<'_>,
        ranks: &dyn Communicator,
    ) -> Rows {
        let lacey = self.tracers.lacey(view.samples(), ranks);
        let (square, mean) = (moved.square, moved.mean);
        let of_lacey = lacey.map_or([f64::NAN; 4], |lacey| {
            [lacey.index, lacey.error, lacey.fraction, lacey.cells as f64]
        });
        let of_motion = [lag, square.x, square.y, square.z, mean.x, mean.y, mean.z];
        let mut row = [0.0; OF_LOOK.len()];
        row[..7].copy_from_slice(&of_motion);
        row[7] = moved.particles as f64;
        row[8..].copy_from_slice(&of_lacey);
        Rows::of(0, &[row])
    }

    /// The row of a window that has ended; begins the next window.
    fn end_window(&mut self, time: f64) -> Rows {
        let curve = |axis: usize| -> Vec<[f64; 2]> {
            self.curve.iter().map(|point| [point[0], point[axis + 1]]).collect()
        };
        let from = self.settings.fit_from * (1.0 - 1.0e-9);
        let fitted = [0, 1, 2]
            .map(|axis| slope_between(&curve(axis), from, f64::INFINITY).unwrap_or(f64::NAN));
        let secant = [0, 1, 2].map(|axis| largest_secant(&curve(axis)).unwrap_or(f64::NAN));
        let slopes = [fitted[0], fitted[1], fitted[2], secant[0], secant[1], secant[2]];
        self.slopes.push(slopes);
        let estimate = |axis: usize| {
            SampleMean::of(&self.slopes.iter().map(|slopes| slopes[axis]).collect::<Vec<f64>>())
        };
        let undefined = [f64::NAN; 2];
        let all = [0, 1, 2]
            .map(|axis| estimate(axis).map_or(undefined, |it| [it.mean.value, it.mean.error]));
        let interval = estimate(2).and_then(|it| it.interval(CONFIDENCE));
        let interval = interval.map_or(f64::NAN, |it| it.half_width);
        let mut row = [0.0; OF_WINDOW.len()];
        row[0] = self.slopes.len() as f64;
        row[1..7].copy_from_slice(&slopes);
        row[7..13].copy_from_slice(all.as_flattened());
        (row[13], row[14]) = (interval, self.settings.fit_from);
        self.curve.clear();
        self.reference_time = time;
        if let Some(displacements) = &mut self.displacements {
            displacements.restart();
        }
        Rows::of(1, &[row])
    }
}
