//! The part of a run from which a measure is taken.

use crate::study::section::{Entry, Section};
use std::fmt;

/// Relative tolerance of times, which are sums of steps: it is far below any interval between rows.
const SLACK: f64 = 1.0e-9;

/// The range of times of the rows that count; both ends are included.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Window {
    /// First time; the start of the run if it is not given.
    pub(crate) from: Option<f64>,
    /// Last time; the end of the run if it is not given.
    pub(crate) to: Option<f64>,
    /// Alternatively, the duration before the last row.
    pub(crate) last: Option<f64>,
}

impl Window {
    /// The smallest and the largest time of a run that ends at `end`.
    pub(crate) fn bounds(&self, end: f64) -> (f64, f64) {
        let slack = SLACK * end.abs();
        let from = self.last.map(|duration| end - duration).or(self.from);
        let to = self.to.map_or(f64::INFINITY, |to| to + slack);
        (from.map_or(f64::NEG_INFINITY, |from| from - slack), to)
    }

    /// Rejects a window that is impossible for a run of this length.
    ///
    /// # Errors
    /// The error.
    pub(crate) fn check(&self, end_time: f64) -> Result<(), String> {
        let beyond = |time: f64| time > end_time * (1.0 + SLACK);
        match *self {
            Window { from: Some(from), .. } if beyond(from) => {
                Err(format!("the window begins at {from}, but the run ends at {end_time}"))
            }
            Window { to: Some(to), .. } if to < 0.0 => {
                Err(format!("the window ends at {to}, before the run begins"))
            }
            _ => Ok(()),
        }
    }
}

impl fmt::Display for Window {
    /// A text such as ` from 50`; empty for a whole run.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ends = [("from", self.from), ("to", self.to), ("last", self.last)];
        let mut given = ends.into_iter().filter_map(|(end, time)| Some((end, time?)));
        given.try_for_each(|(end, time)| write!(formatter, " {end} {time}"))
    }
}

/// The key `window` of a section, or a whole run; `None` if it is wrong, which has then been reported.
pub(super) fn window_of(section: &Section<'_>) -> Option<Window> {
    section.optional("window").map_or_else(|| Some(Window::default()), |entry| window(&entry))
}

/// `{ from, to }` or `{ last }`.
fn window(entry: &Entry<'_>) -> Option<Window> {
    let section = entry.section()?;
    let number = |key| section.optional(key).map(|entry| entry.number());
    let (from, to, last) = (number("from"), number("to"), number("last"));
    section.finish();
    let flat = |given: Option<Option<f64>>| given.map_or(Some(None), |number| number.map(Some));
    let window = Window { from: flat(from)?, to: flat(to)?, last: flat(last)? };
    match window {
        Window { from: None, to: None, last: None }
        | Window { from: Some(_), last: Some(_), .. }
        | Window { to: Some(_), last: Some(_), .. } => {
            entry.fail("must have from, to, or both, or last");
            None
        }
        Window { from: Some(from), to: Some(to), .. } if from > to => {
            entry.fail("from must not be after to");
            None
        }
        Window { last: Some(last), .. } if last <= 0.0 => {
            entry.fail("last must be above 0");
            None
        }
        _ => Some(window),
    }
}
