//! Means, errors of correlated series, confidence intervals.

use crate::analysis::no_value::{Estimate, NoValue, require_finite};
use crate::analysis::numerics::distributions::student_bound;

/// Mean and standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moments {
    /// Number of values n.
    pub count: usize,
    /// (1/n) sum x.
    pub mean: f64,
    /// sqrt(sum (x - mean)^2 / (n - 1)); 0 for one value.
    pub deviation: f64,
}

/// Mean and standard deviation, in the unit of the values. Fails without values.
pub fn moments(values: &[f64]) -> Result<Moments, NoValue> {
    require_finite("values", values)?;
    if values.is_empty() {
        return Err(NoValue::because("there are no values"));
    }
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
    let deviation = (squares / (count - 1.0).max(1.0)).sqrt();
    Ok(Moments { count: values.len(), mean, deviation })
}

/// The middle one of the sorted values; of an even number, the upper of the two middle ones. `None` without values.
pub fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied()
}

/// Mean of a series whose values are correlated with earlier ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CorrelatedMean {
    /// Mean and its standard error.
    pub mean: Estimate,
    /// Standard deviation of the values.
    pub deviation: f64,
    /// Integrated correlation time tau = 1/2 + sum_(k > 0) rho(k), in intervals of the series; 1/2 if the values are
    /// independent.
    pub correlation_time: f64,
    /// Number of independent values that would give the same error, n / (2 tau).
    pub effective_count: f64,
}

/// Mean of an evenly spaced stationary series, with a standard error sqrt(2 tau / n) times the deviation.
///
/// The correlation function is summed as long as the sums of neighbours, rho(2k) + rho(2k + 1), are positive, where
/// each is limited by the previous one (initial monotone sequence; C. J. Geyer, Stat. Sci. 7 (1992) 473-483,
/// doi:10.1214/ss/1177011137). tau is at least 1/2: a series that alternates is not considered better than independent
/// values. Fails for fewer than 8 values, or if the series is shorter than ten correlation times.
pub fn correlated_mean(values: &[f64]) -> Result<CorrelatedMean, NoValue> {
    let Moments { count, mean, deviation } = moments(values)?;
    if count < 8 {
        return Err(NoValue::because(format!("the series has {count} values; 8 are needed")));
    }
    if deviation <= 0.0 {
        let mean = Estimate { value: mean, error: 0.0 };
        let effective_count = count as f64;
        return Ok(CorrelatedMean { mean, deviation, correlation_time: 0.5, effective_count });
    }
    let correlation_time = integrated_correlation_time(values, mean).max(0.5);
    let effective_count = count as f64 / (2.0 * correlation_time);
    if effective_count < 5.0 {
        return Err(NoValue::because(format!(
            "the series of {count} values spans fewer than ten of its correlation times ({correlation_time:.3} \
             intervals)"
        )));
    }
    // The variance about the mean of the series is too small by the variance of this mean.
    let variance = deviation * deviation / (1.0 - 1.0 / effective_count);
    let mean = Estimate { value: mean, error: (variance / effective_count).sqrt() };
    Ok(CorrelatedMean { mean, deviation, correlation_time, effective_count })
}

fn integrated_correlation_time(values: &[f64], mean: f64) -> f64 {
    let covariance = |lag: usize| -> f64 {
        let pairs = values.iter().zip(&values[lag..]);
        pairs.map(|(a, b)| (a - mean) * (b - mean)).sum()
    };
    let variance = covariance(0);
    let (mut total, mut smallest) = (-0.5, f64::INFINITY);
    for lag in (0..values.len() / 2).step_by(2) {
        let pair = (covariance(lag) + covariance(lag + 1)) / variance;
        if pair <= 0.0 {
            break;
        }
        smallest = pair.min(smallest);
        total += smallest;
    }
    total
}

/// Standard error of a mean from blocks of one size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockError {
    /// Number of values in a block.
    pub size: usize,
    /// Standard error of the mean for blocks that are treated as independent: it increases with the size up to a
    /// plateau.
    pub error: Estimate,
}

