//! The walls: those in faces of the box, and those of the case.

use super::boxes::{AXES, read_bounds};
use super::meshes::{MeshFile, read_mesh};
use super::schema::SHAPES;
use super::surfaces::{
    direction, read_frequency, read_rotation, read_side, read_surface, read_times,
};
use super::{Case, Stage};
use crate::input::{Node, Problems, Section};
use nalgebra::Vector3;
use std::path::Path;
use talcum_engine::domain::{Bounds, BoxFace, Side, Surface, Wall, WallMotion, WallShape};
use talcum_engine::gas::GasModel;
use talcum_engine::rules::speed_limit;
use talcum_engine::state::Domain;

/// `[box]` and `[[wall]]`, and the files of meshes, which are relative to a folder.
pub(super) fn read_domain(root: &Section<'_>, folder: &Path) -> Option<(Domain, Vec<MeshFile>)> {
    let bounds = root.table("box").as_ref().and_then(read_bounds);
    let mut files = Vec::new();
    let mut given = Vec::new();
    for (number, wall) in root.tables("wall").iter().enumerate() {
        let mut read_mesh = |table: &Section<'_>| {
            let (surface, file) = read_mesh(table, folder, number)?;
            files.push(file);
            Some(surface)
        };
        given.push((read_wall(wall, &mut read_mesh), wall.node));
    }
    let Domain { bounds, walls: mut all } = Domain::of_box(bounds?);
    for (entry, node) in given {
        let Some(entry) = entry else { continue };
        match entry {
            Entry::Face { face, motion } => move_face(&mut all, face, motion, node, root.problems),
            Entry::Own(wall) => {
                if all.iter().any(|other| other.name == wall.name) {
                    let message = format!("there is another wall {:?}", wall.name);
                    root.problems.add(node.error(message));
                }
                check_periodic(&bounds, &wall, node, root.problems);
                all.push(*wall);
            }
        }
    }
    Some((Domain { bounds, walls: all }, files))
}

/// The keys for the contacts of each wall, in the order of the walls.
pub(super) fn contacts_of<'a>(root: &'a Node, domain: &Domain) -> Vec<Option<&'a Node>> {
    let entries = root.get("wall").map(Node::items).unwrap_or_default();
    let is_of = |entry: &Node, wall: &Wall| {
        let text = |key: &str| entry.get(key).and_then(Node::as_text);
        match wall.face {
            Some(face) => text("face").and_then(BoxFace::named) == Some(face),
            None => text("name") == Some(wall.name.as_str()),
        }
    };
    let of = |wall: &Wall| entries.iter().find(|entry| is_of(entry, wall))?.get("contact");
    domain.walls.iter().map(of).collect()
}

/// One `[[wall]]`.
enum Entry {
    /// A wall of the box: its motion.
    Face { face: BoxFace, motion: WallMotion },
    /// A wall of the case.
    Own(Box<Wall>),
}

