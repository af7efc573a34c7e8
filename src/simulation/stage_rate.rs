//! How fast a stage of a case is computed.

use crate::gas::GasModel;
use crate::timers::RecentDurations;
use std::time::{Duration, Instant};

/// The present stage since it was entered.
pub(super) struct StageRate {
    begin: Instant,
    first_step: u64,
    /// Steps that are timed together: a gas in three dimensions makes a step with every n-th step of the particles.
    together: u64,
    last_timed: Option<Instant>,
    durations: RecentDurations,
}

impl StageRate {
    /// Of a stage with this gas, which begins after a step.
    pub(super) fn begin(step: u64, gas: &GasModel) -> Self {
        Self {
            begin: Instant::now(),
            first_step: step,
            together: gas.substeps(),
            last_timed: None,
            durations: RecentDurations::default(),
        }
    }

    /// Notes when the present step of the particles ended.
    pub(super) fn note_step(&mut self, step: u64, now: Instant) {
        if !step.is_multiple_of(self.together) {
            return;
        }
        if let Some(last) = self.last_timed.replace(now) {
            self.durations.note(now - last);
        }
    }

    /// The steps so far, of so many particles: how many, their rate, and that of the median step. Other programs on the machine, new
    /// lists and results, which delay few steps, change the former alone.
    pub(super) fn report(&self, step: u64, particles: f64) -> String {
        let rate = |steps: u64, took: Duration| {
            steps as f64 * particles / took.as_secs_f64().max(1.0e-9) * 1.0e-6
        };
        let steps = step - self.first_step;
        let all = rate(steps, self.begin.elapsed());
        let counted = format!("{steps} steps, {all:.2} million particle-steps/s");
        match self.durations.median() {
            None => counted,
            Some(median) => {
                format!("{counted}, {:.2} at the median step", rate(self.together, median))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_long_steps_do_not_change_the_rate_at_the_median_step() {
        let mut rate = StageRate::begin(7, &GasModel::None);
        let mut now = Instant::now();
        for step in 8..=108 {
            now += Duration::from_millis(if step % 3 == 0 { 50 } else { 1 });
            rate.note_step(step, now);
        }
        let report = rate.report(108, 20_000.0);
        assert!(report.starts_with("101 steps, "), "{report}");
        assert!(
            report.ends_with(" million particle-steps/s, 20.00 at the median step"),
            "{report}"
        );
    }

    #[test]
    fn steps_that_a_gas_makes_with_every_other_one_are_timed_in_pairs() {
        let mut rate = StageRate { together: 2, ..StageRate::begin(0, &GasModel::None) };
        let mut now = Instant::now();
        for step in 1..=100 {
            now += Duration::from_millis(if step % 2 == 0 { 3 } else { 1 });
            rate.note_step(step, now);
        }
        assert!(rate.report(100, 20_000.0).ends_with(", 10.00 at the median step"));
    }

    #[test]
    fn nothing_is_said_of_steps_that_were_not_timed() {
        let report = StageRate::begin(5, &GasModel::None).report(5, 100.0);
        assert_eq!(report, "0 steps, 0.00 million particle-steps/s");
    }
}
