//! Quantities of a finished run: one number with its unit, or one text each.
//!
//! A quantity comes from a *source*, a file of this folder: the keys of a section `[measure.NAME]` of a study file, or a name
//! in its list `measures`, say which. A [`Registry`] makes them.

mod analysis;
mod case_instruments;
mod reduction;
mod series;
mod window;

pub(crate) use reduction::{Reduction, Statistic};
pub(crate) use series::reduced;
pub(crate) use window::Window;

use crate::study::problem::error_at;
use crate::study::run_outline::RunOutline;
use analysis::Analysis;
use case_instruments::ResultStatistic;
use std::fmt;
use std::path::{Path, PathBuf};
use talcum_engine::schema::{self, Key, Word};
use talcum_results::output::OutputError;
use talcum_runs::input::{InputError, Section};

/// Keys of `[measure.NAME]`.
pub(crate) const KEYS: &[Key] = &[Key::word("source", SOURCES, "Where the quantity comes from")
    .default(schema::Value::Word("series"))];

const SOURCES: &[Word] = &[
    Word::with("series", "a statistic of a column of `series.csv`", series::KEYS),
    Word::with(
        "case",
        "a statistic of a number of an instrument, a section `[measure.NAME]` of the case",
        case_instruments::KEYS,
    ),
    Word::with("analysis", "a number or text of `talcum analyse`", analysis::KEYS),
];

/// What a run gave.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    /// A number.
    Number(f64),
    /// A text, such as the state of a bed.
    Text(String),
    /// Nothing, for this reason: a bed without waves has no speed of waves.
    Nothing(String),
}

/// What a run gave, with its unit.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Measured {
    /// Its value.
    pub(crate) value: Value,
    /// Its unit, `1` for pure numbers.
    pub(crate) unit: String,
}

impl Measured {
    /// A number with its unit.
    pub(crate) fn number(value: f64, unit: &str) -> Self {
        Self { value: Value::Number(value), unit: unit.to_owned() }
    }
}

/// How one number or text is taken from the results of a run.
pub(crate) trait Quantity: fmt::Debug {
    /// What the run gave.
    ///
    /// # Errors
    /// If the results cannot be read, or lack what the quantity needs.
    fn value(&self, results: &Path) -> Result<Measured, OutputError>;

    /// What is taken, for the head of a table.
    fn describe(&self) -> String;

    /// Refuses a quantity that this run cannot give.
    ///
    /// # Errors
    /// What is wrong, and what is allowed.
    fn check(&self, run: &RunOutline) -> Result<(), String>;

    /// Why this run will have no value, as far as its case shows.
    fn impossible(&self, _run: &RunOutline) -> Option<String> {
        None
    }

    /// The texts that it may give; `None` if it gives numbers.
    fn texts(&self) -> Option<&'static [&'static str]> {
        None
    }

    /// Whether a run may have no value, which is no error.
    fn may_be_nothing(&self) -> bool {
        false
    }
}

/// A quantity with the name that a study gives it.
#[derive(Debug)]
pub(crate) struct NamedQuantity {
    /// Its name in tables.
    pub(crate) name: String,
    /// How it is taken.
    pub(crate) quantity: Box<dyn Quantity>,
    /// The line of the study file, from 1.
    pub(crate) line: usize,
}

impl NamedQuantity {
    /// An error of it.
    pub(crate) fn error(&self, message: String) -> InputError {
        error_at(self.line, format!("measure.{}", self.name), message)
    }
}

/// Makes quantities from sections and from names. What `talcum analyse` finds on a run is kept for all of them.
#[derive(Debug, Default)]
pub(crate) struct Registry(Analysis);

impl Registry {
    /// The quantity that a section `[measure.NAME]` asks for. What is wrong with its keys is reported by the section; the
    /// result is then `None`.
    pub(crate) fn read(&self, section: &Section<'_>) -> Option<Box<dyn Quantity>> {
        match section.word("source")? {
            "case" => case_instruments::read(section),
            "analysis" => self.0.read(section),
            _ => series::read(section),
        }
    }

    /// The number or text of `talcum analyse` with this name, of the whole run.
    ///
    /// # Errors
    /// What to write instead, if it is no such name.
    pub(crate) fn named(&self, name: &str) -> Result<Box<dyn Quantity>, String> {
        let found = self.0.over(name, Window::default());
        found.map_err(|advice| format!("no such quantity: {advice}"))
    }

    /// The quantity of a name on results that are there: a number of `talcum analyse`, as in `waves.speed`, or a column of an
    /// instrument of the case, as in `network.mean_age`. The times of the reduction hold for both kinds; its statistic is that
    /// of rows.
    ///
    /// # Errors
    /// If the name stands for no number of any of them.
    pub(crate) fn of_results(
        &self,
        name: &str,
        reduction: Reduction,
        results: &[PathBuf],
    ) -> Result<Box<dyn Quantity>, String> {
        let advice = match self.0.over(name, reduction.window) {
            Ok(quantity) if quantity.texts().is_some() => {
                return Err("is a text: only numbers have means".to_owned());
            }
            Ok(quantity) => return Ok(quantity),
            Err(advice) => advice,
        };
        let of_case = name.split_once('.').map(|(instrument, column)| ResultStatistic {
            instrument: instrument.to_owned(),
            column: column.to_owned(),
            reduction,
        });
        match of_case.filter(|statistic| results.iter().any(|it| statistic.is_in(it))) {
            Some(statistic) => Ok(Box::new(statistic)),
            None => Err(format!("no number of talcum analyse: {advice}")),
        }
    }
}
