//! The walls of limited extent of a case, and how walls turn.

use crate::input::Section;
use nalgebra::{Vector2, Vector3};
use talcum_engine::domain::{Axis, Bend, Side, Surface, Wall, WallRotation, WallShape};

/// Largest sum of the parts of two unit vectors along each other that counts as perpendicular: decimal input.
const ROUNDING: f64 = 1.0e-6;

/// The surface that a table of the kind of this name describes.
pub(super) fn read_surface(kind: &str, section: &Section<'_>) -> Option<Surface> {
    match kind {
        "rectangle" => read_rectangle(section),
        "disc" => read_disc(section),
        "cylinder" => read_cylinder(section),
        "cone" => read_cone(section),
        "sphere" => Some(Surface::Sphere {
            centre: vector(section, "centre")?,
            radius: section.number("radius")?,
        }),
        _ => read_bend(section),
    }
}

/// Where the initial bed may lie; shapes that surround no room do not have the key.
pub(super) fn read_side(section: &Section<'_>) -> Side {
    let word = if section.has("bed") { section.word("bed") } else { None };
    match word {
        Some("inside") => Side::Inside,
        Some("outside") => Side::Outside,
        _ => Side::Both,
    }
}

pub(super) fn vector(section: &Section<'_>, name: &str) -> Option<Vector3<f64>> {
    section.vector(name).map(Vector3::from)
}

/// A vector as a unit vector; the zero vector is an error.
pub(super) fn direction(section: &Section<'_>, name: &'static str) -> Option<Vector3<f64>> {
    let unit = vector(section, name)?.try_normalize(0.0);
    if unit.is_none() {
        section.fail(name, "must not be the zero vector");
    }
    unit
}

fn read_rectangle(section: &Section<'_>) -> Option<Surface> {
    let corner = vector(section, "corner")?;
    let edges = [vector(section, "first_edge")?, vector(section, "second_edge")?];
    for (name, edge) in ["first_edge", "second_edge"].into_iter().zip(&edges) {
        if *edge == Vector3::zeros() {
            section.fail(name, "must not be the zero vector");
            return None;
        }
    }
    if edges[0].normalize().dot(&edges[1].normalize()).abs() > ROUNDING {
        section.fail("second_edge", "must be perpendicular to first_edge");
        return None;
    }
    let half_edges = edges.map(|edge| edge * 0.5);
    Some(Surface::Rectangle { centre: corner + half_edges[0] + half_edges[1], half_edges })
}

fn read_disc(section: &Section<'_>) -> Option<Surface> {
    let (radius, hole) = (section.number("radius")?, section.number("hole")?);
    if hole >= radius {
        section.fail("hole", format!("must be below radius, {radius}"));
        return None;
    }
    let axis = Axis { point: vector(section, "centre")?, direction: direction(section, "normal")? };
    Some(Surface::Revolved { axis, ends: [Vector2::new(0.0, hole), Vector2::new(0.0, radius)] })
}

fn read_cylinder(section: &Section<'_>) -> Option<Surface> {
    let (axis, length) = read_axis(section)?;
    let radius = section.number("radius")?;
    Some(Surface::Revolved {
        axis,
        ends: [Vector2::new(0.0, radius), Vector2::new(length, radius)],
    })
}

fn read_cone(section: &Section<'_>) -> Option<Surface> {
    let (axis, length) = read_axis(section)?;
    let [first, last] = section.vector("radii")?;
    if first == 0.0 && last == 0.0 {
        section.fail("radii", "must not both be 0");
        return None;
    }
    Some(Surface::Revolved { axis, ends: [Vector2::new(0.0, first), Vector2::new(length, last)] })
}

/// The axis from `from` to `to`, and their distance.
fn read_axis(section: &Section<'_>) -> Option<(Axis, f64)> {
    let (from, to) = (vector(section, "from")?, vector(section, "to")?);
    let Some(direction) = (to - from).try_normalize(0.0) else {
        section.fail("to", "must not be the point from");
        return None;
    };
    Some((Axis { point: from, direction }, (to - from).norm()))
}

fn read_bend(section: &Section<'_>) -> Option<Surface> {
    let centre = vector(section, "centre")?;
    let arm = vector(section, "from")? - centre;
    let (bend_radius, radius) = (arm.norm(), section.number("radius")?);
    let (onwards, degrees) = (direction(section, "onwards")?, section.number("angle")?);
    if radius >= bend_radius {
        section.fail(
            "radius",
            format!("must be below the distance from centre to from, {bend_radius}"),
        );
        return None;
    }
    let start = arm / bend_radius;
    if start.dot(&onwards).abs() > ROUNDING {
        section.fail("onwards", "must be perpendicular to the line from centre to from");
        return None;
    }
    if degrees > 360.0 {
        section.fail("angle", "must be at most 360");
        return None;
    }
    Some(Surface::Bend(Bend {
        centre,
        start,
        onwards,
        bend_radius,
        radius,
        angle: degrees.to_radians(),
    }))
}

/// Start and end of a motion; without an end it never ends.
pub(super) fn read_times(section: &Section<'_>) -> Option<[f64; 2]> {
    let start = section.number("start")?;
    let end = if section.has("end") { section.number("end")? } else { f64::INFINITY };
    if end <= start {
        section.fail("end", format!("must be after start, {start}"));
        return None;
    }
    Some([start, end])
}

/// Frequency of an oscillation; 0 without an amplitude.
pub(super) fn read_frequency(section: &Section<'_>) -> Option<f64> {
    if section.has("amplitude") { section.number("frequency") } else { Some(0.0) }
}

/// The rotation of a wall.
pub(super) fn read_rotation(section: &Section<'_>, wall: &Wall) -> Option<WallRotation> {
    let axis = match (section.has("axis"), &wall.shape) {
        (true, _) => {
            Axis { point: vector(section, "point")?, direction: direction(section, "axis")? }
        }
        (false, WallShape::Limited(surface)) if surface.own_axis().is_some() => {
            surface.own_axis()?
        }
        (false, _) => {
            section.fail(
                "axis",
                "must be given: only a disc, a cylinder and a cone have an axis of their own",
            );
            return None;
        }
    };
    if !matches!(wall.shape, WallShape::Limited(_)) && !wall.is_symmetric_about(&axis) {
        section.fail(
            "axis",
            "a wall without limits turns about its normal, or the axis of its round column, alone: give it limits",
        );
        return None;
    }
    let [start, end] = read_times(section)?;
    let frequency = read_frequency(section)?;
    let amplitude =
        if section.has("amplitude") { section.number("amplitude")?.to_radians() } else { 0.0 };
    let (speed, ramp) = (section.number("speed")?, section.number("ramp")?);
    Some(WallRotation { axis, speed, ramp, amplitude, frequency, start, end })
}