/// Standard errors of a series' mean from blocks of 1, 2, 4, ... values, as long as there are at least four blocks (H.
/// Flyvbjerg, H. G. Petersen, J. Chem. Phys. 91 (1989) 461-466, doi:10.1063/1.457480): for n blocks of variance c_0
/// (sum of squares over n), sqrt(c_0 / (n - 1)) (1 +- 1 / sqrt(2 (n - 1))).
pub fn block_errors(values: &[f64]) -> Result<Vec<BlockError>, NoValue> {
    require_finite("values", values)?;
    if values.len() < 4 {
        return Err(NoValue::because(format!("there are {} values; 4 are needed", values.len())));
    }
    let mut blocks = values.to_vec();
    let mut size = 1;
    let mut errors = Vec::new();
    while blocks.len() >= 4 {
        let Moments { deviation, .. } = moments(&blocks)?;
        let count = blocks.len() as f64;
        let value = deviation / count.sqrt();
        let error = value / (2.0 * (count - 1.0)).sqrt();
        errors.push(BlockError { size, error: Estimate { value, error } });
        blocks = blocks.chunks_exact(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        size *= 2;
    }
    Ok(errors)
}

/// A mean with the interval that contains the true one with a given probability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The mean.
    pub mean: f64,
    /// Half the width of the interval: mean - half_width to mean + half_width.
    pub half_width: f64,
    /// The probability.
    pub confidence: f64,
}

/// Student's interval of a mean whose standard error has `freedom` degrees of freedom.
pub fn student_interval(
    mean: Estimate,
    freedom: f64,
    confidence: f64,
) -> Result<Interval, NoValue> {
    if !(confidence > 0.0 && confidence < 1.0) {
        return Err(NoValue::because(format!(
            "the confidence is {confidence}, not between 0 and 1"
        )));
    }
    if !(freedom >= 1.0 && freedom.is_finite()) {
        return Err(NoValue::because(format!("{freedom} degrees of freedom are fewer than one")));
    }
    let half_width = student_bound(confidence, freedom) * mean.error;
    Ok(Interval { mean: mean.value, half_width, confidence })
}

/// Mean of independent values, such as one from each of several runs that differ only in their seeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleMean {
    /// The mean, and its standard error s / sqrt(n), where s is the standard deviation with n - 1.
    pub mean: Estimate,
    /// n.
    pub samples: usize,
}

impl SampleMean {
    /// Mean of these values. Fails for fewer than two values, or if one is not finite.
    pub fn of(values: &[f64]) -> Result<Self, NoValue> {
        let Moments { count, mean, deviation } = moments(values)?;
        if count < 2 {
            return Err(NoValue::because("one value gives no error; two are needed"));
        }
        let mean = Estimate { value: mean, error: deviation / (count as f64).sqrt() };
        Ok(Self { mean, samples: count })
    }

