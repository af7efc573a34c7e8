//! Power spectral density of an evenly spaced series.

use crate::analysis::no_value::{Estimate, NoValue, require_finite, require_positive};
use crate::analysis::numerics::distributions::chi_square_quantile;
use crate::analysis::numerics::fourier::FourierTransform;
use crate::analysis::statistics::median;
use std::f64::consts::PI;

/// Shortest segment, in samples.
const SHORTEST_SEGMENT: usize = 16;
/// Smallest ratio of a peak to the level of the spectrum around it, relative to the upper confidence bound.
const PROMINENCE: f64 = 1.0;

/// One-sided power spectral density.
#[derive(Clone, Debug, PartialEq)]
pub struct PowerSpectrum {
    /// Frequencies, from 0 to half the sampling frequency.
    pub frequencies: Vec<f64>,
    /// Density S, whose integral over the frequencies is the variance of the series. Square of the series' unit over
    /// frequency.
    pub density: Vec<f64>,
    /// Lower and upper bound of the true density are `density` times these factors, with probability `confidence` at
    /// each single frequency.
    pub lower_factor: f64,
    /// See `lower_factor`.
    pub upper_factor: f64,
    /// Probability of the interval.
    pub confidence: f64,
    /// Degrees of freedom of each density.
    pub freedom: f64,
    /// Number of overlapping segments.
    pub segments: usize,
    /// Frequency interval over which the window broadens a sine (half power), about 1.44 over a segment's duration.
    pub resolution: f64,
}

/// A peak of a spectrum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DominantFrequency {
    /// Frequency and its standard error.
    pub frequency: Estimate,
    /// Root mean square of the series within the peak, the integral of the density over twice the resolution.
    pub rms: f64,
}

/// Welch's estimate: mean periodogram of segments of `segment` samples that overlap by half, each without its mean,
/// under a Hann window (P. D. Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70-73, doi:10.1109/TAU.1967.1161901).
///
/// S(f) = 2 dt |sum_n w_n (x_n - mean) exp(-2 pi i f n dt)|^2 / sum w^2, without the 2 at f = 0 and at half the
/// sampling frequency. The number of degrees of freedom is 2 K / (1 + 2 sum_j (1 - j/K) rho_j^2), where K is the number
/// of segments and rho_j the correlation of windows that are j half segments apart (1/6 for neighbours; Welch 1967). A
/// segment whose length is not a power of two is padded with zeros; densities at neighbouring frequencies are then not
/// independent.
///
/// `interval` is the time between samples. Fails if the series is shorter than a segment, or a segment is shorter than
/// 16.
pub fn welch(
    series: &[f64],
    interval: f64,
    segment: usize,
    confidence: f64,
) -> Result<PowerSpectrum, NoValue> {
    require_finite("series", series)?;
    require_positive("interval", interval)?;
    if !(confidence > 0.0 && confidence < 1.0) {
        return Err(NoValue::because(format!(
            "the confidence is {confidence}, not between 0 and 1"
        )));
    }
    if segment < SHORTEST_SEGMENT || series.len() < segment {
        return Err(NoValue::because(format!(
            "the series has {} samples and a segment {segment}; a segment needs {SHORTEST_SEGMENT}, the series \
             one segment",
            series.len()
        )));
    }
    let window = hann(segment);
    let step = segment / 2;
    let segments = (series.len() - segment) / step + 1;
    let density = mean_periodogram(series, &window, step, interval);
    let freedom = freedom(&window, step, segments);
    let tail = 0.5 * (1.0 - confidence);
    let size = 2 * (density.len() - 1);
    Ok(PowerSpectrum {
        frequencies: (0..density.len()).map(|k| k as f64 / (size as f64 * interval)).collect(),
        density,
        lower_factor: freedom / chi_square_quantile(1.0 - tail, freedom),
        upper_factor: freedom / chi_square_quantile(tail, freedom),
        confidence,
        freedom,
        segments,
        resolution: 1.44 / (segment as f64 * interval),
    })
}

/// w_n = sin^2(pi (n + 1/2) / N).
fn hann(segment: usize) -> Vec<f64> {
    (0..segment)
        .map(|n| {
            let sine = libm::sin(PI * (n as f64 + 0.5) / segment as f64);
            sine * sine
        })
        .collect()
}

