//! Combined values of the replicates of a point.

use talcum_results::analysis::statistics::{Moments, SampleMean, moments};

/// Mean, scatter and Student's interval of the values of a point's runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Replicates {
    /// Mean of the values.
    pub(crate) mean: f64,
    /// Their standard deviation, with n - 1; NaN for one value.
    pub(crate) deviation: f64,
    /// Half the width of the interval, t s / sqrt(n); NaN for one value.
    pub(crate) half_width: f64,
}

impl Replicates {
    /// Statistics at a level of confidence, for example 0.95; `None` without values, or if one is not a number.
    pub(crate) fn of(values: &[f64], confidence: f64) -> Option<Self> {
        let Moments { count, mean, deviation } = moments(values).ok()?;
        let interval = SampleMean::of(values).and_then(|sample| sample.interval(confidence));
        let half_width = interval.map_or(f64::NAN, |interval| interval.half_width);
        let deviation = if count > 1 { deviation } else { f64::NAN };
        Some(Self { mean, deviation, half_width })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replicates_of_known_values() {
        let found = Replicates::of(&[1.0, 2.0, 3.0, 4.0, 5.0], 0.95).unwrap();
        assert_eq!(found.mean, 3.0);
        // t(4) = 2.776, s = sqrt(2.5): 2.776 * 1.5811 / sqrt(5).
        assert!((found.half_width - 1.9632).abs() < 2.0e-4, "{found:?}");
        let one = Replicates::of(&[7.0], 0.95).unwrap();
        assert!(one.mean == 7.0 && one.half_width.is_nan() && one.deviation.is_nan());
        assert_eq!(Replicates::of(&[], 0.95), None);
    }
}
