//! The keys of a column of gas.

use super::allowed::{Allowed, rounded};
use super::drag::read_drag;
use super::forces::positive_gravity;
use super::particles::Scales;
use super::section::Section;
use crate::domain::{Bounds, Face};
use crate::gas::{BaseNode, ColumnGas, DragCorrelation, DragLaw, Drive, WeightBalance};
use crate::rules::viscosity_of_stokes_number;
use serde::Deserialize;
use std::ops::Range;

/// More grid nodes than this are a mistake.
const MOST_NODES: f64 = 1.0e6;
/// A periodic grid of fewer nodes would meet itself.
const FEWEST_PERIODIC_NODES: f64 = 3.0;

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Weight {
    ParticleForce,
    GridIntegral,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Base {
    FullCell,
    HalfCell,
}

/// `[gas]` of kind "column".
pub(super) fn read_column(
    section: Section<'_>,
    scales: Scales,
    gravity: Option<f64>,
    bounds: Option<&Bounds>,
    stages: &[Range<f64>],
) -> Option<ColumnGas> {
    if let Some(bounds) = bounds
        && matches!(bounds.faces(2)[0], Face::Open | Face::Stop)
    {
        section.fail("kind", "a column of gas needs a lower wall or a periodic box along z");
    }
    let viscosity = read_viscosity(&section, scales, gravity);
    let drag = read_drag_and_density(&section);
    let spacing = read_spacing(&section, bounds);
    let drive = read_drive(&section, bounds, stages);
    section.note_default("lateral_drag", "false, the gas acts vertically only");
    let lateral_drag = section.optional("lateral_drag").unwrap_or(false);
    section.note_default("base_node", "\"full_cell\", phi is halved in the node on the plate");
    let base_node = match section.optional("base_node") {
        Some(Base::HalfCell) => BaseNode::HalfCell,
        Some(Base::FullCell) | None => BaseNode::FullCell,
    };
    section.finish();
    let (drag, drag_factor, density) = drag?;
    Some(ColumnGas {
        spacing: spacing?,
        drag,
        drag_factor,
        viscosity: viscosity?,
        density,
        drive: drive?,
        lateral_drag,
        base_node,
    })
}

/// mu, or from St = rho_s g^1/2 d^3/2 / mu.
pub(super) fn read_viscosity(
    section: &Section<'_>,
    scales: Scales,
    gravity: Option<f64>,
) -> Option<f64> {
    let key = section.exactly_one(&["viscosity", "stokes_number"])?;
    let number = section.optional_number(key, Allowed::POSITIVE)?;
    if key == "viscosity" {
        return Some(number);
    }
    let gravity = positive_gravity(section, key, "viscosity", gravity)?;
    let diameter = scales.diameter?;
    Some(viscosity_of_stokes_number(number, scales.density?, gravity, diameter))
}

/// The drag law, its factor, and the gas density that it needs or 0.
fn read_drag_and_density(section: &Section<'_>) -> Option<(DragLaw, f64, f64)> {
    let drag = read_drag(section);
    let Some((law, factor)) = drag else {
        section.optional_number("density", Allowed::POSITIVE);
        return None;
    };
    if law.depends_on_reynolds() {
        return section.number("density", Allowed::POSITIVE).map(|density| (law, factor, density));
    }
    if section.has("density") {
        section.fail("density", "cannot be given: drag \"wen_yu_creeping\" has no use for it");
    }
    Some((law, factor, 0.0))
}

/// dz, in a periodic box the divisor of its height nearest to the one asked for.
fn read_spacing(section: &Section<'_>, bounds: Option<&Bounds>) -> Option<f64> {
    let asked = section.number("spacing", Allowed::POSITIVE)?;
    let bounds = bounds?;
    let height = bounds.lengths().z;
    if height / asked > MOST_NODES {
        let least = rounded(height / MOST_NODES);
        section.fail("spacing", format!("must be at least {least}, a millionth of the box height"));
        return None;
    }
    if !bounds.is_periodic(2) {
        return Some(asked);
    }
    if height / asked < FEWEST_PERIODIC_NODES {
        let most = rounded(height / FEWEST_PERIODIC_NODES);
        section.fail("spacing", format!("must be at most {most}, a third of the periodic height"));
        return None;
    }
    let below = height / (height / asked).floor();
    let above = height / (height / asked).ceil();
    let spacing = if (below - asked).abs() <= (above - asked).abs() { below } else { above };
    if spacing != asked {
        let key = section.path_of("spacing");
        section.problems.note(format!("{key} = {asked} becomes {spacing}, a divisor of {height}"));
    }
    Some(spacing)
}

fn read_drive(
    section: &Section<'_>,
    bounds: Option<&Bounds>,
    stages: &[Range<f64>],
) -> Option<Drive> {
    let key = section.exactly_one(&["superficial_velocity", "weight"])?;
    if key == "superficial_velocity" {
        return section.schedule(key, Allowed::FINITE, stages).map(Drive::Velocity);
    }
    if bounds.is_some_and(|bounds| !bounds.is_fully_periodic()) {
        section.fail(key, "needs a box that is periodic along x, y and z");
    }
    section.value(key).map(|weight| match weight {
        Weight::ParticleForce => Drive::Weight(WeightBalance::ParticleForce),
        Weight::GridIntegral => Drive::Weight(WeightBalance::GridIntegral),
    })
}