fn mean_periodogram(series: &[f64], window: &[f64], step: usize, interval: f64) -> Vec<f64> {
    let transform = FourierTransform::at_least(window.len());
    let half = transform.size() / 2;
    let squares: f64 = window.iter().map(|weight| weight * weight).sum();
    let mut density = vec![0.0; half + 1];
    let mut segments = 0.0;
    for segment in series.windows(window.len()).step_by(step) {
        let mean = segment.iter().sum::<f64>() / segment.len() as f64;
        let weighted: Vec<f64> =
            segment.iter().zip(window).map(|(value, weight)| (value - mean) * weight).collect();
        for (sum, value) in density.iter_mut().zip(transform.spectrum(&weighted)) {
            *sum += value.norm_squared();
        }
        segments += 1.0;
    }
    for (k, value) in density.iter_mut().enumerate() {
        let sides = if k == 0 || k == half { 1.0 } else { 2.0 };
        *value *= sides * interval / (squares * segments);
    }
    density
}

/// Degrees of freedom of the mean of overlapping periodograms.
fn freedom(window: &[f64], step: usize, segments: usize) -> f64 {
    let product = |shift: usize| -> f64 {
        window.iter().zip(&window[shift.min(window.len())..]).map(|(a, b)| a * b).sum()
    };
    let count = segments as f64;
    let mut total = 1.0;
    for apart in 1..segments.min(window.len() / step + 1) {
        let rho = product(apart * step) / product(0);
        total += 2.0 * (1.0 - apart as f64 / count) * rho * rho;
    }
    2.0 * count / total
}

impl PowerSpectrum {
    /// Integral of the density over all frequencies: the variance of the series.
    pub fn variance(&self) -> f64 {
        let step = self.frequencies.get(1).copied().unwrap_or(0.0);
        self.density.iter().sum::<f64>() * step
    }

