//! Waves in a bed, from the solids fraction over height and time.
//!
//! # Method
//!
//! The field is divided into overlapping windows of about three periods and two and a half wavelengths. (If no pattern
//! repeats within the record, the windows have a size for which three quarters of them show a travelling pattern with
//! one speed, which noise would do with a probability below 1e-6.) In each window, phi at every height, less its linear
//! trend in time, is correlated with phi at the other heights over time lags; the covariances of all pairs of heights
//! are averaged along straight rays, lag = slowness * distance (slant stack). The highest ray gives the slowness,
//! 1 / speed.
//!
//! # Criterion
//!
//! A pattern travels if the highest ray
//!
//! * would appear in independent noise of the same spectrum with a probability below `greatest_chance`;
//! * carries more than `least_share` of the variance;
//! * is 1.5 times as high as the ray with the opposite speed (a standing wave has both), and differs from a bed that
//!   moves as a whole: the lag across the window exceeds the time over which the pattern loses half its correlation.
//!
//! [`State`] lists the resulting states. Material velocities follow from the mass balance: a pattern that moves with
//! its material is a rising plug, not a wave.
//!
//! The slowest wave that can be distinguished from a pattern at rest crosses two nodes in half a window.
//!
//! # In the frame of the material
//!
//! Windows cannot resolve voids that occur once in the record, or that merge on their way up. The fraction of the bed's
//! material that waves sweep, [`WaveMap::swept_share`], needs no period: in the frame of the material phi of a layer
//! changes only when a wave passes. It evaluates the whole record at once: in a bed that freezes during the record, a
//! layer that waves left early counts as swept.
//!
//! Sources: slant stack, or velocity spectrum: M. T. Taner, F. Koehler, Geophysics 34 (1969) 859-881,
//! doi:10.1190/1.1440058. Degrees of freedom of correlated series: M. S. Bartlett, J. R. Stat. Soc. Suppl. 8 (1946)
//! 27-41. The significance of the stack by chi-square is derived here and tested against noise.

mod correlation;
mod detection;
mod field;
mod front;
mod map;
mod material;
mod motion;
mod pool;
mod scale;
mod summary;
#[cfg(test)]
mod tests;
mod voids;

pub use field::SolidsFractionField;
pub use front::Front;
pub use map::{Cell, State};
pub use summary::{BedState, HeightState, StateShares, TimeState, WaveMap, Waves};
pub use voids::TrackedVoids;

use crate::analysis::no_value::{NoValue, require_positive};
use detection::Criterion;
use field::Rows;

/// Parameters of the search for waves. `default()` suits a bed of several wavelengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaveOptions {
    /// Frequency of the plate. The swing of the bed's centre is removed, and phi is averaged over one period.
    pub vibration_frequency: Option<f64>,
    /// Height of a window; by default two and a half wavelengths. Length.
    pub window_height: Option<f64>,
    /// Duration of a window; by default three periods of the waves.
    pub window_duration: Option<f64>,
    /// The probability below which a pattern is not attributed to noise, for each window.
    pub greatest_chance: f64,
    /// The smallest fraction of the variance that must travel.
    pub least_share: f64,
    /// Standard deviation of phi over time below which a bed without waves counts as still, and a layer of its material
    /// as not swept.
    pub still_deviation: f64,
}

impl Default for WaveOptions {
    fn default() -> Self {
        Self {
            vibration_frequency: None,
            window_height: None,
            window_duration: None,
            greatest_chance: 1e-3,
            least_share: 0.1,
            still_deviation: 0.02,
        }
    }
}

impl WaveOptions {
    fn check(&self) -> Result<(), NoValue> {
        require_positive("greatest_chance", self.greatest_chance)?;
        require_positive("still_deviation", self.still_deviation)?;
        for (name, value) in
            [("window_height", self.window_height), ("window_duration", self.window_duration)]
        {
            value.map_or(Ok(()), |value| require_positive(name, value))?;
        }
        Ok(())
    }

    fn criterion(&self, expected: Option<f64>) -> Criterion {
        let Self { greatest_chance, least_share, .. } = *self;
        Criterion { greatest_chance, least_share, expected }
    }
}

/// Maps the states of a bed over height and time, and measures its waves.
///
/// Fails if the field is too small, not finite or empty of solids; a bed without waves is a result, not a failure.
pub fn map_waves(field: &SolidsFractionField, options: &WaveOptions) -> Result<WaveMap, NoValue> {
    options.check()?;
    let rows = Rows::prepare(field, options.vibration_frequency)?;
    summary::map_rows(&rows, options)
}