    /// Student's interval, which contains the true mean with this probability if the values are normally distributed.
    pub fn interval(&self, confidence: f64) -> Result<Interval, NoValue> {
        student_interval(self.mean, self.samples as f64 - 1.0, confidence)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// Sum of twelve uniform numbers less six: variance 1, nearly normal.
    fn normal(random: &mut ChaCha8Rng) -> f64 {
        (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0
    }

    /// x_(k+1) = a x_k + noise: rho(k) = a^k, tau = 1/2 (1 + a) / (1 - a), variance 1 / (1 - a^2).
    fn autoregressive(seed: u64, a: f64, count: usize) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut x = normal(&mut random) / (1.0 - a * a).sqrt();
        (0..count)
            .map(|_| {
                x = a * x + normal(&mut random);
                x
            })
            .collect()
    }

    #[test]
    fn correlation_times_and_errors_of_known_series_are_met() {
        for a in [0.0, 0.5, 0.9] {
            let expected_time = 0.5 * (1.0 + a) / (1.0 - a);
            let (count, seeds) = (4000, 100);
            let (mut time, mut variance, mut squares, mut hits) = (0.0, 0.0, 0.0, 0.0);
            for seed in 0..seeds {
                let found = correlated_mean(&autoregressive(seed, a, count)).unwrap();
                time += found.correlation_time / seeds as f64;
                variance += found.mean.error * found.mean.error / seeds as f64;
                squares += found.mean.value * found.mean.value / seeds as f64;
                let interval =
                    student_interval(found.mean, found.effective_count - 1.0, 0.9).unwrap();
                hits += f64::from(u8::from(interval.mean.abs() < interval.half_width));
            }
            // The sequence is cut off at noise: for independent values the time is up to a tenth too long.
            assert!((time / expected_time - 1.0).abs() < 0.12, "{a}: {time} {expected_time}");
            // The mean square of 100 means has an error of 14 %.
            assert!((variance / squares - 1.0).abs() < 0.45, "{a}: {variance} {squares}");
            // 90 of 100, with a binomial deviation of 3.
            assert!((80.0..=99.0).contains(&hits), "{a}: {hits}");
        }
    }

    #[test]
    fn errors_of_independent_values_are_too_small_for_a_correlated_series() {
        let series = autoregressive(1, 0.9, 4096);
        let naive = moments(&series).unwrap().deviation / 64.0;
        let found = correlated_mean(&series).unwrap();
        assert!(found.mean.error > 3.0 * naive);
        let blocks = block_errors(&series).unwrap();
        assert!((blocks[0].error.value / naive - 1.0).abs() < 1e-12);
        // Blocks of 128 values, 13 correlation times, have reached the plateau; 32 blocks, 13 % error.
        let plateau = blocks.iter().find(|block| block.size == 128).unwrap().error;
        assert!((plateau.value / found.mean.error - 1.0).abs() < 0.4, "{plateau:?} {found:?}");
    }

    #[test]
    fn series_that_cannot_be_judged_say_why() {
        let line: Vec<f64> = (0..100).map(f64::from).collect();
        let reason = correlated_mean(&line).unwrap_err().to_string();
        assert!(reason.contains("fewer than ten of its correlation times"), "{reason}");
        assert!(correlated_mean(&[1.0; 4]).is_err());
        assert!(SampleMean::of(&[1.0]).unwrap_err().reason().contains("one value"));
        assert!(moments(&[1.0, f64::NAN]).unwrap_err().reason().contains("values[1] is NaN"));
    }

    #[test]
    fn intervals_of_independent_values_are_students() {
        // Mean 2, deviation 1, n = 3: t(95 %, 2) = 4.30265.
        let found = SampleMean::of(&[1.0, 2.0, 3.0]).unwrap();
        assert!((found.interval(0.95).unwrap().half_width - 4.30265 / 3.0_f64.sqrt()).abs() < 1e-4);
        // Two values 1 and 3: error 1, t(95 %, 1) = 12.7062.
        let few = SampleMean::of(&[1.0, 3.0]).unwrap();
        assert_eq!((few.mean.value, few.mean.error, few.samples), (2.0, 1.0, 2));
        assert!((few.interval(0.95).unwrap().half_width - 12.7062).abs() < 1e-4);
        // Control: the normal distribution's 1.96 errors would be six times too narrow.
        assert!(few.interval(0.95).unwrap().half_width > 6.0 * 1.96);
    }

    proptest! {
        #[test]
        fn shifting_and_scaling_values_shifts_and_scales_the_mean(
            values in prop::collection::vec(-1.0..1.0_f64, 30..60),
            shift in -5.0..5.0_f64,
        ) {
            let (Ok(a), moved) = (correlated_mean(&values), values.iter().map(|x| 2.0 * x + shift)) else {
                return Ok(());
            };
            let b = correlated_mean(&moved.collect::<Vec<_>>()).unwrap();
            prop_assert!((b.mean.value - 2.0 * a.mean.value - shift).abs() < 1e-9);
            prop_assert!((b.mean.error - 2.0 * a.mean.error).abs() < 1e-9);
        }
    }
}
