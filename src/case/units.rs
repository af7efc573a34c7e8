//! Systems of units that a case may be in.

use serde::Deserialize;

/// The coherent system of units that all numbers of a case are in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Units {
    /// Metre, kilogram, second.
    Si,
    /// Solid density rho_s, reference diameter d and gravity g are 1.
    Dimensionless,
}

impl Units {
    /// The word that the case file uses.
    pub fn name(self) -> &'static str {
        match self {
            Self::Si => "si",
            Self::Dimensionless => "dimensionless",
        }
    }
}
