//! The box.

use super::allowed::Allowed;
use super::leaf::must_be_one_of;
use super::section::Section;
use super::tree::{Node, Value};
use crate::domain::{Bounds, Face};
use nalgebra::Vector3;

pub(super) const AXES: [&str; 3] = ["x", "y", "z"];

/// `[box]`.
pub(super) fn read_bounds(section: Section<'_>) -> Option<Bounds> {
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
