//! The solids fraction over height and time, and its preparation for the search for waves.

use crate::analysis::no_value::{NoValue, require_finite, require_positive};
use crate::analysis::numerics::interpolation::value_at;

/// Smallest numbers of times and heights for the search for waves.
const FEWEST_TIMES: usize = 16;
const FEWEST_HEIGHTS: usize = 6;

/// The solids fraction phi on evenly spaced heights and times.
#[derive(Clone, Debug)]
pub struct SolidsFractionField<'a> {
    /// phi\[time * heights + height\].
    pub values: &'a [f64],
    /// Number of heights.
    pub heights: usize,
    /// Height of the lowest node, below which there are no solids. Length.
    pub lowest: f64,
    /// Distance between heights. Length.
    pub spacing: f64,
    /// First time.
    pub start: f64,
    /// Interval between times.
    pub interval: f64,
}

impl SolidsFractionField<'_> {
    /// Number of times.
    pub fn times(&self) -> usize {
        self.values.len() / self.heights.max(1)
    }

    fn check(&self) -> Result<(), NoValue> {
        require_positive("the spacing of heights", self.spacing)?;
        require_positive("the interval of times", self.interval)?;
        if self.heights < FEWEST_HEIGHTS || self.times() < FEWEST_TIMES {
            let (times, heights) = (self.times(), self.heights);
            return Err(NoValue::because(format!(
                "the field has {times} times and {heights} heights; at least {FEWEST_TIMES} and \
                 {FEWEST_HEIGHTS} are needed"
            )));
        }
        if !self.values.len().is_multiple_of(self.heights) {
            return Err(NoValue::because("the field's length is not a multiple of its heights"));
        }
        require_finite("solids_fraction", self.values)
    }
}

/// The field as rows of constant height, without the swing of a vibrated bed.
#[derive(Clone, Debug)]
pub(super) struct Rows {
    /// phi\[height\]\[time\].
    pub(super) values: Vec<Vec<f64>>,
    pub(super) lowest: f64,
    pub(super) spacing: f64,
    pub(super) start: f64,
    pub(super) interval: f64,
    /// Time over which the rows are running means; 0 if they are not averaged.
    pub(super) averaged_over: f64,
}

impl Rows {
    /// Rows of a bed at rest, or of one on a plate that vibrates with the given frequency.
    ///
    /// In a vibrated bed the swing of the centre of mass z_c = sum(z phi) / sum(phi) about its mean over one period of
    /// the plate is removed by shifting the heights, and every height is averaged over one period of the plate. The
    /// record becomes shorter by one period.
    pub(super) fn prepare(
        field: &SolidsFractionField,
        vibration_frequency: Option<f64>,
    ) -> Result<Self, NoValue> {
        field.check()?;
        let rows = Self::of(field);
        let Some(frequency) = vibration_frequency else { return Ok(rows) };
        require_positive("the vibration's frequency", frequency)?;
        let period = 1.0 / frequency;
        if rows.times() as f64 * rows.interval < 2.0 * period + FEWEST_TIMES as f64 * rows.interval
        {
            return Err(NoValue::because("the record spans too few periods of the plate"));
        }
        if period < 4.0 * rows.interval {
            return Err(NoValue::because(
                "there are fewer than four times in a period of the plate",
            ));
        }
        Ok(rows.without_swing(period).averaged(period))
    }

    fn of(field: &SolidsFractionField) -> Self {
        let values = (0..field.heights)
            .map(|height| {
                field.values.iter().skip(height).step_by(field.heights).copied().collect()
            })
            .collect();
        Self {
            values,
            lowest: field.lowest,
            spacing: field.spacing,
            start: field.start,
            interval: field.interval,
            averaged_over: 0.0,
        }
    }

    pub(super) fn heights(&self) -> usize {
        self.values.len()
    }

    pub(super) fn times(&self) -> usize {
        self.values.first().map_or(0, Vec::len)
    }

    pub(super) fn height_of(&self, node: f64) -> f64 {
        self.lowest + node * self.spacing
    }

