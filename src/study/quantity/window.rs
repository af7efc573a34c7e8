//! The part of a run that a quantity is taken from.

use crate::input::Section;
use crate::schema::{Allowed, Key, Kind};
use std::fmt;

/// The key `window`.
pub(super) const WINDOW: Key =
    Key::new("window", Kind::Table(KEYS), "The times that count").optionally("the whole run");

const KEYS: &[Key] = &[
    Key::number("from", Allowed::FINITE, "First time, not after the end of the run")
        .unit("time")
        .or(&["last"])
        .optionally("the start of the run"),
    Key::number("to", Allowed::FINITE, "Last time, not before `from`")
        .unit("time")
        .or(&["last"])
        .optionally("the end of the run"),
    Key::number("last", Allowed::POSITIVE, "Instead: so much time before the last row")
        .unit("time")
        .or(&["from", "to"])
        .optional(),
];

/// Times of rows are sums of steps: one part in 10^9 is far below any interval between them.
const SLACK: f64 = 1.0e-9;

/// Which rows count, by their time; both ends belong to it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Window {
    /// First time; the start of the run if it is not given.
    pub(crate) from: Option<f64>,
    /// Last time; the end of the run if it is not given.
    pub(crate) to: Option<f64>,
    /// Instead: so much time before the last row.
    pub(crate) last: Option<f64>,
}

impl Window {
    /// The key `window` of a section, or a whole run; `None` if it is wrong, which has then been reported.
    pub(super) fn of_section(section: &Section<'_>) -> Option<Self> {
        if !section.has("window") {
            return Some(Self::default());
        }
        let table = section.table("window")?;
        let [from, to, last] = ["from", "to", "last"].map(|key| table.number(key));
        if !["from", "to", "last"].iter().any(|key| table.has(key)) {
            section.fail("window", "must have from, to, or both, or last");
            return None;
        }
        if from.zip(to).is_some_and(|(from, to)| from > to) {
            table.fail("to", "must not be before from");
            return None;
        }
        Some(Self { from, to, last })
    }

    /// The smallest and the largest time of a run that ends at `end`.
    pub(crate) fn bounds(&self, end: f64) -> (f64, f64) {
        let slack = SLACK * end.abs();
        let from = self.last.map(|duration| end - duration).or(self.from);
        let to = self.to.map_or(f64::INFINITY, |to| to + slack);
        (from.map_or(f64::NEG_INFINITY, |from| from - slack), to)
    }

    /// Refuses a window that no run of this length has.
    ///
    /// # Errors
    /// What is wrong.
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
    /// ` from 50`, and the like; nothing for a whole run.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ends = [("from", self.from), ("to", self.to), ("last", self.last)];
        let mut given = ends.into_iter().filter_map(|(end, time)| Some((end, time?)));
        given.try_for_each(|(end, time)| write!(formatter, " {end} {time}"))
    }
}
