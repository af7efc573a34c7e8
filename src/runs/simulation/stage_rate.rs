//! Rate at which a stage of a case is computed.

use std::time::Instant;
use talcum_engine::gas::GasModel;
use talcum_engine::timers::RecentDurations;
use talcum_results::analysis::statistics::median;

/// The present stage since its start.
pub(super) struct StageRate {
    begin: Instant,
    first_step: u64,
    /// Number of steps that are timed together: a volume-averaged gas makes a step with every n-th step of the
    /// particles.
    together: u64,
    last_timed: Option<Instant>,
    durations: RecentDurations,
}

impl StageRate {
    /// Begins timing a stage with this gas, which begins after a step.
    pub(super) fn begin(step: u64, gas: &GasModel) -> Self {
        Self {
            begin: Instant::now(),
            first_step: step,
            together: gas.substeps(),
            last_timed: None,
            durations: RecentDurations::default(),
        }
    }

    /// Records the time at which the last of the steps that are timed together ended.
    pub(super) fn note(&mut self, now: Instant) {
        if let Some(last) = self.last_timed.replace(now) {
            self.durations.note(now - last);
        }
    }

    /// A text on the steps so far, with this number of particles: their number, their rate, and the rate of the median
    /// step. Other programs on the machine, new lists and results, which delay only few steps, change only the former
    /// rate.
    pub(super) fn report(&mut self, step: u64, particles: f64) -> String {
        let rate =
            |steps: u64, seconds: f64| steps as f64 * particles / seconds.max(1.0e-9) * 1.0e-6;
        let steps = step - self.first_step;
        let all = rate(steps, self.begin.elapsed().as_secs_f64());
        let counted = format!("{steps} steps, {all:.2} million particle-steps/s");
        let seconds: Vec<f64> =
            self.durations.take_sorted().map(|took| took.as_secs_f64()).collect();
        match median(&seconds) {
            None => counted,
            Some(usual) => {
                format!("{counted}, {:.2} at the median step", rate(self.together, usual))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn few_long_steps_do_not_change_the_rate_at_the_median_step() {
        let mut rate = StageRate::begin(7, &GasModel::None);
        let mut now = Instant::now();
        for step in 8..=108 {
            now += Duration::from_millis(if step % 3 == 0 { 50 } else { 1 });
            rate.note(now);
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
            if step % 2 == 0 {
                rate.note(now);
            }
        }
        assert!(rate.report(100, 20_000.0).ends_with(", 10.00 at the median step"));
    }

    #[test]
    fn steps_that_were_not_timed_have_no_median() {
        let report = StageRate::begin(5, &GasModel::None).report(5, 100.0);
        assert_eq!(report, "0 steps, 0.00 million particle-steps/s");
    }
}
