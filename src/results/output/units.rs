//! Names of units in the headers of tables and the attributes of datasets.

use talcum_engine::fields::Unit;

/// The system of units of a case, which gives each unit its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnUnits {
    /// The international system.
    Si,
    /// The system in which particle density, reference diameter and gravity are 1.
    Dimensionless,
}

impl ColumnUnits {
    /// The units of a system with its name in the case: `"si"`, or otherwise the dimensionless one.
    pub fn of_system(name: &str) -> Self {
        if name == "si" { Self::Si } else { Self::Dimensionless }
    }

    /// The name of a unit.
    pub const fn of(self, unit: Unit) -> &'static str {
        let [si, dimensionless] = match unit {
            Unit::One | Unit::Angle => ["1"; 2],
            Unit::Time => ["s", "sqrt(d/g)"],
            Unit::Length => ["m", "d"],
            Unit::Speed => ["m/s", "sqrt(g d)"],
            Unit::AngularSpeed | Unit::Frequency | Unit::Rate => ["1/s", "sqrt(g/d)"],
            Unit::Degrees => ["degree"; 2],
            Unit::Area => ["m^2", "d^2"],
            Unit::Volume => ["m^3", "d^3"],
            Unit::SquaredSpeed => ["m^2/s^2", "g d"],
            Unit::Diffusivity => ["m^2/s", "d sqrt(g d)"],
            Unit::Mass => ["kg", "rho_s d^3"],
            Unit::MassFlux => ["kg/(m^2 s)", "rho_s sqrt(g d)"],
            Unit::Force => ["N", "rho_s g d^3"],
            Unit::Torque => ["N m", "rho_s g d^4"],
            Unit::Pressure => ["Pa", "rho_s g d"],
            Unit::Energy => ["J", "rho_s g d^4"],
            Unit::Named(name) => [name; 2],
        };
        match self {
            Self::Si => si,
            Self::Dimensionless => dimensionless,
        }
    }
}
