//! Names of units in the headers of tables and the attributes of datasets.

use crate::analysis::Quantity;
use talcum_engine::fields::Unit;

/// The name of the unit of each kind of quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ColumnUnits {
    /// Time.
    pub time: &'static str,
    /// Length.
    pub length: &'static str,
    /// Velocity.
    pub speed: &'static str,
    /// Angle.
    pub angle: &'static str,
    /// Angular velocity.
    pub angular_speed: &'static str,
    /// Force.
    pub force: &'static str,
    /// Torque.
    pub torque: &'static str,
    /// Pressure.
    pub pressure: &'static str,
    /// Mass.
    pub mass: &'static str,
    /// Energy.
    pub energy: &'static str,
    /// Volume.
    pub volume: &'static str,
    /// Mass per area and time.
    pub mass_flux: &'static str,
    /// Area.
    pub area: &'static str,
    /// Squared velocity.
    pub squared_speed: &'static str,
    /// Squared length over time.
    pub diffusivity: &'static str,
    /// Inverse time.
    pub rate: &'static str,
    /// No unit, for pure numbers.
    pub number: &'static str,
}

impl ColumnUnits {
    /// The international system.
    pub const SI: Self = Self {
        time: "s",
        length: "m",
        speed: "m/s",
        angle: "1",
        angular_speed: "1/s",
        force: "N",
        torque: "N m",
        pressure: "Pa",
        mass: "kg",
        energy: "J",
        volume: "m^3",
        mass_flux: "kg/(m^2 s)",
        area: "m^2",
        squared_speed: "m^2/s^2",
        diffusivity: "m^2/s",
        rate: "1/s",
        number: "1",
    };

    /// The system in which particle density, reference diameter and gravity are 1.
    pub const DIMENSIONLESS: Self = Self {
        time: "sqrt(d/g)",
        length: "d",
        speed: "sqrt(g d)",
        angle: "1",
        angular_speed: "sqrt(g/d)",
        force: "rho_s g d^3",
        torque: "rho_s g d^4",
        pressure: "rho_s g d",
        mass: "rho_s d^3",
        energy: "rho_s g d^4",
        volume: "d^3",
        mass_flux: "rho_s sqrt(g d)",
        area: "d^2",
        squared_speed: "g d",
        diffusivity: "d sqrt(g d)",
        rate: "sqrt(g/d)",
        number: "1",
    };

    /// The unit of a quantity.
    pub fn of(&self, quantity: Quantity) -> &'static str {
        match quantity {
            Quantity::Time => self.time,
            Quantity::Length => self.length,
            Quantity::Speed => self.speed,
            Quantity::Energy => self.energy,
            Quantity::Frequency => self.angular_speed,
            Quantity::MassFlux => self.mass_flux,
            Quantity::Mass => self.mass,
            Quantity::Volume => self.volume,
            Quantity::Area => self.area,
            Quantity::Force => self.force,
            Quantity::Pressure => self.pressure,
            Quantity::SquaredSpeed => self.squared_speed,
            Quantity::Diffusivity => self.diffusivity,
            Quantity::Rate => self.rate,
            Quantity::Degrees => "degree",
            Quantity::Number => self.number,
        }
    }

    /// The unit of a field.
    pub fn of_unit(&self, unit: Unit) -> &'static str {
        match unit {
            Unit::One => self.number,
            Unit::Length => self.length,
            Unit::Speed => self.speed,
            Unit::Angle => self.angle,
            Unit::AngularSpeed => self.angular_speed,
            Unit::Mass => self.mass,
            Unit::Force => self.force,
            Unit::Torque => self.torque,
            Unit::Pressure => self.pressure,
            Unit::Volume => self.volume,
            Unit::Named(name) => name,
        }
    }

    /// The units of a system with its name in the case: `"si"`, or otherwise the dimensionless one.
    pub fn of_system(name: &str) -> Self {
        if name == "si" { Self::SI } else { Self::DIMENSIONLESS }
    }
}
