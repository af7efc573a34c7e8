//! The space in which a run takes place.

use crate::domain::{Bounds, BoxFace, Face, Side, Wall, WallShape};
use nalgebra::Vector3;

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

    /// Whether the middle of a particle of an initial bed may lie at a point, whatever its distance from the walls: in
    /// one of the rooms that hold the bed, if there are any, and in none that must stay empty.
    pub fn may_hold_bed(&self, point: &Vector3<f64>) -> bool {
        let walls_of = |side: Side| self.walls.iter().filter(move |wall| wall.side == side);
        let is_in = |wall: &Wall| wall.surrounds(point);
        let needs_room = walls_of(Side::Inside).next().is_some();
        (!needs_room || walls_of(Side::Inside).any(is_in)) && !walls_of(Side::Outside).any(is_in)
    }

    /// Horizontal cross-section available to particles, of the box or of a narrower round column; area.
    pub fn cross_section(&self) -> f64 {
        let area = |wall: &Wall| match wall.shape {
            WallShape::Plane { .. } | WallShape::Limited(_) => f64::INFINITY,
            WallShape::Cylinder { radius, .. } => std::f64::consts::PI * radius * radius,
        };
        self.walls.iter().map(area).fold(self.bounds.cross_section(), f64::min)
    }
}
