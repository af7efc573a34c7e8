//! The error of a parameter that has no physical meaning, for all contact laws.

use thiserror::Error;

/// A parameter of a contact law has no physical meaning.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{parameter} is {value}, it must be {allowed}")]
pub struct InvalidContactLaw {
    /// Name of the parameter, as in the case file.
    pub parameter: &'static str,
    /// Its value.
    pub value: f64,
    /// The allowed range.
    pub allowed: &'static str,
}

/// Returns an error unless a parameter has a meaning.
pub(super) fn require(
    is_valid: bool,
    parameter: &'static str,
    value: f64,
    allowed: &'static str,
) -> Result<(), InvalidContactLaw> {
    if is_valid { Ok(()) } else { Err(InvalidContactLaw { parameter, value, allowed }) }
}
