//! Measures of a finished run: one number with its unit, or one text.
//!
//! A *source* makes measures from the keys of a section `[measure.NAME]` of a study file, and from names in its list
//! `measures`. Sources are looked up by name in a [`Registry`], so that another one can be added without a change
//! elsewhere.

mod analysis;
mod case_measures;
mod reduction;
mod series;
mod window;

pub(crate) use reduction::{Reduction, Statistic};
pub(crate) use series::{Series, reduced};
pub(crate) use window::Window;

use crate::output::OutputError;
use crate::study::run_outline::RunOutline;
use crate::study::section::{Section, advice};
use analysis::Analysis;
use case_measures::{CaseMeasures, ResultStatistic};
use std::fmt;
use std::path::{Path, PathBuf};
use window::window_of;

/// Value of a measure for a run.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    /// A number.
    Number(f64),
    /// A text, such as the state of a bed.
    Text(String),
    /// No value, for this reason: a bed without waves has no wave speed.
    Nothing(String),
}

/// Value of a measure for a run, with its unit.
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

/// A measure that takes one number or text from the results of a run.
pub(crate) trait Measure: fmt::Debug {
    /// Its value for a run.
    ///
    /// # Errors
    /// If the results cannot be read, or lack the required data.
    fn value(&self, results: &Path) -> Result<Measured, OutputError>;

    /// Its description, for the head of a table.
    fn describe(&self) -> String;

    /// Checks whether this run can give the measure.
    ///
    /// # Errors
    /// The error, and the allowed choices.
    fn check(&self, run: &RunOutline) -> Result<(), String>;

    /// The reason why this run will have nothing to measure, as far as its case shows.
    fn impossible(&self, _run: &RunOutline) -> Option<String> {
        None
    }

    /// The possible texts; `None` if it gives numbers.
    fn texts(&self) -> Option<&'static [&'static str]> {
        None
    }

    /// Whether a run may have nothing to measure without this being an error.
    fn may_be_nothing(&self) -> bool {
        false
    }
}

/// Makes measures from the keys of a section, or from names alone.
pub(crate) trait MeasureSource {
    /// Its name in `source = "..."`.
    fn name(&self) -> &'static str;

    /// The measure requested by a section. Errors in its keys are reported through the section; the result is then
    /// `None`.
    fn prepare(&self, section: &Section<'_>) -> Option<Box<dyn Measure>>;

    /// The names that define a measure by themselves.
    fn names(&self) -> Vec<String> {
        Vec::new()
    }

    /// The measure with one of these names, for the whole run.
    fn named(&self, _name: &str) -> Option<Box<dyn Measure>> {
        None
    }
}

/// A measure with its name in a study.
#[derive(Debug)]
pub(crate) struct NamedMeasure {
    /// Its name in tables.
    pub(crate) name: String,
    /// The measure itself.
    pub(crate) measure: Box<dyn Measure>,
    /// The line of the study file, from 1.
    pub(crate) line: usize,
}

/// Measures of existing results, by their names: a number of `talcum analyse`, such as `waves.speed`, or a column of a
/// measure of the case, such as `network.mean_age`.
#[derive(Debug, Default)]
pub(crate) struct OfResults(Analysis);

impl OfResults {
    /// The measure with that name on these results. The times of the reduction apply to both kinds; its statistic
    /// applies to rows.
    ///
    /// # Errors
    /// If the name is not that of a number of any of the results.
    pub(crate) fn named(
        &self,
        name: &str,
        reduction: Reduction,
        results: &[PathBuf],
    ) -> Result<Box<dyn Measure>, String> {
        if let Some(measure) = self.0.over(name, reduction.window) {
            return match measure.texts() {
                Some(_) => Err("is a text: only numbers have means".to_owned()),
                None => Ok(measure),
            };
        }
        let of_case = name.split_once('.').map(|(measure, column)| ResultStatistic {
            measure: measure.to_owned(),
            column: column.to_owned(),
            reduction,
        });
        if let Some(measure) = of_case.filter(|measure| results.iter().any(|it| measure.is_in(it)))
        {
            return Ok(Box::new(measure));
        }
        let names = self.0.names();
        let known: Vec<&str> = names.iter().map(String::as_str).collect();
        let advice = advice(name, &known);
        Err(format!("nothing that talcum analyse measures: {advice}"))
    }
}

/// All sources of measures.
pub(crate) struct Registry(Vec<Box<dyn MeasureSource>>);

impl Default for Registry {
    /// The columns of `series.csv`, the measures of the runs themselves, and those of `talcum analyse`.
    fn default() -> Self {
        Self(vec![Box::new(Series), Box::new(CaseMeasures), Box::new(Analysis::default())])
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

    /// The measure that a name defines by itself.
    ///
    /// # Errors
    /// Suggestions for the name, if no source knows it.
    pub(crate) fn named(&self, name: &str) -> Result<Box<dyn Measure>, String> {
        let found = self.0.iter().find_map(|source| source.named(name));
        found.ok_or_else(|| {
            let names: Vec<String> = self.0.iter().flat_map(|source| source.names()).collect();
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            format!("no such measure: {}", advice(name, &names))
        })
    }
}
