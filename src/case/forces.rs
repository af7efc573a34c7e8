//! The sections of what acts on particles at any distance: cohesion, gravity and vibration.

use super::context::ReadContext;
use super::schedules::{read_schedule, start_of};
use super::section::Section;
use super::units::Units;
use crate::contact::{CohesionExpression, VanDerWaals};
use crate::domain::Vibration;
use crate::rules::{ContactPartner, hamaker_constant_per_bond_number};
use std::f64::consts::PI;

/// `[cohesion]`; Bond numbers are those of the reference diameter.
pub(super) fn read_cohesion(
    section: &Section<'_>,
    context: ReadContext<'_>,
) -> Option<VanDerWaals> {
    let (cut_off, range) = (section.number("cut_off"), section.number("range"));
    if let (Some(cut_off), Some(range)) = (cut_off, range)
        && range < cut_off
    {
        section.fail("range", format!("must be at least cut_off, {cut_off}"));
    }
    let constant = |[bond_number, constant]: [&'static str; 2], partner: ContactPartner| {
        let key = section.given(&[bond_number, constant])?;
        let schedule = read_schedule(section, key, context.times);
        if key == constant {
            return schedule;
        }
        let gravity = positive_gravity(section, key, constant, context.gravity)?;
        let (weight, diameter) = (context.scales.mass()? * gravity, context.scales.diameter?);
        let unit = hamaker_constant_per_bond_number(partner, cut_off?, diameter, weight);
        Some(schedule?.scaled(unit))
    };
    let particles = constant(["bond_number", "hamaker_constant"], ContactPartner::Particle);
    let walls = constant(["wall_bond_number", "wall_hamaker_constant"], ContactPartner::Wall);
    let expressions =
        [("near_contact", CohesionExpression::NearContact), ("full", CohesionExpression::Full)];
    Some(VanDerWaals {
        hamaker_constant: particles?,
        wall_hamaker_constant: walls?,
        cut_off: cut_off?,
        range: range?,
        expression: section.choice("expression", &expressions)?,
    })
}

/// g, unless it is 0 and a dimensionless number needs it.
pub(super) fn positive_gravity(
    section: &Section<'_>,
    key: &'static str,
    instead: &str,
    gravity: Option<f64>,
) -> Option<f64> {
    let gravity = gravity?;
    if gravity == 0.0 {
        section.fail(key, format!("has no meaning while gravity.magnitude is 0: give {instead}"));
        return None;
    }
    Some(gravity)
}

/// `[gravity]`: its magnitude.
pub(super) fn read_gravity(section: &Section<'_>, units: Option<Units>) -> Option<f64> {
    let magnitude = section.number("magnitude")?;
    if units == Some(Units::Dimensionless) && magnitude != 0.0 && magnitude != 1.0 {
        let message = "must be 1 in dimensionless units, it is their scale; or 0, switched off";
        section.fail("magnitude", message);
        return None;
    }
    Some(magnitude)
}

/// `[vibration]`; its phase is 0 at the start of the stage that sets the frequency.
pub(super) fn read_vibration(section: &Section<'_>, context: ReadContext<'_>) -> Option<Vibration> {
    let key = section.given(&["gamma", "amplitude"])?;
    let gravity = positive_gravity(section, key, "it a magnitude", context.gravity)?;
    let (frequency, strength) = (section.number("frequency")?, section.number(key)?);
    let relative_acceleration = match key {
        "amplitude" => strength * (2.0 * PI * frequency).powi(2) / gravity,
        _ => strength,
    };
    let start = start_of(section.node, "frequency", context.times)?;
    Some(Vibration { relative_acceleration, frequency, start })
}
