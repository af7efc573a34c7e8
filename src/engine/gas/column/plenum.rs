//! Gas from a plenum below the bed, through a distributor of finite resistance: the superficial velocity follows the
//! bed.
//!
//! The plenum is a closed volume H per cross-section below the plate, with an isothermal ideal gas; P is the absolute
//! pressure above the bed, and p the pressure of the plenum less P. U_0 flows in and U_s flows out, both as volume at P
//! per area and time, so that
//!
//! ```math
//! \frac{H}{P} \frac{dp}{dt} = U_0 - U_s, \qquad p = R_1 U_s + R_2 U_s |U_s| + F(U_s) / S
//! ```
//!
//! with F the gas force on all particles and S the cross-section: F / S is also the pressure of a compressible gas on
//! the plate. Both equations are solved together at the end of each step (implicit Euler), so that no plenum is too
//! stiff for a time step. Limits: U_s = U_0 for H -> 0, and for resistances far above that of the bed if H is large; a
//! constant pressure drop over distributor and bed for H -> infinity.

use crate::numbers::Schedule;

/// The plenum and its distributor.
#[derive(Clone, Debug, PartialEq)]
pub struct Plenum {
    /// U_0, flow into the plenum.
    pub supply: Schedule,
    /// H, volume of the plenum over the cross-section of the bed.
    pub height: f64,
    /// P, absolute pressure above the bed.
    pub pressure: f64,
    /// R_1, pressure drop of the distributor per velocity.
    pub linear_resistance: f64,
    /// R_2, pressure drop of the distributor per squared velocity.
    pub quadratic_resistance: f64,
}

/// The force of the gas on the bed, per cross-section: `at_rest` + `slope` U_s.
#[derive(Clone, Copy, Debug)]
pub(super) struct BedResistance {
    pub(super) at_rest: f64,
    pub(super) slope: f64,
}

impl Plenum {
    /// p at which the outflow is U_s.
    pub(super) fn pressure_for(&self, velocity: f64, bed: BedResistance) -> f64 {
        let through_bed = bed.at_rest + bed.slope * velocity;
        self.linear_resistance * velocity
            + self.quadratic_resistance * velocity * velocity.abs()
            + through_bed
    }

    /// U_s at the end of a step, where p is the pressure at its beginning and U_0 the inflow during it.
    pub(super) fn outflow(&self, p: f64, supply: f64, dt: f64, bed: BedResistance) -> f64 {
        // rising U + R_2 U |U| = excess
        let per_velocity = self.pressure / self.height * dt;
        let rising = bed.slope + self.linear_resistance + per_velocity;
        let excess = p + per_velocity * supply - bed.at_rest;
        let root = (rising * rising + 4.0 * self.quadratic_resistance * excess.abs()).sqrt();
        2.0 * excess / (rising + root)
    }

    /// p at the end of a step with the outflow U_s.
    pub(super) fn pressure_after(&self, p: f64, supply: f64, outflow: f64, dt: f64) -> f64 {
        p + self.pressure / self.height * dt * (supply - outflow)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn outflow_and_pressure_solve_both_equations(
            resistances in (0.0..10.0f64, 0.0..10.0f64),
            (height, supply, p) in (0.01..1.0e3f64, -1.0..1.0f64, -5.0..5.0f64),
            (at_rest, slope) in (-1.0..1.0f64, 0.1..10.0f64),
        ) {
            let (linear_resistance, quadratic_resistance) = resistances;
            let plenum = Plenum {
                supply: Schedule::Constant(supply), height, pressure: 20.0, linear_resistance, quadratic_resistance,
            };
            let bed = BedResistance { at_rest, slope };
            let velocity = plenum.outflow(p, supply, 0.01, bed);
            let after = plenum.pressure_after(p, supply, velocity, 0.01);
            // Numbers up to 200 (P dt / H), a few operations.
            prop_assert!((after - plenum.pressure_for(velocity, bed)).abs() < 1.0e-11);
        }
    }
}
