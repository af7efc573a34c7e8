//! Systems of units, and words for them.

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

/// What a number measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names say it")]
pub enum Quantity {
    Number,
    Time,
    Length,
    Volume,
    Mass,
    Density,
    Speed,
    AngularSpeed,
    Acceleration,
    Frequency,
    Force,
    Stiffness,
    Energy,
    Stress,
    Viscosity,
}

impl Units {
    /// The unit of a quantity, for headers of tables.
    ///
    /// ```
    /// use talcum::case::{Quantity, Units};
    /// assert_eq!(Units::Si.unit(Quantity::Speed), "m/s");
    /// assert_eq!(Units::Dimensionless.unit(Quantity::Time), "sqrt(d/g)");
    /// ```
    pub fn unit(self, quantity: Quantity) -> &'static str {
        let (si, dimensionless) = match quantity {
            Quantity::Number => ("1", "1"),
            Quantity::Time => ("s", "sqrt(d/g)"),
            Quantity::Length => ("m", "d"),
            Quantity::Volume => ("m^3", "d^3"),
            Quantity::Mass => ("kg", "rho_s d^3"),
            Quantity::Density => ("kg/m^3", "rho_s"),
            Quantity::Speed => ("m/s", "sqrt(g d)"),
            Quantity::AngularSpeed => ("rad/s", "sqrt(g/d)"),
            Quantity::Acceleration => ("m/s^2", "g"),
            Quantity::Frequency => ("Hz", "sqrt(g/d)"),
            Quantity::Force => ("N", "rho_s g d^3"),
            Quantity::Stiffness => ("N/m", "rho_s g d^2"),
            Quantity::Energy => ("J", "rho_s g d^4"),
            Quantity::Stress => ("Pa", "rho_s g d"),
            Quantity::Viscosity => ("Pa s", "rho_s sqrt(g d^3)"),
        };
        match self {
            Self::Si => si,
            Self::Dimensionless => dimensionless,
        }
    }

    /// The word that the case file uses.
    pub fn name(self) -> &'static str {
        match self {
            Self::Si => "si",
            Self::Dimensionless => "dimensionless",
        }
    }
}
