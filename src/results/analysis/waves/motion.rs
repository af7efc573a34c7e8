//! Extent of the bed, motion of its material, and the places where its solids fraction varies.

use super::correlation::Window;
use super::field::Rows;
use crate::analysis::no_value::Estimate;

/// Fractions of the mass that lie below the bed's bottom and top.
const BOTTOM_SHARE: f64 = 0.01;
const TOP_SHARE: f64 = 0.97;

/// The bed's extent at every time, in nodes.
#[derive(Clone, Debug)]
pub(super) struct Bed {
    pub(super) bottom: Vec<usize>,
    pub(super) top: Vec<usize>,
}

impl Bed {
    /// Bottom and top are the heights with 1 % and 97 % of the mass below them, which are not affected by splashes of
    /// the surface and single particles.
    pub(super) fn of(rows: &Rows) -> Self {
        let reaching = |profile: &[f64], share: f64| {
            let total: f64 = profile.iter().sum();
            let mut below = 0.0;
            profile
                .iter()
                .position(|phi| {
                    below += phi;
                    below >= share * total
                })
                .unwrap_or(0)
        };
        let profiles = (0..rows.times()).map(|time| rows.profile(time));
        let (bottom, top) = profiles
            .map(|profile| (reaching(&profile, BOTTOM_SHARE), reaching(&profile, TOP_SHARE)))
            .unzip();
        Self { bottom, top }
    }

    /// Whether all nodes of a window are within the bed at nine tenths of its times.
    pub(super) fn fills(&self, window: &Window) -> bool {
        let times = window.first_time..window.first_time + window.times;
        let last = window.first_height + window.heights - 1;
        let inside = times
            .filter(|&time| self.bottom[time] <= window.first_height && last <= self.top[time])
            .count();
        10 * inside >= 9 * window.times
    }
}

/// Mass below each height over time, from which the velocity of the material follows: nothing passes the lowest node,
/// so phi u = -d/dt of the integral of phi below.
#[derive(Clone, Debug)]
pub(super) struct SolidsFlux {
    /// Sum of phi over nodes up to and including this one, \[height\]\[time\].
    below: Vec<Vec<f64>>,
    /// phi, likewise.
    values: Vec<Vec<f64>>,
    /// Velocity of one node per interval.
    unit: f64,
}

impl SolidsFlux {
    pub(super) fn of(rows: &Rows) -> Self {
        let mut below = vec![vec![0.0; rows.times()]; rows.heights()];
        let mut total = vec![0.0; rows.times()];
        for (row, sums) in rows.values.iter().zip(&mut below) {
            for ((sum, total), phi) in sums.iter_mut().zip(&mut total).zip(row) {
                *total += phi;
                *sum = *total;
            }
        }
        Self { below, values: rows.values.clone(), unit: rows.spacing / rows.interval }
    }

    /// Mean velocity in a window: slope in time of the mass below over phi, averaged over the heights; its error
    /// follows from the spread over heights, each of which counts as half a value.
    pub(super) fn velocity(&self, window: &Window) -> Estimate {
        let times = window.first_time..window.first_time + window.times;
        let heights = window.first_height..window.first_height + window.heights;
        let velocities: Vec<f64> = heights
            .map(|height| {
                let phi: f64 = self.values[height][times.clone()].iter().sum();
                let mean = phi / window.times as f64;
                let slope = slope(&self.below[height][times.clone()]);
                if mean > 0.0 { -slope / mean } else { 0.0 }
            })
            .collect();
        let count = velocities.len() as f64;
        let mean = velocities.iter().sum::<f64>() / count;
        let squares: f64 = velocities.iter().map(|value| (value - mean) * (value - mean)).sum();
        let error = (squares / (count - 1.0).max(1.0) / (0.5 * count)).sqrt();
        Estimate { value: mean * self.unit, error: error * self.unit }
    }
}

/// Slope of the least-squares line through values at 0, 1, 2, ...
fn slope(values: &[f64]) -> f64 {
    let middle = 0.5 * (values.len() as f64 - 1.0);
    let (mut products, mut squares) = (0.0, 0.0);
    for (index, value) in values.iter().enumerate() {
        let x = index as f64 - middle;
        products += x * value;
        squares += x * x;
    }
    products / squares.max(f64::MIN_POSITIVE)
}

/// Standard deviation of phi over one period around each height and time.
#[derive(Clone, Debug)]
pub(super) struct Activity {
    /// \[height\]\[column\].
    pub(super) deviations: Vec<Vec<f64>>,
    /// Time of the first column, and time between columns, in intervals; each column is one period long.
    pub(super) first: usize,
    pub(super) step: usize,
    /// Deviation above which a place is active.
    pub(super) threshold: f64,
}

impl Activity {
    /// Columns of one period, half a period apart. The threshold is not set yet.
    pub(super) fn of(rows: &Rows, period: usize) -> Self {
        let step = (period / 2).max(1);
        let deviations = rows
            .values
            .iter()
            .map(|row| row.windows(period).step_by(step).map(deviation).collect())
            .collect();
        Self { deviations, first: period / 2, step, threshold: f64::INFINITY }
    }

    /// Sets the threshold to half the median deviation in a set of windows.
    pub(super) fn set_threshold(&mut self, windows: &[Window]) {
        let mut values: Vec<f64> = windows
            .iter()
            .flat_map(|window| self.places(window))
            .map(|(height, column)| self.deviations[height][column])
            .collect();
        values.sort_by(f64::total_cmp);
        if let Some(median) = values.get(values.len() / 2) {
            self.threshold = 0.5 * median;
        }
    }

    pub(super) fn columns(&self) -> usize {
        self.deviations.first().map_or(0, Vec::len)
    }

    /// Time of a column's middle, in intervals.
    pub(super) fn time(&self, column: usize) -> usize {
        self.first + column * self.step
    }

    pub(super) fn is_active(&self, height: usize, column: usize) -> bool {
        self.deviations[height][column] > self.threshold
    }

    fn places(&self, window: &Window) -> Vec<(usize, usize)> {
        let times = window.first_time..window.first_time + window.times;
        let columns: Vec<usize> =
            (0..self.columns()).filter(|&column| times.contains(&self.time(column))).collect();
        let heights = window.first_height..window.first_height + window.heights;
        heights.flat_map(|height| columns.iter().map(move |&column| (height, column))).collect()
    }

    /// Fraction of a window's places that are active.
    pub(super) fn share(&self, window: &Window) -> f64 {
        let places = self.places(window);
        let active = places.iter().filter(|&&(height, column)| self.is_active(height, column));
        active.count() as f64 / places.len().max(1) as f64
    }
}

/// Standard deviation of all values, of which there must be at least one.
pub(super) fn deviation(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / count).sqrt()
}