    /// The highest peak above frequency 0.
    ///
    /// Its frequency is the centroid of the density above the surrounding level, over one resolution to either side.
    /// Its standard error is the centroid's spread, sqrt(sum (f - f_0)^2 S / sum S), over the square root of half the
    /// degrees of freedom: this is too large for a sine in noise, and about right for a band of frequencies. Fails if
    /// no peak stands out: if its lower confidence bound is below the upper one of the median density, or if the
    /// density is larger below the resolution, where nothing can be distinguished from a drift.
    pub fn dominant(&self) -> Result<DominantFrequency, NoValue> {
        let step = self.frequencies.get(1).copied().unwrap_or(0.0);
        let first = (libm::ceil(self.resolution / step) as usize).max(1);
        let (last, range) = (self.density.len() - 1, first);
        let peak = (first..last)
            .filter(|&k| {
                self.density[k] >= self.density[k - 1] && self.density[k] >= self.density[k + 1]
            })
            .fold(None, |best: Option<usize>, k| match best {
                Some(other) if self.density[other] >= self.density[k] => best,
                _ => Some(k),
            })
            .ok_or_else(|| NoValue::because("the spectrum has no peak above its resolution"))?;
        if self.density[..first].iter().any(|&below| below > self.density[peak]) {
            return Err(NoValue::because(format!(
                "the record is too short: the largest density lies below the frequency {:.6}, and slower motion cannot be \
                 distinguished from a drift",
                self.frequencies[first]
            )));
        }
        let level = median(&self.density).unwrap_or(0.0);
        if self.density[peak] * self.lower_factor <= PROMINENCE * level * self.upper_factor {
            return Err(NoValue::because(format!(
                "the highest peak, at {:.6}, does not stand out from the spectrum's median within its \
                 confidence band",
                self.frequencies[peak]
            )));
        }
        let places = peak.saturating_sub(range)..=(peak + range).min(last);
        let weight = |k: usize| (self.density[k] - level).max(0.0);
        let total: f64 = places.clone().map(weight).sum();
        let centre = places.clone().map(|k| weight(k) * self.frequencies[k]).sum::<f64>() / total;
        let squares: f64 = places
            .map(|k| weight(k) * (self.frequencies[k] - centre) * (self.frequencies[k] - centre))
            .sum();
        let error = (squares / total / (0.5 * self.freedom)).sqrt();
        Ok(DominantFrequency {
            frequency: Estimate { value: centre, error },
            rms: (total * step).sqrt(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn noise(seed: u64, count: usize) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        // Uniform numbers of variance 1.
        (0..count).map(|_| (random.random::<f64>() - 0.5) * 12.0_f64.sqrt()).collect()
    }

    #[test]
    fn white_noise_has_a_flat_density_within_its_confidence_band() {
        let (interval, segment) = (0.25, 256);
        let spectrum = welch(&noise(1, 16384), interval, segment, 0.95).unwrap();
        // Variance 1 spread over frequencies up to 1 / (2 interval).
        let level = 2.0 * interval;
        let inner = &spectrum.density[2..spectrum.density.len() - 1];
        let mean = inner.iter().sum::<f64>() / inner.len() as f64;
        assert!((mean / level - 1.0).abs() < 0.03, "{mean} {level}");
        let inside = inner
            .iter()
            .filter(|&&density| {
                density * spectrum.lower_factor < level && level < density * spectrum.upper_factor
            })
            .count() as f64;
        let part = inside / inner.len() as f64;
        // 126 frequencies: 95 % with a deviation of 2 %, neighbours being correlated by the window.
        assert!((0.88..=1.0).contains(&part), "{part}");
        assert!((spectrum.variance() - 1.0).abs() < 0.03);
        assert!(spectrum.dominant().is_err(), "{:?}", spectrum.dominant());
    }

    #[test]
    fn a_sine_in_noise_is_found_with_its_frequency_and_variance() {
        let (interval, frequency, amplitude) = (0.25, 0.1637, 0.5);
        for seed in 0..10 {
            let mut series = noise(seed, 8192);
            for (index, value) in series.iter_mut().enumerate() {
                *value += amplitude * (2.0 * PI * frequency * index as f64 * interval).sin();
            }
            let spectrum = welch(&series, interval, 512, 0.95).unwrap();
            let found = spectrum.dominant().unwrap();
            let off = (found.frequency.value - frequency).abs();
            assert!(off < 3.0 * found.frequency.error && off < 0.005 * frequency, "{found:?}");
            // The error is the variance of noise under the peak: 5 %.
            assert!((found.rms / (amplitude / 2.0_f64.sqrt()) - 1.0).abs() < 0.08, "{found:?}");
            assert!((spectrum.variance() - 1.0 - 0.5 * amplitude * amplitude).abs() < 0.04);
        }
    }

    #[test]
    fn a_swing_too_slow_for_the_segments_hides_behind_no_peak_of_noise() {
        // Five periods in the record, and segments of a quarter of it, whose 1.25 periods cannot be distinguished from
        // a drift.
        let (count, interval) = (400, 0.0025);
        let swings = |periods: f64| -> Vec<f64> {
            let phase = |index: usize| 2.0 * PI * periods * index as f64 / count as f64;
            let mut series: Vec<f64> = (0..count).map(|index| phase(index).sin()).collect();
            // A weak and fast motion, which is the only one that stands out from the median.
            series.iter_mut().enumerate().for_each(|(index, value)| {
                *value += 0.01 * (2.0 * PI * 0.2 * index as f64).sin();
            });
            series
        };
        let reason = |series: &[f64]| welch(series, interval, 100, 0.95).unwrap().dominant();
        let error = reason(&swings(5.0)).unwrap_err();
        assert!(error.reason().contains("the record is too short"), "{error}");
        // Control: at four times the frequency it is found.
        let found = reason(&swings(20.0)).unwrap().frequency;
        assert!((found.value - 20.0).abs() < 1.0, "{found:?}");
    }

    #[test]
    fn parsevals_theorem_holds_for_one_segment_of_any_length() {
        for segment in [64, 100] {
            let series = noise(3, segment);
            let mean = series.iter().sum::<f64>() / segment as f64;
            let window = hann(segment);
            let squares: f64 = window.iter().map(|weight| weight * weight).sum();
            let weighted: f64 =
                series.iter().zip(&window).map(|(x, w)| (x - mean) * (x - mean) * w * w).sum();
            let variance = welch(&series, 0.1, segment, 0.9).unwrap().variance();
            // Round-off of a hundred terms.
            assert!((variance / (weighted / squares) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn short_series_are_refused() {
        assert!(welch(&[1.0; 10], 0.1, 16, 0.95).unwrap_err().reason().contains("10 samples"));
        assert!(welch(&[1.0; 100], 0.0, 16, 0.95).is_err());
        assert!(welch(&[1.0; 100], 0.1, 16, 1.0).is_err());
    }
}
