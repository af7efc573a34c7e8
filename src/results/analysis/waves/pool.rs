//! Speed, period, wavelength and amplitude from all windows with waves.

use super::correlation::{NearRange, SlownessGrid};
use super::detection::Detection;
use crate::analysis::no_value::{Estimate, NoValue};
use crate::analysis::numerics::interpolation::broad_peak_near;

/// Smallest relative error of slowness and period: that of generated waves without noise.
const LEAST_ERROR: f64 = 0.002;

/// Fraction of a peak's height above which points determine its position.
const PEAK_PART: f64 = 0.7;

/// Waves of a set of windows, in nodes and intervals.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PooledWaves {
    pub(super) slowness: Estimate,
    pub(super) period: Result<Estimate, NoValue>,
    /// Twice the covariance of the travelling pattern: the square of the amplitude of a sine.
    pub(super) squared_amplitude: Estimate,
}

/// A window with waves, and the tile of the field to which it belongs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Member<'a> {
    pub(super) detection: &'a Detection,
    /// Number of the tile; windows of one tile overlap and are not independent of each other.
    pub(super) tile: usize,
}

/// Adds the stacks of all windows, and measures the peak of the sum. Standard errors are those of the jackknife that
/// leaves out one tile at a time; with fewer than three tiles they are infinite.
pub(super) fn pool(members: &[Member], grid: &SlownessGrid) -> Result<PooledWaves, NoValue> {
    let sums = TileSums::of(members, grid)?;
    let all = sums.measure(None);
    let left_out: Vec<Measured> = (0..sums.tiles.len())
        .filter(|_| sums.tiles.len() > 2)
        .map(|tile| sums.measure(Some(tile)))
        .collect();
    let error = |of: &dyn Fn(&Measured) -> Option<f64>| {
        let values: Option<Vec<f64>> = left_out.iter().map(of).collect();
        values.map_or(f64::INFINITY, |values| jackknife_error(&values))
    };
    let slowness = with_least_error(all.slowness, error(&|measured| Some(measured.slowness)));
    let squared_amplitude = Estimate {
        value: 2.0 * all.covariance,
        error: error(&|measured| Some(2.0 * measured.covariance)),
    };
    let period = match all.period {
        Some(value) => Ok(with_least_error(value, error(&|measured| measured.period))),
        None => Err(NoValue::because("the pattern does not repeat within a window")),
    };
    Ok(PooledWaves { slowness, period, squared_amplitude })
}

/// A value whose error is at least that of windows of few periods for generated waves, for which all tiles agree.
fn with_least_error(value: f64, error: f64) -> Estimate {
    let least = LEAST_ERROR * value;
    Estimate { value, error: (error * error + least * least).sqrt() }
}

/// sqrt((G - 1) / G sum (theta_g - mean)^2) for G values, each of which leaves out one group.
fn jackknife_error(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    if values.len() < 3 {
        return f64::INFINITY;
    }
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
    ((count - 1.0) / count * squares).sqrt()
}

struct Measured {
    slowness: f64,
    covariance: f64,
    period: Option<f64>,
}

/// Sums of stacks and of pattern correlations, one for each tile.
struct TileSums {
    tiles: Vec<TileSum>,
    range: NearRange,
}

#[derive(Default)]
struct TileSum {
    tile: usize,
    stack: Vec<f64>,
    pattern: Vec<f64>,
    windows: f64,
}

impl TileSums {
    fn of(members: &[Member], grid: &SlownessGrid) -> Result<Self, NoValue> {
        let none = || NoValue::because("no window has waves");
        let first = members.first().ok_or_else(none)?;
        let mut sums = Self {
            tiles: Vec::new(),
            range: NearRange::new(&first.detection.covariance, median(members), 0.4, grid),
        };
        // The second round is centred on the peak of the first.
        for extent in [0.4, 0.3] {
            sums.tiles = tile_stacks(members, &sums.range);
            let slowness = sums.measure(None).slowness;
            sums.range = NearRange::new(&first.detection.covariance, slowness, extent, grid);
        }
        sums.tiles = tile_stacks(members, &sums.range);
        let slowness = sums.measure(None).slowness;
        for member in members {
            for sum in sums.tiles.iter_mut().filter(|sum| sum.tile == member.tile) {
                add(&mut sum.pattern, &pattern(member.detection, slowness, grid));
            }
        }
        Ok(sums)
    }

    /// Measures the sum of all tiles except one.
    fn measure(&self, left_out: Option<usize>) -> Measured {
        let (mut stack, mut pattern) = (Vec::new(), Vec::new());
        let mut windows = 0.0;
        for (index, sum) in self.tiles.iter().enumerate() {
            if Some(index) != left_out {
                add(&mut stack, &sum.stack);
                add(&mut pattern, &sum.pattern);
                windows += sum.windows;
            }
        }
        let peak = NearRange::highest(&stack);
        Measured {
            slowness: self.range.slowness(broad_peak_near(&stack, peak, PEAK_PART)),
            covariance: stack[peak] / windows,
            period: period_of(&pattern),
        }
    }
}

/// Median slowness of the windows' patterns.
fn median(members: &[Member]) -> f64 {
    let mut values: Vec<f64> = members.iter().map(|member| member.detection.slowness).collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn tile_stacks(members: &[Member], range: &NearRange) -> Vec<TileSum> {
    let mut tiles: Vec<TileSum> = Vec::new();
    for member in members {
        if tiles.iter().all(|sum| sum.tile != member.tile) {
            tiles.push(TileSum { tile: member.tile, ..TileSum::default() });
        }
        for sum in tiles.iter_mut().filter(|sum| sum.tile == member.tile) {
            sum.windows += 1.0;
            add(&mut sum.stack, &member.detection.covariance.near(range));
        }
    }
    tiles
}

fn add(sum: &mut Vec<f64>, values: &[f64]) {
    if sum.is_empty() {
        sum.resize(values.len(), 0.0);
    }
    for (sum, value) in sum.iter_mut().zip(values) {
        *sum += value;
    }
}

/// Autocorrelation of the travelling pattern over lags, R(tau): mean covariance of pairs of heights along the wave's
/// ray, tau before and after it. Noise that two heights do not share adds nothing to it.
fn pattern(detection: &Detection, slowness: f64, grid: &SlownessGrid) -> Vec<f64> {
    let farthest = detection.covariance.farthest(slowness, 0.5 * grid.longest);
    let along = |shift: f64| {
        let ray = detection.covariance.along(slowness, shift, farthest.max(3));
        ray.map_or(0.0, |ray| ray.covariance)
    };
    (0..grid.longest as usize).map(|lag| 0.5 * (along(lag as f64) + along(-(lag as f64)))).collect()
}

/// The first peak of a correlation beyond its first negative value: the highest point of the first stretch that rises
/// above seven tenths of all later values, up to where it falls below one third. It must have at least a quarter of the
/// height at lag 0.
fn period_of(pattern: &[f64]) -> Option<f64> {
    let negative = pattern.iter().position(|&value| value < 0.0)?;
    let highest = pattern[negative..].iter().copied().fold(0.0_f64, f64::max);
    let rise = (negative..pattern.len()).find(|&lag| pattern[lag] >= PEAK_PART * highest)?;
    let fall = (rise..pattern.len()).find(|&lag| pattern[lag] < highest / 3.0)?;
    let peak =
        (rise..fall).fold(rise, |best, lag| if pattern[lag] > pattern[best] { lag } else { best });
    (pattern[peak] > 0.25 * pattern[0]).then(|| broad_peak_near(pattern, peak, PEAK_PART))
}
