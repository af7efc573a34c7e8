//! Names of units in the headers of tables and at every dataset.

use crate::analysis::Quantity;

/// The name of the unit of each kind of quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ColumnUnits {
    /// Of time.
    pub time: &'static str,
    /// Of length.
    pub length: &'static str,
    /// Of velocity.
    pub speed: &'static str,
    /// Of angle.
    pub angle: &'static str,
    /// Of angular velocity.
    pub angular_speed: &'static str,
    /// Of force.
    pub force: &'static str,
    /// Of torque.
    pub torque: &'static str,
    /// Of pressure.
    pub pressure: &'static str,
    /// Of mass.
    pub mass: &'static str,
    /// Of energy.
    pub energy: &'static str,
    /// Of volume.
    pub volume: &'static str,
    /// Of dispersion, length squared per time.
    pub dispersion: &'static str,
    /// Of mass per area and time.
    pub mass_flux: &'static str,
    /// Of what has none.
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
        dispersion: "m^2/s",
        mass_flux: "kg/(m^2 s)",
        number: "1",
    };

    /// Particle density, reference diameter and gravity are 1.
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
        dispersion: "sqrt(g d^3)",
        mass_flux: "rho_s sqrt(g d)",
        number: "1",
    };

    /// The unit of a quantity.
    pub fn of(&self, quantity: Quantity) -> &'static str {
        match quantity {
            Quantity::Time => self.time,
            Quantity::Length => self.length,
            Quantity::Speed => self.speed,
            Quantity::Energy => self.energy,
            Quantity::Pressure => self.pressure,
            Quantity::Frequency => self.angular_speed,
            Quantity::Dispersion => self.dispersion,
            Quantity::MassFlux => self.mass_flux,
            Quantity::Number => self.number,
        }
    }

    /// The units of a system as the case names it: `"si"`, or otherwise the dimensionless one.
    pub fn of_system(name: &str) -> Self {
        if name == "si" { Self::SI } else { Self::DIMENSIONLESS }
    }
}