    pub(super) fn time_of(&self, index: f64) -> f64 {
        self.start + index * self.interval
    }

    /// phi over height at one time.
    pub(super) fn profile(&self, time: usize) -> Vec<f64> {
        self.values.iter().map(|row| row[time]).collect()
    }

    /// Height of the centre of mass at each time, in nodes.
    fn centre(&self) -> Vec<f64> {
        (0..self.times())
            .map(|time| {
                let (mut mass, mut moment) = (0.0, 0.0);
                for (height, row) in self.values.iter().enumerate() {
                    mass += row[time];
                    moment += height as f64 * row[time];
                }
                if mass > 0.0 { moment / mass } else { 0.0 }
            })
            .collect()
    }

    fn without_swing(mut self, period: f64) -> Self {
        let centre = self.centre();
        let mean = running_mean(&centre, period / self.interval);
        for (time, (&centre, &mean)) in centre.iter().zip(&mean).enumerate() {
            let profile = self.profile(time);
            for (height, row) in self.values.iter_mut().enumerate() {
                row[time] = value_at(&profile, height as f64 + centre - mean);
            }
        }
        self
    }

    fn averaged(mut self, period: f64) -> Self {
        let width = period / self.interval;
        let margin = libm::ceil(0.5 * width) as usize;
        let kept = margin..self.times() - margin;
        for row in &mut self.values {
            *row = running_mean(row, width)[kept.clone()].to_vec();
        }
        self.start += margin as f64 * self.interval;
        self.averaged_over = period;
        self
    }

    /// Factor by which the running mean reduces a sine's amplitude: sin(x) / x, x = pi `averaged_over` / period.
    pub(super) fn attenuation(&self, period: f64) -> f64 {
        let x = std::f64::consts::PI * self.averaged_over / period;
        if x < 1e-6 { 1.0 } else { libm::sin(x) / x }
    }
}

/// Mean over `width` intervals about each point, of the line through the points; at both ends, over the part that
/// exists.
pub(super) fn running_mean(values: &[f64], width: f64) -> Vec<f64> {
    let mut integral = vec![0.0; values.len()];
    for index in 1..values.len() {
        integral[index] = integral[index - 1] + 0.5 * (values[index - 1] + values[index]);
    }
    let last = values.len().saturating_sub(1);
    let integral_to = |place: f64| {
        let below = (place as usize).min(last);
        let part = place - below as f64;
        let next = values[(below + 1).min(last)];
        integral[below] + part * (values[below] + 0.5 * part * (next - values[below]))
    };
    (0..values.len())
        .map(|index| {
            let from = (index as f64 - 0.5 * width).max(0.0);
            let to = (index as f64 + 0.5 * width).min(last as f64);
            if to > from {
                (integral_to(to) - integral_to(from)) / (to - from)
            } else {
                values[index]
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn a_running_mean_removes_its_own_period_and_keeps_lines() {
        let width = 12.5;
        let sine: Vec<f64> = (0..200).map(|i| (2.0 * PI * f64::from(i) / width).sin()).collect();
        let line: Vec<f64> = (0..200).map(|i| 0.3 * f64::from(i)).collect();
        for index in 20..180 {
            // The line through 12.5 points of a sine deviates by (pi / 12.5)^2 / 3 at most.
            assert!(running_mean(&sine, width)[index].abs() < 0.02);
            assert!((running_mean(&line, width)[index] - line[index]).abs() < 1e-9);
        }
    }

    #[test]
    fn fields_that_cannot_be_measured_say_why() {
        let mut field = SolidsFractionField {
            values: &[0.5; 400],
            heights: 20,
            lowest: 0.0,
            spacing: 1.0,
            start: 0.0,
            interval: 0.0,
        };
        let reason = Rows::prepare(&field, None).unwrap_err();
        assert!(reason.to_string().contains("the interval of times is 0; it must be positive"));
        field.interval = 1.0;
        assert!(Rows::prepare(&field, None).is_ok());
        assert!(Rows::prepare(&field, Some(0.01)).is_err());
        field.heights = 3;
        assert!(Rows::prepare(&field, None).is_err());
    }
}
