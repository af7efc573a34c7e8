//! The walls: in faces of the box, and the case's own.

use super::allowed::Allowed;
use super::errors::Problems;
use super::leaf::must_be_one_of;
use super::section::Section;
use super::space::{AXES, read_bounds};
use super::tree::{Node, Value};
use super::{Case, Stage};
use crate::domain::{Bounds, BoxFace, Face, Wall, WallMotion, WallShape};
use crate::gas::GasModel;
use crate::rules::speed_limit;
use crate::state::Domain;
use nalgebra::Vector3;

/// `[box]` and `[[wall]]`.
pub(super) fn read_domain(root: &Section<'_>) -> Option<Domain> {
    let bounds = root.section("box").and_then(read_bounds);
    let given = root.get("wall").map(|node| read_walls(node, root.problems));
    let bounds = bounds?;
    let mut all = face_walls(&bounds);
    for (entry, node) in given.into_iter().flatten() {
        match entry {
            Entry::Face { face, motion } => move_face(&mut all, face, motion, node, root.problems),
            Entry::Own(wall) => {
                if all.iter().any(|other| other.name == wall.name) {
                    let words = format!("there is another wall {:?}", wall.name);
                    root.problems.add(node.error(words));
                }
                check_periodic(&bounds, &wall, node, root.problems);
                all.push(wall);
            }
        }
    }
    Some(Domain { bounds, walls: all })
}

/// What the case says about the contacts of each wall, in the order of the walls.
pub(super) fn contacts_of<'a>(root: &'a Node, domain: &Domain) -> Vec<Option<&'a Node>> {
    let entries = root.get("wall").map(Node::items).unwrap_or_default();
    let is_of = |entry: &Node, wall: &Wall| {
        let text = |key: &str| entry.get(key).and_then(Node::as_text);
        let of_face = || BoxFace::named(text("face")?).map(Wall::name_in_face);
        text("name").or_else(of_face) == Some(wall.name.as_str())
    };
    let of = |wall: &Wall| entries.iter().find(|entry| is_of(entry, wall))?.get("contact");
    domain.walls.iter().map(of).collect()
}

/// Walls in the faces of the box.
fn face_walls(bounds: &Bounds) -> Vec<Wall> {
    let is_wall = |face: &BoxFace| bounds.face(*face) == Face::Wall;
    BoxFace::ALL.into_iter().filter(is_wall).map(|face| Wall::in_face(bounds, face)).collect()
}

/// One `[[wall]]`.
enum Entry {
    /// A wall of the box: its motion.
    Face { face: BoxFace, motion: WallMotion },
    /// A wall of the case's own.
    Own(Wall),
}

fn read_walls<'a>(node: &'a Node, problems: &Problems) -> Vec<(Entry, &'a Node)> {
    if !matches!(node.value, Value::List(_)) {
        problems.add(node.error("must be a list of sections, each [[wall]]"));
    }
    node.items().iter().filter_map(|item| Some((read_wall(item, problems)?, item))).collect()
}

fn read_wall(node: &Node, problems: &Problems) -> Option<Entry> {
    let section = Section::of(node, problems)?;
    section.get("contact"); // read with the section of that name
    let kind = section.exactly_one(&["normal", "radius", "face"]);
    let motion = read_motion(&section);
    let entry = match kind {
        Some("face") => {
            read_face(&section).zip(motion).map(|(face, motion)| Entry::Face { face, motion })
        }
        Some(kind) => {
            let name = section.text("name");
            let shape =
                if kind == "radius" { read_cylinder(&section) } else { read_plane(&section) };
            name.zip(shape)
                .zip(motion)
                .map(|((name, shape), motion)| Entry::Own(Wall { name, shape, motion }))
        }
        None => {
            section.text("name");
            section.get("point");
            section.get("centre");
            None
        }
    };
    section.finish();
    entry
}

fn read_face(section: &Section<'_>) -> Option<BoxFace> {
    let word = section.text("face")?;
    let face = BoxFace::named(&word);
    if face.is_none() {
        section.fail("face", must_be_one_of(&word, &BoxFace::NAMES));
    }
    face
}

fn read_plane(section: &Section<'_>) -> Option<WallShape> {
    let point = vector(section, "point");
    let normal = vector(section, "normal");
    let unit = normal.and_then(|normal| normal.try_normalize(0.0));
    if normal.is_some() && unit.is_none() {
        section.fail("normal", "must not be the zero vector");
    }
    Some(WallShape::Plane { point: point?, normal: unit? })
}

