//! The space in which a run takes place.

use crate::domain::{Bounds, BoxFace, Face, Wall, WallShape};

/// The box and its walls, which do not change during a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Domain {
    /// The box.
    pub bounds: Bounds,
    /// Walls: first those in faces of the box, then the walls of the case.
    pub walls: Vec<Wall>,
}

impl Domain {
    /// A box with the walls that lie in its faces.
    pub fn of_box(bounds: Bounds) -> Self {
        let faces = BoxFace::ALL.into_iter().filter(|&face| bounds.face(face) == Face::Wall);
        let walls = faces.map(|face| Wall::in_face(&bounds, face)).collect();
        Self { bounds, walls }
    }

    /// Horizontal cross-section available to particles, of the box or of a narrower round column; area.
    pub fn cross_section(&self) -> f64 {
        let area = |wall: &Wall| match wall.shape {
            WallShape::Plane { .. } => f64::INFINITY,
            WallShape::Cylinder { radius, .. } => std::f64::consts::PI * radius * radius,
        };
        self.walls.iter().map(area).fold(self.bounds.cross_section(), f64::min)
    }
}
