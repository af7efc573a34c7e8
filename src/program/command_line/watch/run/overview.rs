//! Overview of a run.

use super::state::RunState;
use crate::command_line::progress::readable;
use crate::command_line::report::six_digits;
use talcum_runs::case::Case;

/// Progress and state of a run.
#[derive(Clone, Debug, PartialEq)]
pub(in super::super) struct Overview {
    pub(in super::super) folder: String,
    pub(in super::super) title: String,
    pub(in super::super) state: RunState,
    /// Time of the newest row.
    pub(in super::super) time: Option<f64>,
    /// Time at which the case ends.
    pub(in super::super) end: Option<f64>,
    pub(in super::super) time_unit: String,
    /// The stage of that time, and the length of its steps.
    pub(in super::super) stage: Option<(String, f64)>,
    /// Simulated time per second.
    pub(in super::super) rate: Option<f64>,
    pub(in super::super) warnings: Vec<String>,
}

impl Overview {
    /// Adds the data of the case.
    pub(super) fn with_case(mut self, case: &Case) -> Self {
        self.title = case.title.clone();
        self.end = Some(case.end_time());
        self.stage = self.time.map(|time| {
            let stage = case.stage_at(time);
            (stage.name.clone(), stage.physics.time_step)
        });
        self
    }

    /// Fraction of the run that is done, 0 to 1.
    pub(in super::super) fn part_done(&self) -> Option<f64> {
        let (time, end) = (self.time?, self.end?);
        (end > 0.0).then(|| (time / end).clamp(0.0, 1.0))
    }

    /// Seconds until the end, if the run continues at its rate.
    pub(in super::super) fn seconds_left(&self) -> Option<f64> {
        let rate = self.rate.filter(|&rate| rate > 0.0 && self.state.is_active())?;
        Some((self.end? - self.time?).max(0.0) / rate)
    }

    /// A text such as `time 12.5 of 60 sqrt(d/g), 21 %`.
    pub(in super::super) fn progress_text(&self) -> String {
        let Some(time) = self.time.map(six_digits) else { return "no results yet".to_owned() };
        let unit = &self.time_unit;
        let percent = self.part_done().map(|part| format!(", {:.0} %", 100.0 * part));
        match self.end.map(six_digits) {
            Some(end) => format!("time {time} of {end} {unit}{}", percent.unwrap_or_default()),
            None => format!("time {time} {unit}"),
        }
    }

    /// A text such as `1200 steps/s, 36 sqrt(d/g) per minute, 45 s left`; `None` while it is not known, and after the
    /// end.
    pub(in super::super) fn pace_text(&self) -> Option<String> {
        let rate = self.rate.filter(|_| self.state.is_active())?;
        let steps =
            self.stage.as_ref().map(|(_, step)| format!("{} steps/s, ", brief(rate / step)));
        let left = self.seconds_left().map(|left| format!(", {} left", readable(left)));
        let unit = &self.time_unit;
        Some(format!(
            "{}{} {unit} per minute{}",
            steps.unwrap_or_default(),
            brief(60.0 * rate),
            left.unwrap_or_default()
        ))
    }
}

/// A number in readable form: three digits, or more if it is large.
pub(in super::super) fn brief(number: f64) -> String {
    match number.abs() {
        0.0 => "0".to_owned(),
        size if !(1.0e-3..1.0e6).contains(&size) => format!("{number:.2e}"),
        size if size >= 100.0 => format!("{number:.0}"),
        size => {
            let digits = (2.0 - size.log10().floor()) as usize;
            let text = format!("{number:.digits$}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn running() -> Overview {
        Overview {
            folder: "results/bed".to_owned(),
            title: "A bed".to_owned(),
            state: RunState::Running { holder: None },
            time: Some(15.0),
            end: Some(60.0),
            time_unit: "s".to_owned(),
            stage: Some(("settle".to_owned(), 5.0e-4)),
            rate: Some(0.5),
            warnings: Vec::new(),
        }
    }

    #[test]
    fn progress_rate_and_time_left_follow_from_time_end_and_growth() {
        let run = running();
        assert_eq!(run.progress_text(), "time 15 of 60 s, 25 %");
        assert_eq!(run.pace_text().unwrap(), "1000 steps/s, 30 s per minute, 90 s left");
        let rounded = Overview { time: Some(15.000000000000002), ..running() };
        assert_eq!(rounded.progress_text(), run.progress_text());
        let unknown = Overview { end: None, stage: None, ..running() };
        assert_eq!(unknown.progress_text(), "time 15 s");
        assert_eq!(unknown.pace_text().unwrap(), "30 s per minute");
        assert_eq!(Overview { time: None, ..running() }.progress_text(), "no results yet");
    }

    #[test]
    fn a_run_that_has_ended_has_no_pace() {
        let ended = Overview { state: RunState::Complete { digest: String::new() }, ..running() };
        assert_eq!((ended.pace_text(), ended.seconds_left()), (None, None));
        assert_eq!(Overview { rate: None, ..running() }.pace_text(), None);
    }

    #[test]
    fn numbers_are_brief() {
        let shown = [0.0, 1234.5, 12.345, 0.5, -0.01234, 2.5e-9, 3.0e7].map(brief);
        assert_eq!(shown, ["0", "1234", "12.3", "0.5", "-0.0123", "2.50e-9", "3.00e7"]);
    }
}
