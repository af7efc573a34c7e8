//! Correlation of the solids fraction between heights and over time lags, and its stack along straight rays.

use super::field::Rows;
use crate::analysis::numerics::fourier::{Complex, Direction, FourierTransform};
use crate::analysis::numerics::interpolation::value_at;

/// Smallest separation of heights that are correlated with each other, in nodes: hat weights spread a particle over two
/// nodes, so that neighbours share noise.
const LEAST_SEPARATION: usize = 2;
/// A peak of the stack that is this near to the highest one is preferred if its wave is faster: slower ones are aliases
/// of it due to the spacing of heights.
const TIE: f64 = 0.85;

/// A part of the field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Window {
    pub(super) first_height: usize,
    pub(super) heights: usize,
    pub(super) first_time: usize,
    pub(super) times: usize,
}

/// C_m(l) = < x_j(t) x_(j+m)(t + l) >, the mean over heights j and over those times t for which both are within the
/// window; x is phi at a height less its linear trend in time.
#[derive(Clone, Debug)]
pub(super) struct LaggedCovariance {
    /// \[separation m\]\[lag l + longest\].
    values: Vec<Vec<f64>>,
    heights: usize,
    longest: usize,
}

impl LaggedCovariance {
    /// The covariance of a window, for separations up to `most` nodes and lags up to four fifths of the window.
    pub(super) fn of(rows: &Rows, window: Window, most: usize) -> Self {
        let transform = FourierTransform::at_least(2 * window.times);
        let spectra: Vec<Vec<Complex>> = (0..window.heights)
            .map(|height| {
                let row = &rows.values[window.first_height + height];
                let part = &row[window.first_time..window.first_time + window.times];
                transform.spectrum(&without_trend(part))
            })
            .collect();
        let longest = window.times * 4 / 5;
        let values = (0..=most.min(window.heights - 1))
            .map(|separation| {
                let products = mean_cross_spectrum(&spectra, separation);
                lags(products, &transform, longest, window.times)
            })
            .collect();
        Self { values, heights: window.heights, longest }
    }

    /// Variance of phi over time, averaged over the heights.
    pub(super) fn variance(&self) -> f64 {
        self.values[0][self.longest]
    }

    pub(super) fn separations(&self) -> usize {
        self.values.len() - 1
    }

    /// Correlation at one height over a lag.
    fn autocorrelation(&self, lag: usize) -> f64 {
        self.values[0][self.longest + lag] / self.variance()
    }

    /// The first lag at which the correlation at one height falls below one half, in intervals.
    pub(super) fn half_time(&self) -> f64 {
        let beyond = (1..=self.longest).find(|&lag| self.autocorrelation(lag) < 0.5);
        beyond.map_or(self.longest as f64, |lag| {
            let (before, after) = (self.autocorrelation(lag - 1), self.autocorrelation(lag));
            lag as f64 - (0.5 - after) / (before - after)
        })
    }

    /// Half the degrees of freedom of one row, N / (2 sum_l (1 - |l|/N) rho(l)^2): N/2 for white noise, about 1 for a
    /// sine.
    pub(super) fn freedom(&self, times: usize) -> f64 {
        let half = times / 2;
        let total: f64 = (1..=half.min(self.longest))
            .map(|lag| {
                let rho = self.autocorrelation(lag);
                2.0 * (1.0 - lag as f64 / times as f64) * rho * rho
            })
            .sum();
        (times as f64 / (2.0 * (1.0 + total))).max(1.0)
    }

    fn pairs(&self, separation: usize) -> f64 {
        (self.heights - separation) as f64
    }

    fn at(&self, separation: usize, lag: f64) -> f64 {
        value_at(&self.values[separation], lag + self.longest as f64)
    }

    /// The largest separation whose lag along a ray is at most `longest`.
    pub(super) fn farthest(&self, slowness: f64, longest: f64) -> usize {
        let farthest = longest / slowness.abs().max(f64::MIN_POSITIVE);
        (farthest.min(self.separations() as f64)) as usize
    }

    /// Mean covariance along the ray l = s m + shift, over pairs up to `farthest` nodes apart; `slowness` is s in
    /// intervals per node. `None` if there are no pairs.
    pub(super) fn along(&self, slowness: f64, shift: f64, farthest: usize) -> Option<RayMean> {
        let (mut total, mut pairs) = (0.0, 0.0);
        for separation in LEAST_SEPARATION..=farthest.min(self.separations()) {
            let lag = slowness * separation as f64 + shift;
            if lag.abs() <= self.longest as f64 {
                total += self.pairs(separation) * self.at(separation, lag);
                pairs += self.pairs(separation);
            }
        }
        (pairs > 0.0).then(|| RayMean { covariance: total / pairs, pairs })
    }

    /// Covariances along rays of similar slownesses, all over the same pairs, so that they can be compared closely.
    pub(super) fn near(&self, range: &NearRange) -> Vec<f64> {
        (0..=2 * range.half)
            .map(|index| {
                let ray = self.along(range.slowness(index as f64), 0.0, range.farthest);
                ray.map_or(0.0, |ray| ray.covariance)
            })
            .collect()
    }
}

/// Slownesses around a given one, and the separations of the pairs to be used.
#[derive(Clone, Copy, Debug)]
pub(super) struct NearRange {
    middle: f64,
    step: f64,
    half: usize,
    farthest: usize,
}

