//! The error of a parameter without physical meaning, for all contact laws.

use crate::schema::{Key, Kind};
use thiserror::Error;

/// A parameter of a contact law without physical meaning.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{parameter} is {value}, it must be {allowed}")]
pub struct InvalidContactLaw {
    /// Name of the parameter, as in the case file.
    pub parameter: &'static str,
    /// Its value.
    pub value: f64,
    /// The allowed range.
    pub allowed: String,
}

/// Returns an error unless a parameter has a physical meaning.
pub(super) fn require(
    is_valid: bool,
    parameter: &'static str,
    value: f64,
    allowed: &'static str,
) -> Result<(), InvalidContactLaw> {
    if is_valid {
        return Ok(());
    }
    Err(InvalidContactLaw { parameter, value, allowed: allowed.to_owned() })
}

/// Returns an error unless a parameter is in the range of its key.
pub(super) fn require_in_range(key: &Key, value: f64) -> Result<(), InvalidContactLaw> {
    match key.kind {
        Kind::Number(allowed) if !allowed.contains(value) => {
            Err(InvalidContactLaw { parameter: key.name, value, allowed: allowed.to_string() })
        }
        _ => Ok(()),
    }
}
