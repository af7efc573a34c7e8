//! The sections of what acts on particles at any distance: cohesion, gravity and vibration.

use super::allowed::Allowed;
use super::particles::{Scales, sphere_mass};
use super::section::Section;
use super::units::Units;
use crate::contact::{CohesionExpression, VanDerWaals};
use crate::domain::Vibration;
use crate::numbers::Schedule;
use crate::rules::{ContactPartner, hamaker_constant_per_bond_number};
use serde::Deserialize;
use std::f64::consts::PI;
use std::ops::Range;

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Expression {
    NearContact,
    Full,
}

/// `[cohesion]`; Bond numbers are those of the reference diameter.
pub(super) fn read_cohesion(
    section: Section<'_>,
    scales: Scales,
    gravity: Option<f64>,
    stages: &[Range<f64>],
) -> Option<VanDerWaals> {
    let cut_off = section.number("cut_off", Allowed::POSITIVE);
    let range = section.number("range", Allowed::POSITIVE);
    if let (Some(cut_off), Some(range)) = (cut_off, range)
        && range < cut_off
    {
        section.fail("range", format!("must be at least cut_off, {cut_off}"));
    }
    let constant = |keys: [&'static str; 2], partner: ContactPartner| {
        let key = section.exactly_one(&keys)?;
        let schedule = section.schedule(key, Allowed::NOT_NEGATIVE, stages);
        if key == keys[1] {
            return schedule;
        }
        let gravity = positive_gravity(&section, key, keys[1], gravity)?;
        let (density, diameter) = (scales.density?, scales.diameter?);
        let weight = sphere_mass(density, diameter) * gravity;
        let unit = hamaker_constant_per_bond_number(partner, cut_off?, diameter, weight);
        Some(schedule?.scaled(unit))
    };
    let particles: Option<Schedule> =
        constant(["bond_number", "hamaker_constant"], ContactPartner::Particle);
    let walls: Option<Schedule> =
        constant(["wall_bond_number", "wall_hamaker_constant"], ContactPartner::Wall);
    let expression = section.value("expression").map(|expression| match expression {
        Expression::NearContact => CohesionExpression::NearContact,
        Expression::Full => CohesionExpression::Full,
    });
    section.finish();
    Some(VanDerWaals {
        hamaker_constant: particles?,
        wall_hamaker_constant: walls?,
        cut_off: cut_off?,
        range: range?,
        expression: expression?,
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
pub(super) fn read_gravity(section: Section<'_>, units: Option<Units>) -> Option<f64> {
    let magnitude = section.number("magnitude", Allowed::NOT_NEGATIVE);
    let scale = units == Some(Units::Dimensionless);
    let is_wrong = scale && magnitude.is_some_and(|magnitude| magnitude != 0.0 && magnitude != 1.0);
    if is_wrong {
        section.fail(
            "magnitude",
            "must be 1 in dimensionless units, it is their scale; or 0, switched off",
        );
    }
    section.finish();
    magnitude.filter(|_| !is_wrong)
}

/// `[vibration]`; its phase is 0 at the begin of the stage that sets the frequency.
pub(super) fn read_vibration(
    section: Section<'_>,
    gravity: Option<f64>,
    stages: &[Range<f64>],
) -> Option<Vibration> {
    let frequency = section.number("frequency", Allowed::POSITIVE);
    let start = section.get("frequency").map(|node| stages[node.stage].start);
    let key = section.exactly_one(&["gamma", "amplitude"]);
    let strength = key.and_then(|key| section.optional_number(key, Allowed::NOT_NEGATIVE));
    let gravity = key.and_then(|key| positive_gravity(&section, key, "it a magnitude", gravity));
    section.finish();
    let (frequency, strength) = (frequency?, strength?);
    let relative_acceleration = match key? {
        "amplitude" => strength * (2.0 * PI * frequency).powi(2) / gravity?,
        _ => gravity.map(|_| strength)?,
    };
    Some(Vibration { relative_acceleration, frequency, start: start? })
}
