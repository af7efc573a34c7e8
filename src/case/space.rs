//! The box and its walls.

use super::allowed::Allowed;
use super::errors::Problems;
use super::leaf::must_be_one_of;
use super::section::Section;
use super::tree::{Node, Value};
use crate::domain::{BASE_PLATE, Bounds, Face, Wall};
use crate::state::Domain;
use nalgebra::Vector3;

const AXES: [&str; 3] = ["x", "y", "z"];

/// `[box]` and `[[wall]]`.
pub(super) fn read_domain(root: &Section<'_>) -> Option<Domain> {
    let bounds = root.section("box").and_then(read_bounds);
    let walls = root.get("wall").map(|node| read_walls(node, root.problems));
    let bounds = bounds?;
    let mut all = face_walls(&bounds);
    for (wall, node) in walls.into_iter().flatten() {
        if all.iter().any(|other| other.name == wall.name) {
            root.problems.add(node.error(format!("there is another wall {:?}", wall.name)));
        }
        if let Some(axis) =
            (0..3).find(|&axis| bounds.is_periodic(axis) && wall.normal[axis] != 0.0)
        {
            let axis = AXES[axis];
            let words = format!(
                "must be parallel to {axis}, along which the box is periodic: normal = 0 there"
            );
            root.problems.add(node.error(words));
        }
        all.push(wall);
    }
    Some(Domain { bounds, walls: all })
}

fn read_bounds(section: Section<'_>) -> Option<Bounds> {
    let lengths = section.numbers("lengths", Allowed::POSITIVE);
    let lengths = lengths.filter(|lengths| {
        if lengths.len() != 3 {
            section.fail("lengths", "must be a list of 3 numbers");
        }
        lengths.len() == 3
    });
    let faces: Vec<Option<[Face; 2]>> =
        AXES.iter().map(|axis| read_faces(&section, axis)).collect();
    section.finish();
    let lengths = lengths?;
    let lengths = Vector3::new(lengths[0], lengths[1], lengths[2]);
    Some(Bounds::new(lengths, [faces[0]?, faces[1]?, faces[2]?]))
}

fn read_faces(section: &Section<'_>, axis: &'static str) -> Option<[Face; 2]> {
    let Some(node) = section.get(axis) else {
        section.fail(
            axis,
            "missing: must be \"periodic\", \"wall\", \"open\", \"stop\" or { lower = , upper = }",
        );
        return None;
    };
    if !matches!(node.value, Value::Table(_)) {
        let all = ["periodic", "wall", "open", "stop"];
        return face_of(section, node, &all).map(|face| [face; 2]);
    }
    let inner = Section::of(node, section.problems)?;
    let sides = ["lower", "upper"].map(|side| match inner.get(side) {
        Some(node) if node.as_text() == Some("periodic") => {
            inner.fail(side, format!("holds for both faces: write {axis} = \"periodic\""));
            None
        }
        Some(node) => face_of(&inner, node, &["wall", "open", "stop"]),
        None => {
            inner.fail(side, "missing: must be \"wall\" or \"open\" or \"stop\"");
            None
        }
    });
    inner.finish();
    Some([sides[0]?, sides[1]?])
}

fn face_of(section: &Section<'_>, node: &Node, allowed: &[&str]) -> Option<Face> {
    match node.as_text() {
        Some("periodic") => Some(Face::Periodic),
        Some("wall") => Some(Face::Wall),
        Some("open") => Some(Face::Open),
        Some("stop") => Some(Face::Stop),
        other => {
            section.problems.add(node.error(must_be_one_of(other.unwrap_or(""), allowed)));
            None
        }
    }
}

/// Walls in the faces of the box.
fn face_walls(bounds: &Bounds) -> Vec<Wall> {
    let mut walls = Vec::new();
    for axis in 0..3 {
        for (side, name) in ["lower", "upper"].iter().enumerate() {
            if bounds.faces(axis)[side] != Face::Wall {
                continue;
            }
            let name = match (axis, side) {
                (2, 0) => BASE_PLATE.to_owned(),
                _ => format!("{} {name}", AXES[axis]),
            };
            let mut point = Vector3::zeros();
            let mut normal = Vector3::zeros();
            point[axis] = bounds.lengths()[axis] * side as f64;
            normal[axis] = 1.0 - 2.0 * side as f64;
            walls.push(Wall { name, point, normal });
        }
    }
    walls
}

fn read_walls<'a>(node: &'a Node, problems: &Problems) -> Vec<(Wall, &'a Node)> {
    if !matches!(node.value, Value::List(_)) {
        problems.add(node.error("must be a list of sections, each [[wall]]"));
    }
    node.items().iter().filter_map(|item| Some((read_wall(item, problems)?, item))).collect()
}

fn read_wall(node: &Node, problems: &Problems) -> Option<Wall> {
    let section = Section::of(node, problems)?;
    let name = section.text("name");
    let vector = |key| {
        let numbers = section.numbers(key, Allowed::FINITE)?;
        if numbers.len() != 3 {
            section.fail(key, "must be a list of 3 numbers");
            return None;
        }
        Some(Vector3::new(numbers[0], numbers[1], numbers[2]))
    };
    let point = vector("point");
    let normal = vector("normal");
    let unit = normal.and_then(|normal| normal.try_normalize(0.0));
    if normal.is_some() && unit.is_none() {
        section.fail("normal", "must not be the zero vector");
    }
    section.finish();
    Some(Wall { name: name?, point: point?, normal: unit? })
}
