//! Pace of a run, from the growth of its files.

use std::collections::VecDeque;
use std::time::SystemTime;

/// Number of rows over which the mean is taken.
const SAMPLES: usize = 60;

/// The times that the run has reached, with the times of observation.
#[derive(Clone, Debug, Default)]
pub(super) struct Pace {
    samples: VecDeque<(SystemTime, f64)>,
}

impl Pace {
    /// Records that the run had reached a time. An earlier time means that it has started again.
    pub(super) fn note(&mut self, at: SystemTime, time: f64) {
        if self.samples.back().is_some_and(|&(_, last)| time < last) {
            self.samples.clear();
        }
        if self.samples.back().is_none_or(|&(last, reached)| at > last && time > reached) {
            self.samples.push_back((at, time));
        }
        if self.samples.len() > SAMPLES {
            self.samples.pop_front();
        }
    }

    /// Whether nothing has been recorded.
    pub(super) fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    /// Clears the records: the run has stopped, and a pause has no bearing on its speed.
    pub(super) fn forget(&mut self) {
        self.samples.clear();
    }

    /// Simulated time per second; `None` until there has been growth.
    pub(super) fn rate(&self) -> Option<f64> {
        let (first, last) = (self.samples.front()?, self.samples.back()?);
        let seconds = last.0.duration_since(first.0).ok()?.as_secs_f64();
        (seconds > 0.0).then(|| (last.1 - first.1) / seconds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, UNIX_EPOCH};

    fn at(seconds: u64) -> SystemTime {
        UNIX_EPOCH + Duration::from_secs(seconds)
    }

    #[test]
    fn the_rate_is_growth_over_the_time_between_writes() {
        let mut pace = Pace::default();
        pace.note(at(100), 1.0);
        assert_eq!(pace.rate(), None);
        pace.note(at(104), 3.0);
        assert_eq!(pace.rate(), Some(0.5));
        // A repeated row is not growth.
        pace.note(at(200), 3.0);
        assert_eq!(pace.rate(), Some(0.5));
    }

    #[test]
    fn only_the_newest_rows_count_and_a_new_beginning_starts_again() {
        let mut pace = Pace::default();
        let slow_then_fast = (0..200).map(|n| (n, if n < 100 { 0.1 } else { 1.0 } * n as f64));
        for (second, time) in slow_then_fast {
            pace.note(at(second), time);
        }
        assert!((pace.rate().unwrap() - 1.0).abs() < 1.0e-12);
        pace.note(at(300), 0.5);
        assert_eq!(pace.rate(), None);
        pace.note(at(301), 0.75);
        assert_eq!(pace.rate(), Some(0.25));
        pace.forget();
        assert_eq!(pace.rate(), None);
    }
}
