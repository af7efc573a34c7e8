//! Findings of an analysis: named numbers and texts, tables, and notes.

use super::ScalarName;
use talcum_engine::fields::Unit;
use talcum_results::analysis::{Estimate, NoValue};
use talcum_results::output::{ColumnUnits, OutputError, ResultTable};

/// A kind of number or text that an analysis may give.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    /// Its name after that of the analysis.
    pub name: &'static str,
    /// Its unit; it is ignored for a text.
    pub unit: Unit,
    /// Its meaning.
    pub meaning: &'static str,
    /// The possible texts; `None` for a number.
    pub texts: Option<&'static [&'static str]>,
}

impl Kind {
    /// A number.
    pub const fn number(name: &'static str, unit: Unit, meaning: &'static str) -> Self {
        Self { name, unit, meaning, texts: None }
    }

    /// One of a few texts.
    pub const fn text(
        name: &'static str,
        texts: &'static [&'static str],
        meaning: &'static str,
    ) -> Self {
        Self { name, unit: Unit::One, meaning, texts: Some(texts) }
    }
}

/// The finding for a number or text.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number.
    Number {
        /// Its value.
        value: f64,
        /// Its standard error, if it can be estimated.
        error: Option<f64>,
    },
    /// A text.
    Text(&'static str),
    /// No value, for this reason.
    Nothing(NoValue),
}

impl From<f64> for Value {
    fn from(value: f64) -> Self {
        Self::Number { value, error: None }
    }
}

impl From<Estimate> for Value {
    fn from(Estimate { value, error }: Estimate) -> Self {
        // Errors are infinite if there are too few data for an estimate.
        Self::Number { value, error: Some(error).filter(|error| error.is_finite()) }
    }
}

impl<T: Into<Self>> From<Result<T, NoValue>> for Value {
    fn from(result: Result<T, NoValue>) -> Self {
        result.map_or_else(Self::Nothing, T::into)
    }
}

/// A number or text with its kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Scalar {
    /// Its kind.
    pub kind: Kind,
    /// Its value.
    pub value: Value,
    /// Its unit.
    pub unit: &'static str,
}

/// All findings of an analysis.
#[derive(Clone, Debug, PartialEq)]
pub struct Findings {
    units: ColumnUnits,
    /// Named numbers and texts, in the order in which they are printed.
    pub scalars: Vec<Scalar>,
    /// Tables.
    pub tables: Vec<ResultTable>,
    /// Notes for the reader on their use, one sentence each.
    pub notes: Vec<String>,
}

impl Findings {
    /// Empty findings.
    pub fn new(units: ColumnUnits) -> Self {
        Self { units, scalars: Vec::new(), tables: Vec::new(), notes: Vec::new() }
    }

    /// Findings without any value, for one reason.
    pub(super) fn nothing(kinds: Vec<Kind>, units: ColumnUnits, reason: &NoValue) -> Self {
        let mut found = Self::new(units);
        for kind in kinds {
            found.add(&kind, Value::Nothing(reason.clone()));
        }
        found
    }

    /// Adds a number or text.
    pub fn add(&mut self, kind: &Kind, value: impl Into<Value>) {
        let unit = if kind.texts.is_some() { "1" } else { self.units.of(kind.unit) };
        self.scalars.push(Scalar { kind: *kind, value: value.into(), unit });
    }

    /// Adds a sentence.
    pub fn note(&mut self, sentence: impl Into<String>) {
        self.notes.push(sentence.into());
    }

    /// The one reason why nothing was found, if there is no value.
    pub fn why_nothing(&self) -> Option<&NoValue> {
        let mut reasons = self.scalars.iter().map(|scalar| match &scalar.value {
            Value::Nothing(reason) => Some(reason),
            Value::Number { .. } | Value::Text(_) => None,
        });
        let first = reasons.next()??;
        (self.tables.is_empty() && reasons.all(|reason| reason == Some(first))).then_some(first)
    }

    /// The finding for a number or text, and its unit.
    pub fn value_of(&self, name: &ScalarName) -> (Value, &'static str) {
        let found = self.scalars.iter().find(|scalar| scalar.kind.name == name.kind.name);
        let absent = || Value::Nothing(NoValue::because("this run has nothing of the kind"));
        found.map_or_else(|| (absent(), "1"), |scalar| (scalar.value.clone(), scalar.unit))
    }
}

/// Reason why an analysis found nothing.
#[derive(Clone, Debug, PartialEq)]
pub enum Unmeasured {
    /// The results do not allow it.
    Nothing(NoValue),
    /// An existing file cannot be read.
    Unreadable(OutputError),
}

impl From<NoValue> for Unmeasured {
    fn from(reason: NoValue) -> Self {
        Self::Nothing(reason)
    }
}

impl From<OutputError> for Unmeasured {
    fn from(error: OutputError) -> Self {
        Self::Unreadable(error)
    }
}
