//! The box.

use crate::input::Section;
use nalgebra::Vector3;
use talcum_engine::domain::{Bounds, Face};

pub(super) const AXES: [&str; 3] = ["x", "y", "z"];

/// Meaning of the words for faces.
const FACES: [(&str, Face); 4] = [
    ("periodic", Face::Periodic),
    ("wall", Face::Wall),
    ("open", Face::Open),
    ("stop", Face::Stop),
];

/// `[box]`.
pub(super) fn read_bounds(section: &Section<'_>) -> Option<Bounds> {
    let [x, y, z] = AXES.map(|axis| read_faces(section, axis));
    let lengths = section.vector("lengths").map(Vector3::from)?;
    Some(Bounds::new(lengths, [x?, y?, z?]))
}

fn read_faces(section: &Section<'_>, axis: &str) -> Option<[Face; 2]> {
    let Some(sides) = section.table(axis) else {
        return section.choice(axis, &FACES).map(|face| [face; 2]);
    };
    let faces = ["lower", "upper"].map(|side| sides.choice(side, &FACES));
    for (side, face, other) in [("lower", faces[0], faces[1]), ("upper", faces[1], faces[0])] {
        if face == Some(Face::Periodic) && other != face {
            sides.fail(side, format!("holds for both faces: write {axis} = \"periodic\""));
        }
    }
    Some([faces[0]?, faces[1]?])
}
