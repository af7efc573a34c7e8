//! The sections on forces that act on particles at any distance: cohesion, gravity and vibration.

use super::context::ReadContext;
use super::schedules::{read_schedule, start_of};
use super::units::Units;
use crate::input::Section;
use std::f64::consts::PI;
use talcum_engine::contact::{CohesionExpression, ContactModel, VanDerWaals};
use talcum_engine::domain::Vibration;
use talcum_engine::numbers::Schedule;
use talcum_engine::rules::{
    ContactPartner, attraction_of_bond_number, hamaker_constant_per_bond_number,
};

/// Reads `[cohesion]`; Bond numbers refer to the reference diameter.
pub(super) fn read_cohesion(
    section: &Section<'_>,
    context: ReadContext<'_>,
) -> Option<VanDerWaals> {
    match section.word("expression")? {
        "square" => read_square(section, context),
        _ => read_van_der_waals(section, context),
    }
}

/// Reads `[cohesion]` with Hamaker constants.
fn read_van_der_waals(section: &Section<'_>, context: ReadContext<'_>) -> Option<VanDerWaals> {
    let (cut_off, range) = (section.number("cut_off"), section.number("range"));
    if let (Some(cut_off), Some(range)) = (cut_off, range)
        && range < cut_off
    {
        section.fail("range", format!("must be at least cut_off, {cut_off}"));
    }
    let expression = match section.word("expression") {
        Some("full") => CohesionExpression::Full,
        Some("rough") => {
            CohesionExpression::Rough { asperity_radius: section.number("asperity_radius")? }
        }
        _ => CohesionExpression::NearContact,
    };
    let constant = |[bond_number, constant]: [&'static str; 2], partner: ContactPartner| {
        let key = section.given(&[bond_number, constant])?;
        let schedule = read_schedule(section, key, context.times);
        if key == constant {
            return schedule;
        }
        let gravity = positive_gravity(section, key, constant, context.gravity)?;
        let (weight, diameter) = (context.scales.mass()? * gravity, context.scales.diameter?);
        let unit = hamaker_constant_per_bond_number(partner, cut_off?, diameter, weight);
        // The Bond number is that of the rough particles.
        let roughness = expression.roughness_factor(0.5 * diameter, cut_off?);
        Some(schedule?.scaled(unit / roughness))
    };
    let particles = constant(["bond_number", "hamaker_constant"], ContactPartner::Particle);
    let walls = constant(["wall_bond_number", "wall_hamaker_constant"], ContactPartner::Wall);
    Some(VanDerWaals {
        hamaker_constant: particles?,
        wall_hamaker_constant: walls?,
        cut_off: cut_off?,
        range: range?,
        expression,
    })
}

/// The square force of `[cohesion]`: its magnitude, or Bond number, and its range.
fn read_square(section: &Section<'_>, context: ReadContext<'_>) -> Option<VanDerWaals> {
    let magnitude = |[bond_number, force]: [&'static str; 2]| -> Option<Schedule> {
        let key = section.given(&[bond_number, force])?;
        let schedule = read_schedule(section, key, context.times);
        if key == force {
            return schedule;
        }
        let gravity = positive_gravity(section, key, force, context.gravity)?;
        Some(schedule?.scaled(attraction_of_bond_number(1.0, context.scales.mass()?, gravity)))
    };
    let [particles, walls] =
        [["bond_number", "force"], ["wall_bond_number", "wall_force"]].map(magnitude);
    let radius = 0.5 * context.scales.diameter?;
    Some(VanDerWaals::square(&particles?, &walls?, radius, section.number("range")?))
}

/// The attraction in a run of softened particles.
pub(super) fn softened(
    cohesion: VanDerWaals,
    contact: &ContactModel,
    section: &Section<'_>,
    context: ReadContext<'_>,
) -> Option<VanDerWaals> {
    let factor = contact
        .softening
        .map_or(1.0, |softening| softening.adhesion_factor(contact.law.overlap_exponent()));
    if factor == 1.0 {
        return Some(cohesion);
    }
    let softened = cohesion.keeping_work(factor, 0.5 * context.scales.diameter?);
    if softened.is_none() {
        let message = format!(
            "is too short for contact.softening = \"keeps_work\": with {factor:.3e} of the force no cut-off \
             below it gives the work of separation of the real particles"
        );
        section.fail("range", message);
    }
    softened
}

/// g; an error if it is 0 and a dimensionless number needs it.
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

/// Reads `[gravity]`: its magnitude.
pub(super) fn read_gravity(section: &Section<'_>, units: Option<Units>) -> Option<f64> {
    let magnitude = section.number("magnitude")?;
    if units == Some(Units::Dimensionless) && magnitude != 0.0 && magnitude != 1.0 {
        let message = "must be 1 in dimensionless units, it is their scale; or 0, switched off";
        section.fail("magnitude", message);
        return None;
    }
    Some(magnitude)
}

/// Reads `[vibration]`; its phase is 0 at the start of the stage that sets the frequency.
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
