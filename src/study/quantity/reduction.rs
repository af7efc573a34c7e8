//! From the values of a run over time to one number: a statistic over a window.

use super::window::Window;
use crate::input::Section;
use crate::schema::{Key, Word};

/// The key `statistic`.
pub(super) const STATISTIC: Key =
    Key::word("statistic", STATISTICS, "What is made of the rows in the window");

const STATISTICS: &[Word] = &[
    Word::new("mean", "their arithmetic mean"),
    Word::new("last", "the value in the last row"),
    Word::new("max", "the largest value"),
    Word::new("min", "the smallest value"),
    Word::new("deviation", "their standard deviation, with n - 1"),
];

/// What is computed from the rows in the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Statistic {
    /// Arithmetic mean of the rows.
    Mean,
    /// Value in the last row.
    Last,
    /// Largest value.
    Max,
    /// Smallest value.
    Min,
    /// Standard deviation of the rows about their mean, with n - 1.
    Deviation,
}

impl Statistic {
    const NAMES: [(&'static str, Self); 5] = [
        ("mean", Self::Mean),
        ("last", Self::Last),
        ("max", Self::Max),
        ("min", Self::Min),
        ("deviation", Self::Deviation),
    ];

    /// The statistic of that name.
    pub(crate) fn named(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|(known, _)| *known == name).map(|(_, statistic)| *statistic)
    }

    fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, known)| *known == self).map_or("", |(name, _)| name)
    }

    /// The statistic of values in the order of time; `None` if there are too few.
    fn of(self, values: &[f64]) -> Option<f64> {
        let last = *values.last()?;
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        match self {
            Self::Mean => Some(mean),
            Self::Last => Some(last),
            Self::Max => Some(values.iter().copied().fold(last, f64::max)),
            Self::Min => Some(values.iter().copied().fold(last, f64::min)),
            Self::Deviation if values.len() < 2 => None,
            Self::Deviation => {
                let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
                Some((squares / (values.len() - 1) as f64).sqrt())
            }
        }
    }
}

/// A statistic over a window of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reduction {
    /// What is computed.
    pub(crate) statistic: Statistic,
    /// From which rows.
    pub(crate) window: Window,
}

impl Reduction {
    /// The reduction that the keys `statistic` and `window` of a section ask for; `None` if one is wrong, which has then been reported.
    pub(super) fn of_section(section: &Section<'_>) -> Option<Self> {
        let statistic = section.choice("statistic", &Statistic::NAMES);
        let window = Window::of_section(section);
        Some(Self { statistic: statistic?, window: window? })
    }

    /// The number, from times in ascending order with their values; `end` is the last time of the run.
    ///
    /// # Errors
    /// If too few of them lie in the window.
    pub(super) fn value(
        &self,
        rows: impl Iterator<Item = (f64, f64)>,
        end: f64,
    ) -> Result<f64, String> {
        let (from, to) = self.window.bounds(end);
        let inside = rows.filter(|(time, _)| (from..=to).contains(time));
        let values: Vec<f64> = inside.map(|(_, value)| value).collect();
        self.statistic.of(&values).ok_or_else(|| {
            let rows = values.len();
            format!("{rows} rows between the times {from} and {to} are too few; the last row is at {end}")
        })
    }

    /// `mean of bed_top from 50`, and the like.
    pub(super) fn describe(&self, quantity: &str) -> String {
        format!("{} of {quantity}{}", self.statistic.name(), self.window)
    }
}
