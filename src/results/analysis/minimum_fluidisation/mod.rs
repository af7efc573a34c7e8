//! Minimum fluidisation velocity: that of a force balance, and that from ramps of the superficial gas velocity, up and down.
//!
//! In the packed bed the pressure drop over the weight follows Ergun's form dp = a U + b U^2 (S. Ergun, Chem. Eng.
//! Prog. 48 (1952) 89-94), with two constants that are free but not negative; in the fluidised bed it is a plateau P.
//! They meet at U_mf = 2 P / (a + sqrt(a^2 + 4 b P)).

mod fit;
mod force_balance;
mod ramps;
#[cfg(test)]
mod tests;

pub use fit::{Fit, fit_branch};
pub use force_balance::{gas_force_at_rest, minimum_fluidisation_velocity, velocity_of_balance};
pub use ramps::{Branch, Direction, Series};

use crate::analysis::no_value::{Estimate, NoValue};

/// Minimum fluidisation of a run, for the ramps up and down.
#[derive(Clone, Debug, PartialEq)]
pub struct MinimumFluidisation {
    /// The ramp of rising velocity, and its results.
    pub up: Result<Ramp, NoValue>,
    /// The ramp of falling velocity, likewise.
    pub down: Result<Ramp, NoValue>,
    /// Differences between the two.
    pub hysteresis: Result<Hysteresis, NoValue>,
}

/// Points of a ramp, which can be plotted even if no value can be given, and their fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Ramp {
    /// One point for each velocity, by ascending velocity.
    pub branch: Branch,
    /// The fit, or the reason why there is none.
    pub fit: Result<Fit, NoValue>,
}

/// Differences between the ramps up and down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hysteresis {
    /// U_mf up less U_mf down. Velocity.
    pub velocity: Estimate,
    /// The largest difference of the pressure drops, up less down, over the weight, at equal velocity below both U_mf.
    pub pressure_drop: f64,
}

/// Splits a series into its ramps and measures each.
///
/// Fails if the series cannot be split: too short, not finite, or of a constant velocity.
pub fn minimum_fluidisation(series: &Series) -> Result<MinimumFluidisation, NoValue> {
    let [up, down] = ramps::split(series)?;
    let ramp = |branch: Result<Branch, NoValue>| {
        branch.map(|branch| Ramp { fit: fit_branch(&branch), branch })
    };
    let (up, down) = (ramp(up), ramp(down));
    let hysteresis = hysteresis(&up, &down);
    Ok(MinimumFluidisation { up, down, hysteresis })
}

/// Ratio of U_mf to that of a force balance at the bulk's solids fraction.
///
/// `balance` gives U_mf for a solids fraction, for example (St / 18) (1 - phi)^4.65 sqrt(g d). The error includes those
/// of U_mf and of phi. Fails if the solids fraction was not given, or the balance is not positive.
pub fn ratio_to_balance(fit: &Fit, balance: impl Fn(f64) -> f64) -> Result<Estimate, NoValue> {
    let Some(phi) = fit.solids_fraction else {
        return Err(NoValue::because("the solids fraction of the bulk is unknown"));
    };
    let expected = balance(phi.value);
    if !(expected > 0.0 && expected.is_finite()) {
        return Err(NoValue::because(format!(
            "the force balance gives {expected} at a solids fraction of {}",
            phi.value
        )));
    }
    let change = 0.5 * (balance(phi.value + phi.error) - balance(phi.value - phi.error)) / expected;
    let value = fit.velocity.value / expected;
    let relative = fit.velocity.error / fit.velocity.value;
    Ok(Estimate { value, error: value * (relative * relative + change * change).sqrt() })
}

fn hysteresis(
    up: &Result<Ramp, NoValue>,
    down: &Result<Ramp, NoValue>,
) -> Result<Hysteresis, NoValue> {
    let (up, down) = (up.as_ref().map_err(Clone::clone)?, down.as_ref().map_err(Clone::clone)?);
    let (fit_up, fit_down) =
        (up.fit.as_ref().map_err(Clone::clone)?, down.fit.as_ref().map_err(Clone::clone)?);
    let (a, b) = (fit_up.velocity, fit_down.velocity);
    let error = (a.error * a.error + b.error * b.error).sqrt();
    let least = a.value.min(b.value);
    let pressure_drop = up
        .branch
        .velocities
        .iter()
        .zip(&up.branch.pressure_drops)
        .filter(|(velocity, _)| **velocity <= least)
        .filter_map(|(&velocity, drop)| Some(drop - down.branch.pressure_drop_at(velocity)?))
        .fold(0.0_f64, |largest, value| if value.abs() > largest.abs() { value } else { largest });
    Ok(Hysteresis { velocity: Estimate { value: a.value - b.value, error }, pressure_drop })
}
