//! Mean and confidence interval of a few independent values.

use std::f64::consts::{FRAC_PI_2, PI};

/// Mean of independent values, with Student's interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Estimate {
    /// How many values there are.
    pub(crate) count: usize,
    /// Their mean.
    pub(crate) mean: f64,
    /// Their standard deviation, with n - 1; not a number for one value.
    pub(crate) deviation: f64,
    /// Half the width of the interval, t s / sqrt(n); not a number for one value.
    pub(crate) half_width: f64,
}

impl Estimate {
    /// The estimate at a level of confidence, for example 0.95; `None` without values.
    pub(crate) fn of(values: &[f64], confidence: f64) -> Option<Self> {
        let count = values.len();
        if count == 0 {
            return None;
        }
        let mean = values.iter().sum::<f64>() / count as f64;
        if count == 1 {
            return Some(Self { count, mean, deviation: f64::NAN, half_width: f64::NAN });
        }
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        let deviation = (squares / (count - 1) as f64).sqrt();
        let half_width = student(confidence, count - 1) * deviation / (count as f64).sqrt();
        Some(Self { count, mean, deviation, half_width })
    }
}

/// Student's t for a two-sided interval: P(|T| < t) = `confidence`.
pub(crate) fn student(confidence: f64, degrees_of_freedom: usize) -> f64 {
    // In theta = atan(t / sqrt(nu)) the probability rises steadily over a finite range.
    let (mut lower, mut upper) = (0.0, FRAC_PI_2);
    loop {
        let middle = 0.5 * (lower + upper);
        if middle <= lower || middle >= upper {
            return libm::tan(middle) * (degrees_of_freedom as f64).sqrt();
        }
        match probability(middle, degrees_of_freedom) < confidence {
            true => lower = middle,
            false => upper = middle,
        }
    }
}

/// P(|T| < t) of Student's distribution with whole degrees of freedom nu, theta = atan(t / sqrt(nu)).
/// Source: Abramowitz & Stegun 1964, 26.7.3 and 26.7.4.
fn probability(theta: f64, degrees_of_freedom: usize) -> f64 {
    let (sine, cosine) = (libm::sin(theta), libm::cos(theta));
    let odd = degrees_of_freedom % 2 == 1;
    // The terms are cos^(2k) or cos^(2k+1) with a factor 2/3 * 4/5 ... or 1/2 * 3/4 ...
    let mut term = if odd { cosine } else { 1.0 };
    let mut sum = if degrees_of_freedom == 1 { 0.0 } else { term };
    let mut index = if odd { 3 } else { 2 };
    while index + usize::from(!odd) < degrees_of_freedom {
        term *= cosine * cosine * (index - 1) as f64 / index as f64;
        sum += term;
        index += 2;
    }
    if odd { 2.0 / PI * (theta + sine * sum) } else { sine * sum }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn student_agrees_with_printed_tables() {
        // Two-sided 0.95 and 0.99, three or more decimals as printed in Abramowitz & Stegun, table 26.10.
        for (confidence, degrees, expected) in [
            (0.95, 1, 12.706),
            (0.95, 2, 4.303),
            (0.95, 3, 3.182),
            (0.95, 4, 2.776),
            (0.95, 5, 2.571),
            (0.95, 9, 2.262),
            (0.95, 30, 2.042),
            (0.99, 4, 4.604),
            (0.99, 7, 3.499),
        ] {
            let t = student(confidence, degrees);
            assert!((t - expected).abs() < 6.0e-4, "{confidence} {degrees}: {t}");
        }
    }

    #[test]
    fn an_estimate_of_known_values() {
        let estimate = Estimate::of(&[1.0, 2.0, 3.0, 4.0, 5.0], 0.95).unwrap();
        assert_eq!((estimate.count, estimate.mean), (5, 3.0));
        // t(4) = 2.776, s = sqrt(2.5): 2.776 * 1.5811 / sqrt(5).
        assert!((estimate.half_width - 1.9632).abs() < 2.0e-4, "{estimate:?}");
        let one = Estimate::of(&[7.0], 0.95).unwrap();
        assert!(one.mean == 7.0 && one.half_width.is_nan());
        assert_eq!(Estimate::of(&[], 0.95), None);
    }
}
