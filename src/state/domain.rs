//! Where a run happens.

use crate::domain::{Bounds, BoxFace, Face, Wall, WallShape};

/// Where it happens: the same for the whole run.
#[derive(Clone, Debug, PartialEq)]
pub struct Domain {
    /// The box.
    pub bounds: Bounds,
    /// Walls: those in faces of the box first, then the case's own.
    pub walls: Vec<Wall>,
}

impl Domain {
    /// A box with the walls that lie in its faces.
    pub fn of_box(bounds: Bounds) -> Self {
        let faces = BoxFace::ALL.into_iter().filter(|&face| bounds.face(face) == Face::Wall);
        let walls = faces.map(|face| Wall::in_face(&bounds, face)).collect();
        Self { bounds, walls }
    }

    /// Horizontal cross-section that particles have room in: of the box, or of a narrower round column.
    pub fn cross_section(&self) -> f64 {
        let area = |wall: &Wall| match wall.shape {
            WallShape::Plane { .. } => f64::INFINITY,
            WallShape::Cylinder { radius, .. } => std::f64::consts::PI * radius * radius,
        };
        self.walls.iter().map(area).fold(self.bounds.cross_section(), f64::min)
    }
}
