//! Times at which results are due.

use talcum_engine::state::Clock;

/// Time between two results of a kind; `None` if it is not requested. A result is due at each multiple of it, at the
/// nearest step, whatever the previous steps were.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interval(pub(super) Option<f64>);

impl Interval {
    /// Whether a result is due after a step.
    pub(super) fn due(self, clock: &Clock, step: u64) -> bool {
        let Some(interval) = self.0 else { return false };
        // The same numbers are used whether a step is queried as the present one or as the previous one, so none is
        // missed.
        let multiples = |step| ((clock.time_of(step) + 0.5 * clock.time_step) / interval).floor();
        step == 0 || step > clock.origin_step && multiples(step) > multiples(step - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn due_times(clock: &Clock, interval: f64, steps: u64) -> Vec<f64> {
        let steps = clock.step..clock.step + steps;
        let due = |step: &u64| Interval(Some(interval)).due(clock, *step);
        steps.filter(due).map(|step| clock.time_of(step)).collect()
    }

    #[test]
    fn rows_fall_on_multiples_of_their_interval() {
        let clock = Clock::new(2.5e-4);
        let times = due_times(&clock, 0.25, 1_000_000);
        assert_eq!(times.len(), 1000);
        let exact =
            times.iter().zip(0..).all(|(time, k)| (time - 0.25 * f64::from(k)).abs() < 1e-9);
        assert!(exact);
        // Intervals that are not multiples of the step: the nearest step, also half-way and below a step.
        for interval in [1.1e-3, 1.5 * 2.5e-4, 3.7e-4, 2.5e-4, 1.0e-4] {
            let times = due_times(&clock, interval, 10_000);
            let expected = (10_000.0 * 2.5e-4 / interval).min(10_000.0);
            assert!((times.len() as f64 - expected).abs() <= 1.0, "{interval}: {}", times.len());
        }
        assert!(due_times(&clock, 1.0e-4, 100).len() == 100 && !Interval(None).due(&clock, 0));
    }

    #[test]
    fn rows_fall_on_multiples_of_their_interval_after_the_step_has_changed() {
        let (before, after) = (2.5e-4, 1.0e-4);
        let clock = Clock { step: 1003, ..Clock::new(before) }.with_time_step(after);
        let times = due_times(&clock, 0.25, 100_000);
        // From 0.25075 on, for 10 time units: 0.5, 0.75, ...; 0.25 was due before.
        assert_eq!(times.len(), 40);
        let off = |(time, k): (&f64, u32)| (time - 0.25 * f64::from(k)).abs();
        let farthest = times.iter().zip(2..).map(off).fold(0.0, f64::max);
        assert!(farthest <= 0.5 * after + 1.0e-9, "{farthest}");
        // Multiples of 2500 steps would be elsewhere, by up to half an interval.
        let other = clock.time_of(2500) / 0.25;
        assert!((other - other.round()).abs() > 0.2);
    }
}
