//! Progress of a run: a bar on a terminal, or a line from time to time in a batch log.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal, Write, stderr};
use std::time::{Duration, Instant};
use talcum_runs::simulation::Progress;

/// Time between lines without a terminal.
const BETWEEN_LINES: Duration = Duration::from_secs(30);
/// Time between changes of the bar.
const BETWEEN_DRAWS: Duration = Duration::from_millis(200);

/// Writes to standard error.
pub(super) struct ProgressReport {
    bar: Option<ProgressBar>,
    last: Option<Instant>,
}

impl ProgressReport {
    /// A report; only rank 0 writes anything.
    pub(super) fn new(is_root: bool) -> Self {
        let bar = (is_root && stderr().is_terminal()).then(|| {
            let bar = ProgressBar::new(1);
            let template = "{wide_bar} {percent:>3} %  {msg}";
            if let Ok(style) = ProgressStyle::with_template(template) {
                bar.set_style(style);
            }
            bar
        });
        Self { bar, last: None }
    }

    pub(super) fn show(&mut self, progress: &Progress) {
        let wait = if self.bar.is_some() { BETWEEN_DRAWS } else { BETWEEN_LINES };
        let last = *self.last.get_or_insert_with(Instant::now);
        if last.elapsed() < wait {
            return;
        }
        self.last = Some(Instant::now());
        let (done, left) = progress.steps;
        let message = message(progress);
        match &self.bar {
            Some(bar) => {
                bar.set_length(done + left);
                bar.set_position(done);
                bar.set_message(message);
            }
            None => {
                let percent = 100.0 * done as f64 / (done + left).max(1) as f64;
                // Nobody reads it if standard error is closed or full; the run is more important.
                let _ = writeln!(stderr(), "{percent:5.1} %  {message}");
            }
        }
    }

    pub(super) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn message(progress: &Progress) -> String {
    let Progress { time, end, steps: (done, left), particles, elapsed } = *progress;
    let seconds = elapsed.as_secs_f64().max(1.0e-9);
    let rate = done as f64 * particles as f64 / seconds * 1.0e-6;
    format!(
        "time {time:.6} of {end:.6}, {rate:.2} million particle-steps/s, {} left",
        readable(seconds * left as f64 / done.max(1) as f64)
    )
}

/// A duration in seconds in readable form: 45 s, 12 min, 3 h 20 min, 4 days.
pub(super) fn readable(seconds: f64) -> String {
    // Beyond the range of a counter, the number itself suffices.
    if seconds >= 1.0e15 {
        return format!("{:.1e} years", seconds / (365.25 * 86_400.0));
    }
    let whole = seconds as u64;
    match whole {
        0..=99 => format!("{whole} s"),
        100..=5999 => format!("{} min", (whole + 30) / 60),
        6000..=345_599 => format!("{} h {} min", whole / 3600, whole % 3600 / 60),
        _ => format!("{} days", whole / 86_400),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_read_well() {
        let message = [45.0, 750.0, 12_000.0, 400_000.0, 1.0e25].map(readable);
        assert_eq!(message, ["45 s", "13 min", "3 h 20 min", "4 days", "3.2e17 years"]);
    }
}
