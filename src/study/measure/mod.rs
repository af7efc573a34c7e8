//! What is measured on a finished run: one number with its unit.
//!
//! A *source* makes measures from the keys of a section `[measure.NAME]` of a study file. Sources are looked up
//! by name in a [`Registry`], so that another one is added without a change elsewhere.

mod series;

pub(crate) use series::Table as SeriesTable;
pub(crate) use series::{Series, Statistic, Window};

use crate::study::section::{Section, advice};
use std::fmt;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A number that a run gave.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Measured {
    /// Its value.
    pub(crate) value: f64,
    /// Its unit, `1` for pure numbers.
    pub(crate) unit: String,
}

/// Why a run gave no number.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{}: {message}", path.display())]
pub(crate) struct MeasureError {
    /// The file or folder that was read.
    pub(crate) path: PathBuf,
    /// What is wrong with it.
    pub(crate) message: String,
}

impl MeasureError {
    pub(crate) fn new(path: &Path, message: impl Into<String>) -> Self {
        Self { path: path.to_owned(), message: message.into() }
    }
}

/// How one number is taken from the results of a run.
pub(crate) trait Measure: fmt::Debug {
    /// The number.
    ///
    /// # Errors
    /// If the results do not hold it.
    fn value(&self, results: &Path) -> Result<Measured, MeasureError>;

    /// What is taken, for the head of a table.
    fn describe(&self) -> String;

    /// Refuses a measure that no run of this length can give.
    ///
    /// # Errors
    /// What is wrong, and what is allowed.
    fn check(&self, end_time: f64) -> Result<(), String>;
}

/// Makes measures from the keys of a section.
pub(crate) trait MeasureSource {
    /// What `source = "..."` calls it.
    fn name(&self) -> &'static str;

    /// The measure that a section asks for. What is wrong with its keys is reported by the section; the
    /// result is then `None`.
    fn prepare(&self, section: &Section<'_>) -> Option<Box<dyn Measure>>;
}

/// A measure with the name that a study gives it.
#[derive(Debug)]
pub(crate) struct NamedMeasure {
    /// Its name in tables.
    pub(crate) name: String,
    /// How it is taken.
    pub(crate) measure: Box<dyn Measure>,
    /// The line of the study file, from 1.
    pub(crate) line: usize,
}

/// All sources of measures.
pub(crate) struct Registry(Vec<Box<dyn MeasureSource>>);

impl Default for Registry {
    /// With the columns of `series.csv`.
    fn default() -> Self {
        Self(vec![Box::new(Series)])
    }
}

impl Registry {
    /// The measure of a section; without `source` it is a column of `series.csv`.
    pub(crate) fn prepare(&self, section: &Section<'_>) -> Option<Box<dyn Measure>> {
        let given = section.optional("source");
        let name = match &given {
            Some(entry) => entry.text()?,
            None => Series.name().to_owned(),
        };
        if let Some(source) = self.0.iter().find(|source| source.name() == name) {
            let measure = source.prepare(section);
            section.finish();
            return measure;
        }
        let names: Vec<&str> = self.0.iter().map(|source| source.name()).collect();
        if let Some(entry) = given {
            entry.fail(format!("no such source of measures: {}", advice(&name, &names)));
        }
        None
    }
}
