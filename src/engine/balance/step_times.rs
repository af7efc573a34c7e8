//! Duration of this rank's steps without waiting for other ranks.

use crate::timers::{Phase, RecentDurations, Timers};
use std::time::Duration;

/// Times of the work that cut planes divide among the ranks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoadTimes {
    /// Motion of particles, copies of ghosts, and the forces of walls and a column gas on particles.
    pub on_particles: Duration,
    /// Pairs of particles.
    pub on_pairs: Duration,
}

impl LoadTimes {
    fn spent(timers: &Timers) -> Self {
        let of_particles = [Phase::Integrate, Phase::CopyGhosts, Phase::Walls, Phase::GasForce];
        Self {
            on_particles: of_particles.iter().map(|&phase| timers.spent(phase)).sum(),
            on_pairs: timers.spent(Phase::Contacts),
        }
    }

    fn since(self, then: Self) -> Self {
        Self {
            on_particles: self.on_particles - then.on_particles,
            on_pairs: self.on_pairs - then.on_pairs,
        }
    }

    fn total(self) -> Duration {
        self.on_particles + self.on_pairs
    }
}

/// The times of the last steps. It reads no clock: the phases of the step are timed anyway, and none of those used here
/// includes messages.
#[derive(Clone, Debug, Default)]
pub struct StepTimes {
    /// Times at the last step, and at the last check; none before the first step of a run.
    noted: Option<[LoadTimes; 2]>,
    /// Steps since the last check.
    steps: RecentDurations,
}

impl StepTimes {
    /// Records that a step begins, and the duration of the previous one.
    pub fn note(&mut self, timers: &Timers) {
        let now = LoadTimes::spent(timers);
        let Some([last_step, _]) = &mut self.noted else {
            self.noted = Some([now; 2]);
            return;
        };
        let took = now.since(std::mem::replace(last_step, now)).total();
        self.steps.note(took);
    }

    /// Mean times of a step since the last call, zero if there was none. The longer half of the steps is left out:
    /// other programs disturb a core for many steps, and their number differs from rank to rank and from check to
    /// check. Steps at which inner lists are made are thus left out too, as is the phase of new lists. Ranks wait for
    /// each other at each step, so it is best if the most frequent steps are even.
    pub fn take_mean(&mut self) -> LoadTimes {
        let Some([now, last_look]) = self.noted else { return LoadTimes::default() };
        let all = now.since(last_look);
        self.noted = Some([now; 2]);
        let steps = self.steps.take_sorted();
        let kept = steps.len().div_ceil(2);
        let sum: Duration = steps.take(kept).sum();
        if all.total().is_zero() || kept == 0 {
            return LoadTimes::default();
        }
        let part = sum.div_f64(kept as f64).div_duration_f64(all.total());
        LoadTimes {
            on_particles: all.on_particles.mul_f64(part),
            on_pairs: all.on_pairs.mul_f64(part),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean after steps of these numbers of microseconds, three quarters of which are spent on pairs. Ranks then
    /// wait for as long again.
    fn mean_of(steps: impl IntoIterator<Item = u64>) -> [f64; 2] {
        let (mut timers, mut times) = (Timers::default(), StepTimes::default());
        times.note(&timers);
        for step in steps {
            timers.add(Phase::Integrate, Duration::from_micros(step).mul_f64(0.125));
            timers.add(Phase::CopyGhosts, Duration::from_micros(step).mul_f64(0.125));
            timers.add(Phase::Contacts, Duration::from_micros(step).mul_f64(0.75));
            timers.add(Phase::ExchangeGhosts, Duration::from_micros(step));
            times.note(&timers);
        }
        let LoadTimes { on_particles, on_pairs } = times.take_mean();
        assert_eq!(times.take_mean(), LoadTimes::default(), "there are no steps since");
        [on_particles, on_pairs].map(|time| 1.0e6 * time.as_secs_f64())
    }

    fn assert_close(found: [f64; 2], wanted: [f64; 2]) {
        let close = |(found, wanted): (f64, f64)| (found - wanted).abs() < 0.01; // times are rounded to 1 ns
        assert!(found.into_iter().zip(wanted).all(close), "{found:?}, {wanted:?}");
    }

    #[test]
    fn the_mean_of_steps_leaves_out_the_longer_half() {
        assert_close(mean_of([100; 50]), [25.0, 75.0]);
        assert_close(mean_of([]), [0.0; 2]);
        assert_close(mean_of([80]), [20.0, 60.0]);
        let disturbed = |n: u64| if n < 95 { 150 } else { 100 };
        assert_close(mean_of((0..200).map(disturbed)), [25.0, 75.0]);
        // Control: time that more than half of the steps take belongs to the mean.
        let slow = |n: u64| if n < 160 { 150 } else { 100 };
        assert_close(mean_of((0..200).map(slow)), [0.25 * 130.0, 0.75 * 130.0]);
    }

    #[test]
    fn time_before_the_first_step_does_not_count() {
        let (mut timers, mut times) = (Timers::default(), StepTimes::default());
        timers.add(Phase::Contacts, Duration::from_micros(9_000));
        times.note(&timers);
        timers.add(Phase::Contacts, Duration::from_micros(100));
        times.note(&timers);
        let wanted = LoadTimes { on_pairs: Duration::from_micros(100), ..LoadTimes::default() };
        assert_eq!(times.take_mean(), wanted);
    }

    #[test]
    fn the_last_of_very_many_steps_are_kept() {
        let steps = (0..2 * RecentDurations::MOST)
            .map(|n| if n < RecentDurations::MOST { 500 } else { 100 });
        assert_close(mean_of(steps), [25.0, 75.0]);
    }
}