impl NearRange {
    /// A range to either side of `middle` by a fraction `extent` of it, but at least by one step of the grid; pairs
    /// extend up to the separation at which the lag of the middle is the longest of the grid.
    pub(super) fn new(
        covariance: &LaggedCovariance,
        middle: f64,
        extent: f64,
        grid: &SlownessGrid,
    ) -> Self {
        const HALF: usize = 40;
        let farthest = covariance.farthest(middle, grid.longest).max(LEAST_SEPARATION);
        let width = (extent * middle.abs()).max(1.5 * grid.step);
        Self { middle, step: width / HALF as f64, half: HALF, farthest }
    }

    pub(super) fn slowness(&self, place: f64) -> f64 {
        self.middle + (place - self.half as f64) * self.step
    }

    /// Index of the highest of the values.
    pub(super) fn highest(values: &[f64]) -> usize {
        (0..values.len()).fold(0, |best, at| if values[at] > values[best] { at } else { best })
    }
}

/// Mean covariance along a ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct RayMean {
    pub(super) covariance: f64,
    /// Number of pairs of heights in the mean.
    pub(super) pairs: f64,
}

fn without_trend(values: &[f64]) -> Vec<f64> {
    let count = values.len() as f64;
    let middle = 0.5 * (count - 1.0);
    let mean = values.iter().sum::<f64>() / count;
    let (mut slope, mut squares) = (0.0, 0.0);
    for (index, value) in values.iter().enumerate() {
        let x = index as f64 - middle;
        slope += x * (value - mean);
        squares += x * x;
    }
    slope /= squares.max(f64::MIN_POSITIVE);
    let line = |index: usize| mean + slope * (index as f64 - middle);
    values.iter().enumerate().map(|(index, value)| value - line(index)).collect()
}

fn mean_cross_spectrum(spectra: &[Vec<Complex>], separation: usize) -> Vec<Complex> {
    let mut total = vec![Complex::default(); spectra[0].len()];
    for (lower, upper) in spectra.iter().zip(&spectra[separation..]) {
        for ((sum, &a), &b) in total.iter_mut().zip(lower).zip(upper) {
            let product = a.conjugate_times(b);
            sum.re += product.re;
            sum.im += product.im;
        }
    }
    let scale = 1.0 / (spectra.len() - separation) as f64;
    for sum in &mut total {
        sum.re *= scale;
        sum.im *= scale;
    }
    total
}

fn lags(
    mut products: Vec<Complex>,
    transform: &FourierTransform,
    longest: usize,
    times: usize,
) -> Vec<f64> {
    transform.transform(&mut products, Direction::Inverse);
    let size = transform.size();
    (0..=2 * longest)
        .map(|index| {
            let overlap = times - index.abs_diff(longest);
            products[(index + size - longest) % size].re / overlap as f64
        })
        .collect()
}

/// Evenly spaced slownesses s from -half to half steps; intervals of time per node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SlownessGrid {
    pub(super) step: f64,
    pub(super) half: usize,
    /// The longest lag that is used.
    pub(super) longest: f64,
}

impl SlownessGrid {
    /// A grid that extends as far as lags of half a window allow; the lag between the farthest heights changes by one
    /// interval with each step.
    pub(super) fn new(times: usize, separations: usize) -> Self {
        let longest = 0.5 * times as f64;
        let step = 1.0 / separations.max(LEAST_SEPARATION) as f64;
        let half = (longest / LEAST_SEPARATION as f64 / step) as usize;
        Self { step, half, longest }
    }

    pub(super) fn slowness(&self, place: f64) -> f64 {
        (place - self.half as f64) * self.step
    }

    /// The stack of a window: mean covariance along the ray of each slowness.
    pub(super) fn stack(&self, covariance: &LaggedCovariance) -> Stack {
        let rays = (0..=2 * self.half).map(|index| {
            let slowness = self.slowness(index as f64);
            covariance.along(slowness, 0.0, covariance.farthest(slowness, self.longest))
        });
        let (covariances, pairs) =
            rays.map(|ray| ray.map_or((0.0, 0.0), |ray| (ray.covariance, ray.pairs))).unzip();
        Stack { covariances, pairs }
    }
}

/// Mean covariance along rays, for each slowness of a grid.
#[derive(Clone, Debug, Default)]
pub(super) struct Stack {
    pub(super) covariances: Vec<f64>,
    pub(super) pairs: Vec<f64>,
}

impl Stack {
    /// Covariance, weighted by the square root of the number of pairs: fewer pairs give more noise.
    fn strength(&self, index: usize) -> f64 {
        self.covariances[index] * self.pairs[index].sqrt()
    }

    /// Index of the peak: the highest one, or that of a faster wave that is nearly as high.
    pub(super) fn peak(&self) -> Option<usize> {
        let middle = self.covariances.len() / 2;
        let highest =
            (0..self.covariances.len()).map(|index| self.strength(index)).fold(0.0_f64, f64::max);
        (1..self.covariances.len().saturating_sub(1))
            .filter(|&index| {
                let here = self.strength(index);
                here > 0.0
                    && here >= TIE * highest
                    && here >= self.strength(index - 1)
                    && here >= self.strength(index + 1)
            })
            .min_by_key(|&index| index.abs_diff(middle))
    }
}
