//! The frame in which layers or cells are at rest.

use crate::analysis::stress::{CellGrid, Frame, StressMeasurement};
use crate::instruments::View;
use crate::instruments::registered::InstrumentValues;
use nalgebra::Vector3;
use talcum_engine::schema::{Allowed, Key, Kind, Value, Word};

/// The words of `frame`, each with its keys.
pub(super) const FRAMES: &[Word] = &[
    Word::new("laboratory", "the frame of the box"),
    Word::with(
        "wave",
        "moves upwards with a wave: layers or cells divide one wavelength, all waves of the box are laid over one another",
        &[
            Key::number("wave_speed", Allowed::FINITE, "Speed of the wave, upwards").unit("speed"),
            Key::number(
                "wavelength",
                Allowed::POSITIVE,
                "Wavelength, at most the height of the box",
            )
            .unit("length"),
            Key::new("phases", PHASES, "Average by the phase of the vibration, in so many bins")
                .optional(),
            FREQUENCY,
        ],
    ),
    Word::with(
        "phase",
        "that of the box, but samples are averaged by the phase of the vibration",
        &[Key::new("phases", PHASES, "Bins of the phase").default(Value::Count(24)), FREQUENCY],
    ),
];

const PHASES: Kind = Kind::Count(2, 1000);

const FREQUENCY: Key = Key::number("frequency", Allowed::POSITIVE, "Cycles per time")
    .unit("1/time")
    .default(Value::Derived("that of `[vibration]`"));

/// The frame of an instrument, and the bins in which its samples are averaged.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct FrameSettings {
    /// The wave with which the frame moves upwards; `None` if it is at rest in the box.
    wave: Option<Wave>,
    /// Bins of the phase of the vibration, if samples are averaged by it.
    cycle: Option<Cycle>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Wave {
    speed: f64,
    wavelength: f64,
}

/// Bins of the phase f (t - start).
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cycle {
    phases: usize,
    frequency: f64,
    start: f64,
}

impl FrameSettings {
    pub(super) fn from_keys(values: &dyn InstrumentValues) -> Option<Self> {
        let word = values.word("frame")?;
        let wave = match word {
            "wave" => Some(Wave::from_keys(values)?),
            _ => None,
        };
        let has_phases = word == "phase" || word == "wave" && values.is_given("phases");
        if !has_phases && values.is_given("frequency") {
            values.fail("frequency", "needs phases".to_owned());
            return None;
        }
        let cycle = if has_phases { Some(Cycle::from_keys(values)?) } else { None };
        Some(Self { wave, cycle })
    }

    /// Whether samples are averaged by the phase of the vibration.
    pub(super) fn has_phases(&self) -> bool {
        self.cycle.is_some()
    }

    /// Height that is divided into layers, in a box of a given height.
    pub(super) fn extent(&self, height: f64) -> f64 {
        self.wave.map_or(height, |wave| wave.wavelength)
    }

    /// Whether the layers repeat vertically.
    pub(super) fn repeats(&self) -> bool {
        self.wave.is_some()
    }

    /// Number of wavelengths in a box of a given height; each layer contains its part of every wavelength.
    pub(super) fn waves(&self, height: f64) -> f64 {
        height / self.extent(height)
    }

    /// Number of bins of the phase.
    pub(super) fn phases(&self) -> usize {
        self.cycle.map_or(1, |cycle| cycle.phases)
    }

    /// The bin of the phase at a time.
    pub(super) fn phase_at(&self, time: f64) -> usize {
        self.cycle.map_or(0, |cycle| cycle.bin_at(time))
    }

    /// The measurement of stress at the time of a view.
    pub(super) fn measurement(&self, grid: CellGrid, view: &View<'_>) -> StressMeasurement {
        let frame = self.wave.map_or_else(Frame::default, |wave| {
            let velocity = Vector3::new(0.0, 0.0, wave.speed);
            Frame { displacement: velocity * view.time(), velocity }
        });
        StressMeasurement { grid, periodicity: view.periodicity(), frame }
    }
}

impl Wave {
    fn from_keys(values: &dyn InstrumentValues) -> Option<Self> {
        let (speed, wavelength) = (values.number("wave_speed")?, values.number("wavelength")?);
        let height = values.bounds().lengths().z;
        if wavelength > height {
            let message = format!("must be at most the height of the box, {height}");
            values.fail("wavelength", message);
            return None;
        }
        Some(Self { speed, wavelength })
    }
}

impl Cycle {
    fn from_keys(values: &dyn InstrumentValues) -> Option<Self> {
        let vibration = values.vibration();
        let frequency = if values.is_given("frequency") {
            values.number("frequency")
        } else {
            vibration.map(|vibration| vibration.frequency)
        };
        if frequency.is_none() {
            let message = "is needed: no stage has a [vibration]";
            values.fail("frequency", message.to_owned());
        }
        let start = vibration.map_or(0.0, |vibration| vibration.start);
        Some(Self { phases: values.count("phases")? as usize, frequency: frequency?, start })
    }

    fn bin_at(&self, time: f64) -> usize {
        let cycles = self.frequency * (time - self.start);
        // The place is rounded, so that samples on the border of two bins fall into the same bin in every cycle.
        let place = (self.phases as f64 * (cycles - cycles.floor()) * 1.0e6).round() * 1.0e-6;
        (place as usize) % self.phases
    }
}
