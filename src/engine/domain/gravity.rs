//! Effective gravity in the frame of a vibrated plate.

use crate::numbers::sine;
use std::f64::consts::PI;

/// Vertical vibration of the plate: its height in the laboratory is -A sin(2 pi f (t - start)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vibration {
    /// Gamma = A (2 pi f)^2 / g, ratio of the largest acceleration of the plate to that of gravity.
    pub relative_acceleration: f64,
    /// Frequency f in cycles per time.
    pub frequency: f64,
    /// Start of the first cycle.
    pub start: f64,
}

/// g_eff(t) = g [1 + Gamma sin(2 pi f (t - start))], downwards (Moon 2006, below eq. (5)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffectiveGravity {
    /// Acceleration g.
    pub magnitude: f64,
    /// Vibration of the plate, if it is vibrated.
    pub vibration: Option<Vibration>,
}

impl EffectiveGravity {
    /// The downward acceleration at a time.
    ///
    /// ```
    /// # use talcum_engine as talcum;
    /// use talcum::domain::{EffectiveGravity, Vibration};
    /// let shaken = Vibration { relative_acceleration: 3.0, frequency: 0.25, start: 8.0 };
    /// let gravity = EffectiveGravity { magnitude: 1.0, vibration: Some(shaken) };
    /// assert_eq!(gravity.at(8.0), 1.0);
    /// assert_eq!(gravity.at(9.0), 4.0); // a quarter of a period later
    /// ```
    pub fn at(&self, time: f64) -> f64 {
        match self.vibration {
            None => self.magnitude,
            Some(Vibration { relative_acceleration, frequency, start }) => {
                let phase = 2.0 * PI * frequency * (time - start);
                self.magnitude * (1.0 + relative_acceleration * sine(phase))
            }
        }
    }

    /// The largest magnitude of the acceleration over all times.
    pub fn largest(&self) -> f64 {
        let gamma = self.vibration.map_or(0.0, |vibration| vibration.relative_acceleration.abs());
        self.magnitude * (1.0 + gamma)
    }
}
