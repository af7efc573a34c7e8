//! Rates of breakage and growth by size, with counting errors.

use super::Fate;
use talcum_engine::parallel::Communicator;

/// Counts of events by the previous size of the agglomerate, over any number of pairs of samples with one interval.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RateCounts {
    /// Bin k holds `limits[k] <= members < limits[k + 1]`.
    limits: Vec<u64>,
    /// Number of members that must be lost or gained for an event.
    threshold: u64,
    /// [observed, broken, grown, lost, lost squared, gained, gained squared] by bin.
    counts: Vec<[i64; 7]>,
}

/// A rate and its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rate {
    /// The rate, per agglomerate and time.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
}

/// Rates of agglomerates of one bin of sizes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RatesOfSize {
    /// Limits of the number of members: from the first, and below the second.
    pub sizes: [u64; 2],
    /// Number of agglomerates observed over one interval.
    pub observed: u64,
    /// Breakage events per agglomerate and time: n / (N dt), with the error sqrt(n) / (N dt) of a Poisson process (if
    /// there was no event, the error is that of one).
    pub breakage: Rate,
    /// Growth events per agglomerate and time, likewise.
    pub growth: Rate,
    /// Members lost per agglomerate and time; the error is computed from the sum of the squares of single losses.
    pub lost: Rate,
    /// Members gained per agglomerate and time, likewise.
    pub gained: Rate,
}

impl RateCounts {
    /// Counts without events. Sizes outside the ascending limits are not counted; an event changes at least `threshold`
    /// members.
    pub fn new(limits: &[u64], threshold: u64) -> Self {
        let counts = vec![[0; 7]; limits.len().saturating_sub(1)];
        Self { limits: limits.to_vec(), threshold: threshold.max(1), counts }
    }

    /// Counts the fates of agglomerates of this rank.
    pub fn add<'a>(&mut self, fates: impl IntoIterator<Item = &'a Fate>) {
        for fate in fates {
            let bin = self.limits.partition_point(|&limit| limit <= fate.size);
            let Some(counts) = bin.checked_sub(1).and_then(|bin| self.counts.get_mut(bin)) else {
                continue;
            };
            let [lost, gained] = [fate.lost() as i64, fate.gained() as i64];
            let is_event = |change: i64| i64::from(change >= self.threshold as i64);
            let changes =
                [1, is_event(lost), is_event(gained), lost, lost * lost, gained, gained * gained];
            counts.iter_mut().zip(changes).for_each(|(count, change)| *count += change);
        }
    }

    /// This rank's counts, to be stored; [`RateCounts::add_stored`] adds them again, on any rank.
    pub fn stored(&self) -> Vec<i64> {
        self.counts.concat()
    }

    /// Adds counts that were stored.
    pub fn add_stored(&mut self, stored: &[i64]) {
        let counts = self.counts.iter_mut().flatten();
        counts.zip(stored).for_each(|(count, stored)| *count += stored);
    }

    /// The rates of each bin, from the counts of all ranks and the time between two samples. Collective.
    pub fn rates(&self, interval: f64, ranks: &dyn Communicator) -> Vec<RatesOfSize> {
        let mut sums = self.counts.concat();
        ranks.sum_integers(&mut sums);
        let bins = sums.chunks_exact(7).zip(self.limits.windows(2));
        bins.map(|(sums, limits)| {
            let exposure = sums[0] as f64 * interval;
            // Squares of changes; for events this is their number.
            let rate = |sum: i64, squares: i64| Rate {
                value: sum as f64 / exposure,
                error: (squares.max(1) as f64).sqrt() / exposure,
            };
            RatesOfSize {
                sizes: [limits[0], limits[1]],
                observed: sums[0] as u64,
                breakage: rate(sums[1], sums[1]),
                growth: rate(sums[2], sums[2]),
                lost: rate(sums[3], sums[4]),
                gained: rate(sums[5], sums[6]),
            }
        })
        .collect()
    }
}

/// The size at which growth and breakage are equal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Number of members.
    pub size: f64,
    /// Its standard error.
    pub error: f64,
}

/// The smallest size above which breakage is faster than growth. It lies between the middles of two bins, and growth is
/// faster in the first of them.
///
/// `choose` selects the two rates (growth, breakage), of events or of members. The logarithm of growth / breakage is
/// assumed to be linear in the logarithm of the size between the geometric middles of two bins; the result is its zero,
/// with the errors of the four rates propagated. Bins without observations or with a rate of zero are left out. `None`
/// if the rates do not cross.
pub fn crossing(
    rates: &[RatesOfSize],
    choose: impl Fn(&RatesOfSize) -> (Rate, Rate),
) -> Option<Crossing> {
    let mut points = Vec::new();
    for of_size in rates {
        let (growth, breakage) = choose(of_size);
        if of_size.observed == 0 || growth.value <= 0.0 || breakage.value <= 0.0 {
            continue;
        }
        let [low, high] = of_size.sizes.map(|size| libm::log(size as f64));
        let relative = |rate: Rate| (rate.error / rate.value).powi(2);
        let y = libm::log(growth.value / breakage.value);
        points.push((0.5 * (low + high), y, relative(growth) + relative(breakage)));
    }
    points.windows(2).find_map(|pair| {
        let [(x0, y0, variance0), (x1, y1, variance1)] = [pair[0], pair[1]];
        if y0 <= 0.0 || y1 > 0.0 {
            return None;
        }
        let part = y0 / (y0 - y1);
        let size = libm::exp(x0 + part * (x1 - x0));
        // d(part) = [(1 - part) dy0 + part dy1] / (y0 - y1).
        let variance = (1.0 - part).powi(2) * variance0 + part * part * variance1;
        Some(Crossing { size, error: size * (x1 - x0) * variance.sqrt() / (y0 - y1) })
    })
}
