//! Adhesion of particles: the force and the work that separate them, and the contribution of softened springs to the
//! work.

use super::gas::highest_velocity;
use super::lines::Lines;
use super::partners::Partners;
use talcum_engine::contact::{Softening, pull_off_force, work_of_parting};
use talcum_engine::fields::Unit;
use talcum_engine::rules::{LARGEST_SPRING_PART, WorkOfParting};
use talcum_results::output::ColumnUnits;
use talcum_runs::case::{Case, Stage};

/// The work that separates two particles of the reference diameter, and a particle and each wall, in a stage; the
/// strongest attraction counts.
pub(super) fn describe_adhesion(lines: &mut Lines, case: &Case, stage: &Stage) {
    let gravity = stage.physics.gravity.magnitude;
    for partners in Partners::of_stage(case, stage) {
        let weight = case.particles.reference_mass(0) * gravity;
        let work = describe(lines, &partners, case, weight);
        if let Some(work) = work.filter(|_| partners.wall.is_none()) {
            let velocity = highest_velocity(&stage.physics.gas);
            describe_impacts(lines, work.total(), &partners, velocity, case);
        }
    }
}

/// Impacts: adhesion number 2 W / (m* U^2), with the work of separation W and the velocity U of the gas, and the speed
/// at which it is 1. In faster impacts the bodies separate again, unless other mechanisms take their energy.
fn describe_impacts(
    lines: &mut Lines,
    work: f64,
    partners: &Partners<'_>,
    velocity: Option<f64>,
    case: &Case,
) {
    let unit = ColumnUnits::of_system(case.units.name()).of(Unit::Speed);
    let reduced_mass = partners.bodies.mass;
    let mut text = format!("below {:.4e} {unit}", (2.0 * work / reduced_mass).sqrt());
    if let Some(velocity) = velocity.filter(|&velocity| velocity > 0.0) {
        let number = 2.0 * work / (reduced_mass * velocity * velocity);
        text += &format!("; adhesion number of impacts at U {number:.4e}");
    }
    lines.add(&format!("impacts{} stick", partners.name), &text);
}

/// Describes force and work of separation, and returns the latter; nothing if the two do not adhere.
fn describe(
    lines: &mut Lines,
    partners: &Partners<'_>,
    case: &Case,
    weight: f64,
) -> Option<WorkOfParting> {
    let Partners { name, contact, bodies, .. } = partners;
    let attraction = partners.attraction();
    let softened = work_of_parting(&contact.law, *bodies, attraction);
    if softened.total() <= 0.0 {
        return None;
    }
    let units = ColumnUnits::of_system(case.units.name());
    if weight > 0.0 {
        let force = pull_off_force(&contact.law, *bodies, attraction);
        let text = format!(
            "{force:.4e} {}, {:.4} of the weight of a particle",
            units.of(Unit::Force),
            force / weight
        );
        lines.add(&format!("pull-off force{name}"), &text);
    }
    let real = work_of_real_particles(partners, &softened);
    let mut text =
        format!("{:.4e} {}, {}", softened.total(), units.of(Unit::Energy), spring_part(&softened));
    if let (Some(real), Some(softening)) = (&real, contact.softening) {
        text += &if real.surface > 0.0 {
            format!("; at the real stiffness {:.3}", real.spring_part())
        } else {
            format!("; {:.3} of that at the real stiffness", 1.0 + softened.excess_over(real))
        };
        text += &format!(", {} times as stiff", softening.reduction);
    }
    lines.add(&format!("work of separation{name}"), &text);
    let excess = match &real {
        Some(real) => softened.excess_over(real),
        None if softened.surface > 0.0 => softened.spring_part(),
        None => 0.0, // nothing to compare with
    };
    if excess > LARGEST_SPRING_PART {
        let of = if real.is_some() { "the real particles" } else { "stiff particles" };
        lines.warn(&format!(
            "the soft spring adds {excess:.3} times the work of separation of {of} to it (advised: at most \
             {LARGEST_SPRING_PART}): raise the stiffness, or see contact.softening"
        ));
    }
    Some(softened)
}

fn spring_part(work: &WorkOfParting) -> String {
    if work.surface > 0.0 {
        format!("the spring's part {:.3} of the surface's", work.spring_part())
    } else {
        "all of it while in contact: it depends on the stiffness".to_owned()
    }
}

/// The work of separation of real particles; `None` if their stiffness is not given or the law does not give this work.
fn work_of_real_particles(
    partners: &Partners<'_>,
    softened: &WorkOfParting,
) -> Option<WorkOfParting> {
    let Softening { reduction, keeps_work } = partners.contact.softening?;
    if keeps_work {
        // Adhesion was scaled for this purpose.
        return Some(*softened);
    }
    let real = partners.contact.law.stiffened(reduction)?;
    Some(work_of_parting(&real, partners.bodies, partners.attraction()))
}
