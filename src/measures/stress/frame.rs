//! The frame in which layers are at rest.

use crate::analysis::stress::{CellGrid, Frame, StressMeasurement};
use crate::measures::View;
use crate::measures::registered::MeasureValues;
use crate::schema::{Allowed, Key, Kind, Value, Word};
use nalgebra::Vector3;

/// The words of `frame`, each with its keys.
pub(super) const FRAMES: &[Word] = &[
    Word::new("laboratory", "the frame of the box"),
    Word::with(
        "wave",
        "moves upwards with a wave: layers divide one wavelength, all waves of the box are laid over one another",
        &[
            Key::number("wave_speed", Allowed::FINITE, "Speed of the wave, upwards").unit("speed"),
            Key::number(
                "wavelength",
                Allowed::POSITIVE,
                "Wavelength, at most the height of the box",
            )
            .unit("length"),
        ],
    ),
    Word::with(
        "phase",
        "that of the box, but looks are averaged by the phase of the vibration",
        &[
            Key::new("phases", Kind::Count(2, 1000), "Bins of the phase").default(Value::Count(24)),
            Key::number("frequency", Allowed::POSITIVE, "Cycles per time")
                .unit("1/time")
                .default(Value::Derived("that of `[vibration]`")),
        ],
    ),
];

/// The frame of a measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum FrameSettings {
    /// At rest in the box.
    Laboratory,
    /// Upwards with a wave.
    Wave { speed: f64, wavelength: f64 },
    /// At rest in the box, by phase f (t - start).
    Phase { phases: usize, frequency: f64, start: f64 },
}

impl FrameSettings {
    pub(super) fn from_keys(values: &dyn MeasureValues) -> Option<Self> {
        match values.word("frame")? {
            "wave" => {
                let (speed, wavelength) =
                    (values.number("wave_speed")?, values.number("wavelength")?);
                let height = values.bounds().lengths().z;
                if wavelength > height {
                    let message = format!("must be at most the height of the box, {height}");
                    values.fail("wavelength", message);
                    return None;
                }
                Some(Self::Wave { speed, wavelength })
            }
            "phase" => {
                let vibration = values.vibration();
                let frequency = match values.is_given("frequency") {
                    true => values.number("frequency"),
                    false => vibration.map(|vibration| vibration.frequency),
                };
                if frequency.is_none() {
                    let message = "is needed: no stage has a [vibration]";
                    values.fail("frequency", message.to_owned());
                }
                let start = vibration.map_or(0.0, |vibration| vibration.start);
                let phases = values.count("phases")? as usize;
                Some(Self::Phase { phases, frequency: frequency?, start })
            }
            _ => Some(Self::Laboratory),
        }
    }

    /// Height that the layers divide, in a box of a height.
    pub(super) fn extent(&self, height: f64) -> f64 {
        if let Self::Wave { wavelength, .. } = self { *wavelength } else { height }
    }

    /// Whether the layers repeat above one another.
    pub(super) fn repeats(&self) -> bool {
        matches!(self, Self::Wave { .. })
    }

    /// Number of wavelengths in a box of a height, of which each layer holds its part.
    pub(super) fn waves(&self, height: f64) -> f64 {
        height / self.extent(height)
    }

    /// Bins of the phase.
    pub(super) fn phases(&self) -> usize {
        if let Self::Phase { phases, .. } = self { *phases } else { 1 }
    }

    /// The bin of the phase at a time.
    pub(super) fn phase_at(&self, time: f64) -> usize {
        let Self::Phase { phases, frequency, start } = *self else { return 0 };
        let cycles = frequency * (time - start);
        // Rounded, so that looks on the border of two bins fall into the same in every cycle.
        let place = (phases as f64 * (cycles - cycles.floor()) * 1.0e6).round() * 1.0e-6;
        (place as usize) % phases
    }

    /// How stress is measured at the time of a view.
    pub(super) fn measurement(&self, grid: CellGrid, view: &View<'_>) -> StressMeasurement {
        let frame = match *self {
            Self::Wave { speed, .. } => {
                let velocity = Vector3::new(0.0, 0.0, speed);
                Frame { displacement: velocity * view.time(), velocity }
            }
            _ => Frame::default(),
        };
        StressMeasurement { grid, periodicity: view.periodicity(), frame }
    }
}
