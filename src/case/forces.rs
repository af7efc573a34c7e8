//! The sections of what acts on particles: contact, cohesion, gravity and vibration.

use super::allowed::Allowed;
use super::particles::{Scales, sphere_mass};
use super::section::Section;
use super::units::Units;
use crate::contact::{
    CohesionExpression, ContactModel, FrictionCap, Interface, LinearSpringDashpot, VanDerWaals,
};
use crate::domain::Vibration;
use crate::numbers::Schedule;
use serde::Deserialize;
use std::f64::consts::PI;
use std::ops::Range;

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Law {
    LinearSpringDashpot,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Cap {
    Contact,
    Net,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Expression {
    NearContact,
    Full,
}

/// `[contact]`.
pub(super) fn read_contact(section: Section<'_>, cohesive: bool) -> Option<Interface> {
    let law: Option<Law> = section.value("law");
    let normal = section.number("normal_stiffness", Allowed::POSITIVE);
    let tangential = match section.exactly_one(&["tangential_stiffness", "poisson_ratio"]) {
        Some("poisson_ratio") => section
            .optional_number("poisson_ratio", Allowed::between(0.0, 0.5))
            .zip(normal)
            .map(|(ratio, normal)| LinearSpringDashpot::tangential_stiffness_of(normal, ratio)),
        Some(key) => section.optional_number(key, Allowed::NOT_NEGATIVE),
        None => None,
    };
    let restitution = section.number("restitution", Allowed::FRACTION);
    let friction = section.number("friction", Allowed::NOT_NEGATIVE);
    let cap = match section.has("friction_cap") || cohesive {
        true => section.value("friction_cap"),
        false => {
            section
                .note_default("friction_cap", "\"contact\", without cohesion the same as \"net\"");
            Some(Cap::Contact)
        }
    };
    let cap = cap.map(|cap| match cap {
        Cap::Contact => FrictionCap::Contact,
        Cap::Net => FrictionCap::Net,
    });
    section.finish();
    match law? {
        Law::LinearSpringDashpot => {
            LinearSpringDashpot::new(normal?, tangential?, restitution?, friction?, cap?)
                .map_err(|error| section.fail(error.parameter, error.to_string()))
                .map(|law| Interface { law: ContactModel::LinearSpringDashpot(law), rolling: None })
                .ok()
        }
    }
}

/// `[cohesion]`. Bond number Bo = F_c,max / (m g) at the reference diameter: A = 12 delta^2 Bo m g / r for
/// two particles, A_w = 6 delta^2 Bo_w m g / r for a particle and a wall.
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
    let constant = |keys: [&'static str; 2], factor: f64| {
        let key = section.exactly_one(&keys)?;
        let schedule = section.schedule(key, Allowed::NOT_NEGATIVE, stages);
        if key == keys[1] {
            return schedule;
        }
        let gravity = positive_gravity(&section, key, keys[1], gravity)?;
        let (density, diameter) = (scales.density?, scales.diameter?);
        let weight_over_radius = sphere_mass(density, diameter) * gravity / (0.5 * diameter);
        Some(schedule?.scaled(factor * cut_off? * cut_off? * weight_over_radius))
    };
    let particles: Option<Schedule> = constant(["bond_number", "hamaker_constant"], 12.0);
    let walls: Option<Schedule> = constant(["wall_bond_number", "wall_hamaker_constant"], 6.0);
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