fn read_wall(
    section: &Section<'_>,
    read_mesh: &mut dyn FnMut(&Section<'_>) -> Option<Surface>,
) -> Option<Entry> {
    let motion = read_motion(section);
    let given = section.given(&SHAPES)?;
    if given == "face" {
        let face = section.word("face").and_then(BoxFace::named)?;
        if section.has("rotation") {
            section
                .fail("rotation", "a wall in a face of the box cannot turn: use a disc in the box");
        }
        return Some(Entry::Face { face, motion: motion? });
    }
    let (shape, side) = match given {
        "radius" => (read_cylinder(section), Side::Both),
        "normal" => (read_plane(section), Side::Both),
        _ => {
            let table = section.table(given)?;
            let surface =
                if given == "mesh" { read_mesh(&table) } else { read_surface(given, &table) };
            (surface.map(WallShape::Limited), read_side(&table))
        }
    };
    let wall = Wall { side, ..Wall::of_shape(section.text("name")?, shape?) };
    let rotation = match section.table("rotation") {
        Some(table) => Some(read_rotation(&table, &wall)?),
        None => None,
    };
    Some(Entry::Own(Box::new(Wall { motion: motion?, rotation, ..wall })))
}

fn read_plane(section: &Section<'_>) -> Option<WallShape> {
    let normal = direction(section, "normal");
    Some(WallShape::Plane { point: section.vector("point")?.into(), normal: normal? })
}

fn read_cylinder(section: &Section<'_>) -> Option<WallShape> {
    let [x, y] = section.vector("centre")?;
    Some(WallShape::Cylinder { centre: Vector3::new(x, y, 0.0), radius: section.number("radius")? })
}

/// Velocity, oscillation, and times of the motion.
fn read_motion(section: &Section<'_>) -> Option<WallMotion> {
    let vector = |name| section.vector(name).map(Vector3::from).unwrap_or_default();
    let frequency = read_frequency(section);
    let [start, end] = read_times(section)?;
    let (velocity, amplitude) = (vector("velocity"), vector("amplitude"));
    Some(WallMotion { velocity, amplitude, frequency: frequency?, start, end })
}

/// A face of the box in motion: in its plane, or inwards.
fn move_face(
    walls: &mut [Wall],
    face: BoxFace,
    motion: WallMotion,
    node: &Node,
    problems: &Problems,
) {
    let Some(wall) = walls.iter_mut().find(|wall| wall.face == Some(face)) else {
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

/// Checks that walls are periodic where the box is.
fn check_periodic(bounds: &Bounds, wall: &Wall, node: &Node, problems: &Problems) {
    let across = (0..3).filter(|&axis| bounds.is_periodic(axis)).find(|&axis| match &wall.shape {
        WallShape::Plane { normal, .. } => normal[axis] != 0.0,
        WallShape::Cylinder { .. } => axis < 2,
        WallShape::Limited(surface) => !reaches_through(wall, surface, bounds, axis),
    });
    let Some(axis) = across.map(|axis| AXES[axis]) else { return };
    problems.add(node.error(match wall.shape {
        WallShape::Plane { .. } => {
            format!("must be parallel to {axis}, along which the box is periodic: normal = 0 there")
        }
        WallShape::Cylinder { .. } => format!(
            "needs a box that is not periodic along {axis}: box.{axis} = \"stop\", for example"
        ),
        WallShape::Limited(_) => format!(
            "must reach from one face of the box to the other along {axis}, parallel to it, since the box is periodic \
             along {axis}; or make the box {axis} = \"stop\", for example"
        ),
    }));
}

/// Whether a surface is the same everywhere along a periodic axis of the box, and stays so as it moves.
fn reaches_through(wall: &Wall, surface: &Surface, bounds: &Bounds, axis: usize) -> bool {
    let stays = wall.rotation.is_none_or(|rotation| surface.is_symmetric_about(&rotation.axis));
    let moves_along = wall.motion.velocity[axis] != 0.0 || wall.motion.amplitude[axis] != 0.0;
    let length = bounds.lengths()[axis];
    let covers = |[lower, upper]: [f64; 2]| lower <= 0.0 && length <= upper;
    stays && !moves_along && surface.uniform_range(axis).is_some_and(covers)
}

/// Errors of walls for particles with this smallest diameter and for the gas: (key, message).
pub(super) fn check_walls(case: &Case, smallest_diameter: f64) -> Vec<(&'static str, String)> {
    let mut wrong = Vec::new();
    let fastest = |stage: &Stage| speed_limit(smallest_diameter, stage.physics.time_step);
    let limit = case.stages.iter().map(fastest).fold(f64::INFINITY, f64::min);
    let with_gas = case.stages.iter().any(|stage| stage.physics.gas != GasModel::None);
    let is_volume_averaged =
        |stage: &Stage| matches!(stage.physics.gas, GasModel::VolumeAveraged(_));
    let with_volume_averaged_gas = case.stages.iter().any(is_volume_averaged);
    let is_column = |stage: &Stage| matches!(stage.physics.gas, GasModel::Column(_));
    let with_column_gas = case.stages.iter().any(is_column);
    for wall in &case.domain.walls {
        let (name, speed) = (&wall.name, wall.largest_approach_speed());
        if speed > limit {
            wrong.push(("wall", format!(
                "{name:?} moves at {speed:.3e} towards particles (limit {limit:.3e}: a tenth of the \
                 smallest diameter per step): shorten time.step"
            )));
        }
        if with_volume_averaged_gas && matches!(wall.shape, WallShape::Limited(_)) {
            let message = format!(
                "a volume-averaged gas does not flow around {name:?}: it knows the faces of the box, planes and a round \
                 column alone"
            );
            wrong.push(("gas", message));
        }
        if with_column_gas && wall.is_round() {
            let message =
                "a gas of kind \"column\" fills the box: in a round column use \"volume_averaged\"";
            wrong.push(("gas", message.to_owned()));
        }
        if with_gas && wall.face.is_some() && speed > 0.0 {
            let message = format!(
                "the gas reaches from face to face of the box: {name:?} cannot move inwards, only in its \
                 plane (a plate that vibrates: use [vibration])"
            );
            wrong.push(("gas", message));
        }
    }
    wrong
}
