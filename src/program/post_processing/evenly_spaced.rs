//! Rows at even intervals of time, as required by correlations and spectra.

use talcum_results::analysis::NoValue;
use talcum_results::analysis::statistics::median;

/// Relative difference below which intervals count as even.
const EVEN: f64 = 1.0e-6;

/// Times at even intervals, and the rows that represent them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct EvenRows {
    /// First time.
    pub(super) start: f64,
    /// Interval between times.
    pub(super) interval: f64,
    /// A row for each time.
    pub(super) rows: Vec<usize>,
}

impl EvenRows {
    /// Even rows for ascending times. If these are not evenly spaced (because a stage ends between two of them, or
    /// because of a restart), the row nearest to each multiple of the median interval is taken.
    pub(super) fn of(times: &[f64]) -> Result<Self, NoValue> {
        let intervals: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let (Some(interval), [start, .., last]) = (median(&intervals), times) else {
            return Err(NoValue::because(format!(
                "there are {} times; two are needed",
                times.len()
            )));
        };
        let even = intervals.iter().all(|other| (other - interval).abs() <= EVEN * interval);
        let count = libm::round((last - start) / interval) as usize + 1;
        let rows = if even {
            (0..times.len()).collect()
        } else {
            (0..count).map(|k| nearest(times, start + k as f64 * interval)).collect()
        };
        Ok(Self { start: *start, interval, rows })
    }

    /// The values of the rows.
    pub(super) fn pick(&self, values: &[f64]) -> Vec<f64> {
        self.rows.iter().map(|&row| values[row]).collect()
    }
}

/// The index of the ascending time that is nearest to a given one; the earlier of two.
pub(super) fn nearest(times: &[f64], time: f64) -> usize {
    let after = times.partition_point(|&other| other < time);
    let distance = |place: usize| times.get(place).map_or(f64::INFINITY, |t| (t - time).abs());
    match after.checked_sub(1) {
        Some(before) if distance(before) <= distance(after) => before,
        _ => after,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_rows_are_taken_as_they_are_and_others_by_the_nearest() {
        let even = EvenRows::of(&[0.0, 0.25, 0.5, 0.75]).unwrap();
        assert_eq!((even.interval, even.rows), (0.25, vec![0, 1, 2, 3]));
        // A stage ends at 0.55, and the next one counts its intervals from there.
        let uneven = EvenRows::of(&[0.0, 0.25, 0.5, 0.55, 0.8, 1.05, 1.3]).unwrap();
        assert_eq!((uneven.interval, uneven.rows), (0.25, vec![0, 1, 2, 4, 5, 6]));
        assert!(EvenRows::of(&[1.0]).is_err());
    }
}
