//! A parameter that may change with time.

use super::sine;
use std::f64::consts::PI;

/// A number as a function of time: constant, a ramp, steps, or a sine.
#[derive(Clone, Debug, PartialEq)]
pub enum Schedule {
    /// Constant in time.
    Constant(f64),
    /// `from` until `start`, then linear up to `to` at `end`, then `to`.
    Ramp {
        /// Value at `start` and before.
        from: f64,
        /// Value at `end` and after.
        to: f64,
        /// Start of the change.
        start: f64,
        /// End of the change.
        end: f64,
    },
    /// The first value until `start` + `every`, then the next value for each `every`; the last value remains.
    Steps {
        /// The values in order; at least one.
        values: Vec<f64>,
        /// Start of the first interval.
        start: f64,
        /// Length of each interval.
        every: f64,
    },
    /// mean + amplitude sin(2 pi frequency (t - start)) from `start` on; before, it is the mean.
    Sine {
        /// Mean over a period.
        mean: f64,
        /// Largest deviation from the mean.
        amplitude: f64,
        /// Cycles per time.
        frequency: f64,
        /// Start of the first cycle.
        start: f64,
    },
}

impl Schedule {
    /// The value at a time.
    ///
    /// ```
    /// # use talcum_engine as talcum;
    /// use talcum::numbers::Schedule;
    /// let ramp = Schedule::Ramp { from: 1.0, to: 3.0, start: 10.0, end: 20.0 };
    /// assert_eq!([ramp.at(0.0), ramp.at(15.0), ramp.at(99.0)], [1.0, 2.0, 3.0]);
    /// ```
    pub fn at(&self, time: f64) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Ramp { from, to, start, end } => {
                let part = ((time - start) / (end - start)).clamp(0.0, 1.0);
                from + (to - from) * part
            }
            Self::Steps { values, start, every } => {
                let step = ((time - start) / every).floor().max(0.0) as usize;
                values[step.min(values.len() - 1)]
            }
            Self::Sine { mean, amplitude, frequency, start } => {
                let phase = 2.0 * PI * frequency * (time - start).max(0.0);
                mean + amplitude * sine(phase)
            }
        }
    }

    /// The largest value over all times.
    pub fn largest(&self) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Ramp { from, to, .. } => from.max(*to),
            Self::Steps { values, .. } => values.iter().copied().fold(f64::MIN, f64::max),
            Self::Sine { mean, amplitude, .. } => mean + amplitude.abs(),
        }
    }

    /// This schedule with every value multiplied by `factor`.
    pub fn scaled(&self, factor: f64) -> Self {
        let mut scaled = self.clone();
        match &mut scaled {
            Self::Constant(value) => *value *= factor,
            Self::Ramp { from, to, .. } => {
                *from *= factor;
                *to *= factor;
            }
            Self::Steps { values, .. } => values.iter_mut().for_each(|value| *value *= factor),
            Self::Sine { mean, amplitude, .. } => {
                *mean *= factor;
                *amplitude *= factor;
            }
        }
        scaled
    }
}

#[cfg(test)]
mod tests {
    use super::Schedule;

    #[test]
    fn steps_start_on_time_and_the_last_value_remains() {
        let steps = Schedule::Steps { values: vec![1.0, 2.0, 5.0], start: 10.0, every: 4.0 };
        let at: Vec<f64> = [0.0, 10.0, 13.9, 14.0, 18.0, 1.0e6].map(|t| steps.at(t)).to_vec();
        assert_eq!(at, [1.0, 1.0, 1.0, 2.0, 5.0, 5.0]);
        assert_eq!(steps.largest(), 5.0);
        assert_eq!(steps.scaled(2.0).at(14.0), 4.0);
    }

    #[test]
    fn a_sine_starts_at_its_mean() {
        let sine = Schedule::Sine { mean: 2.0, amplitude: 0.5, frequency: 0.25, start: 3.0 };
        assert_eq!([0.0, 3.0, 4.0].map(|t| sine.at(t)), [2.0, 2.0, 2.5]);
        assert_eq!(sine.scaled(2.0).at(4.0), 5.0);
        assert_eq!(sine.largest(), 2.5);
    }
}
