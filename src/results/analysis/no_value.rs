//! The reason why a quantity has no value.

use std::fmt;

/// The reason why a quantity has no value for the given data.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NoValue {
    reason: String,
}

impl NoValue {
    /// A reason, which completes the sentence "no value can be given, because ...".
    pub fn because(reason: impl Into<String>) -> Self {
        Self { reason: reason.into() }
    }

    /// The reason alone.
    pub fn reason(&self) -> &str {
        &self.reason
    }
}

impl fmt::Display for NoValue {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "no value can be given, because {}", self.reason)
    }
}

impl std::error::Error for NoValue {}

/// Rejects numbers that are infinite or not a number.
pub(crate) fn require_finite(name: &str, values: &[f64]) -> Result<(), NoValue> {
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(place) => {
            Err(NoValue::because(format!("{name}[{place}] is {}: not a number", values[place])))
        }
    }
}

/// Rejects a number that is not positive and finite.
pub(crate) fn require_positive(name: &str, value: f64) -> Result<(), NoValue> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(NoValue::because(format!("{name} is {value}; it must be positive")))
    }
}

/// A quantity with its standard error, in the same unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
}