fn read_cylinder(section: &Section<'_>) -> Option<WallShape> {
    let centre = section.numbers("centre", Allowed::FINITE).filter(|numbers| {
        if numbers.len() != 2 {
            section.fail("centre", "must be a list of 2 numbers, x and y");
        }
        numbers.len() == 2
    });
    let radius = section.number("radius", Allowed::POSITIVE);
    let centre = centre?;
    Some(WallShape::Cylinder { centre: Vector3::new(centre[0], centre[1], 0.0), radius: radius? })
}

fn vector(section: &Section<'_>, key: &'static str) -> Option<Vector3<f64>> {
    let numbers = section.numbers(key, Allowed::FINITE)?;
    if numbers.len() != 3 {
        section.fail(key, "must be a list of 3 numbers");
        return None;
    }
    Some(Vector3::new(numbers[0], numbers[1], numbers[2]))
}

/// Velocity, oscillation, and when.
fn read_motion(section: &Section<'_>) -> Option<WallMotion> {
    let optional = |key| match section.has(key) {
        true => vector(section, key),
        false => Some(Vector3::zeros()),
    };
    let velocity = optional("velocity");
    let amplitude = optional("amplitude");
    let frequency = match section.has("amplitude") {
        true => section.number("frequency", Allowed::POSITIVE),
        false => {
            if section.has("frequency") {
                section.fail("frequency", "is that of an amplitude: give both");
            }
            Some(0.0)
        }
    };
    let start = section.number_or("start", Allowed::NOT_NEGATIVE, 0.0);
    let end = section.number_or("end", Allowed::POSITIVE, f64::INFINITY);
    if end <= start {
        section.fail("end", format!("must be after start, {start}"));
        return None;
    }
    Some(WallMotion {
        velocity: velocity?,
        amplitude: amplitude?,
        frequency: frequency?,
        start,
        end,
    })
}

/// A face of the box in motion: in its plane, or inwards.
fn move_face(
    walls: &mut [Wall],
    face: BoxFace,
    motion: WallMotion,
    node: &Node,
    problems: &Problems,
) {
    let name = Wall::name_in_face(face);
    let Some(wall) = walls.iter_mut().find(|wall| wall.name == name) else {
        problems.add(node.error(format!("there is no wall in the {face} face: [box] says so")));
        return;
    };
    let WallShape::Plane { normal, .. } = wall.shape else { return };
    if motion.velocity.dot(&normal) < 0.0 || motion.amplitude.dot(&normal) != 0.0 {
        problems.add(node.error(
            "would leave the box: the wall of a face moves in its plane or inwards; one that moves to \
             and fro is a [[wall]] of its own, with a point inside of the box",
        ));
    }
    wall.motion = motion;
}

/// Where the box repeats, walls must repeat with it.
fn check_periodic(bounds: &Bounds, wall: &Wall, node: &Node, problems: &Problems) {
    let across = (0..3).filter(|&axis| bounds.is_periodic(axis)).find(|&axis| match wall.shape {
        WallShape::Plane { normal, .. } => normal[axis] != 0.0,
        WallShape::Cylinder { .. } => axis < 2,
    });
    let Some(axis) = across.map(|axis| AXES[axis]) else { return };
    problems.add(node.error(match wall.shape {
        WallShape::Plane { .. } => {
            format!("must be parallel to {axis}, along which the box is periodic: normal = 0 there")
        }
        WallShape::Cylinder { .. } => format!(
            "needs a box that is not periodic along {axis}: box.{axis} = \"stop\", for example"
        ),
    }));
}

/// What is wrong with walls for particles of this smallest diameter and for the gas: (key, words).
pub(super) fn check_walls(case: &Case, smallest_diameter: f64) -> Vec<(&'static str, String)> {
    let mut wrong = Vec::new();
    let fastest = |stage: &Stage| speed_limit(smallest_diameter, stage.time_step);
    let limit = case.stages.iter().map(fastest).fold(f64::INFINITY, f64::min);
    let with_gas = case.stages.iter().any(|stage| stage.gas != GasModel::None);
    for wall in &case.domain.walls {
        let (name, speed) = (&wall.name, wall.largest_approach_speed());
        if speed > limit {
            wrong.push(("wall", format!(
                "{name:?} moves at {speed:.3e} towards particles (limit {limit:.3e}: a tenth of the \
                 smallest diameter per step): shorten time.step"
            )));
        }
        let is_round = matches!(wall.shape, WallShape::Cylinder { .. });
        if with_gas && is_round {
            let words = "the gas fills the box: it cannot flow in a round column";
            wrong.push(("gas", words.to_owned()));
        }
        let is_face = BoxFace::ALL.into_iter().any(|face| Wall::name_in_face(face) == name);
        if with_gas && is_face && speed > 0.0 {
            let words = format!(
                "the gas reaches from face to face of the box: {name:?} cannot move inwards, only in its \
                 plane (a plate that vibrates: use [vibration])"
            );
            wrong.push(("gas", words));
        }
    }
    wrong
}
