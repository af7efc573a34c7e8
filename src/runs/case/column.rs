//! The column gas, from its keys.

use super::context::ReadContext;
use super::drag::{read_drag, read_drag_share};
use super::schedules::read_schedule;
use crate::input::{Section, rounded};
use talcum_engine::domain::{Bounds, Face};
use talcum_engine::gas::{BaseNode, ColumnGas, DragCorrelation, Drive, Plenum, WeightBalance};
use talcum_engine::numbers::Schedule;

/// Largest number of grid nodes: a larger one is a mistake.
const MOST_NODES: f64 = 1.0e6;
/// Smallest number of nodes of a periodic grid: with fewer it would meet itself.
const FEWEST_PERIODIC_NODES: f64 = 3.0;

/// `[gas]` of kind "column".
pub(super) fn read_column(
    section: &Section<'_>,
    viscosity: Option<f64>,
    context: ReadContext<'_>,
) -> Option<ColumnGas> {
    let bounds = context.domain.map(|domain| &domain.bounds);
    if let Some(bounds) = bounds
        && matches!(bounds.faces(2)[0], Face::Open | Face::Stop)
    {
        section.fail("kind", "a column gas needs a lower wall or a periodic box along z");
    }
    let drag = read_drag(section);
    let spacing = read_spacing(section, bounds);
    let drive = read_drive(section, context, bounds);
    let ambient_pressure = match section.table("compressible") {
        Some(table) => Some(read_compressible(&table, drive.as_ref(), bounds)?),
        None => None,
    };
    let nodes = [("full_cell", BaseNode::FullCell), ("half_cell", BaseNode::HalfCell)];
    let drag = drag?;
    let density = if drag.depends_on_reynolds() { section.number("density")? } else { 0.0 };
    Some(ColumnGas {
        spacing: spacing?,
        drag,
        drag_factor: section.number("drag_factor")?,
        drag_share: read_drag_share(section)?,
        viscosity: viscosity?,
        density,
        parcel_size: 1.0,
        drive: drive?,
        lateral_drag: section.boolean("lateral_drag")?,
        base_node: section.choice("base_node", &nodes)?,
        ambient_pressure,
    })
}

/// dz; in a periodic box the divisor of its height nearest to the requested value.
fn read_spacing(section: &Section<'_>, bounds: Option<&Bounds>) -> Option<f64> {
    let asked = section.number("spacing")?;
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
    context: ReadContext<'_>,
    bounds: Option<&Bounds>,
) -> Option<Drive> {
    let key = section.given(&["superficial_velocity", "weight"])?;
    if key == "superficial_velocity" {
        let flow = read_schedule(section, key, context.times)?;
        return match section.table("plenum") {
            Some(table) => read_plenum(&table, flow, bounds).map(Drive::Plenum),
            None => Some(Drive::Velocity(flow)),
        };
    }
    if bounds.is_some_and(|bounds| !bounds.is_fully_periodic()) {
        section.fail(key, "needs a box that is periodic along x, y and z");
    }
    let balances = [
        ("particle_force", WeightBalance::ParticleForce),
        ("grid_integral", WeightBalance::GridIntegral),
    ];
    section.choice(key, &balances).map(Drive::Weight)
}

/// The pressure above a compressible gas, which is also that above the bed of a plenum; such a gas needs a plate.
fn read_compressible(
    section: &Section<'_>,
    drive: Option<&Drive>,
    bounds: Option<&Bounds>,
) -> Option<f64> {
    let pressure = section.number("pressure")?;
    if bounds.is_some_and(|bounds| bounds.is_periodic(2)) {
        section.fail("pressure", "needs a plate: the box is periodic along z");
    }
    if let Some(Drive::Plenum(plenum)) = drive
        && plenum.pressure != pressure
    {
        let that = plenum.pressure;
        section.fail("pressure", format!("must be that above the plenum's bed, {that}"));
    }
    Some(pressure)
}

/// The plenum from which a flow comes; it lies below a plate.
fn read_plenum(section: &Section<'_>, supply: Schedule, bounds: Option<&Bounds>) -> Option<Plenum> {
    if bounds.is_some_and(|bounds| bounds.is_periodic(2)) {
        section.fail("height", "needs a plate: the box is periodic along z");
    }
    Some(Plenum {
        supply,
        height: section.number("height")?,
        pressure: section.number("pressure")?,
        linear_resistance: section.number("linear_resistance")?,
        quadratic_resistance: section.number("quadratic_resistance")?,
    })
}
