//! Flat walls.

use nalgebra::Vector3;

/// Name of the wall in the lower z face, whose stress is reported.
pub const BASE_PLATE: &str = "base plate";

/// An infinite plane at rest in the frame of the box; particles are on the side the normal points to.
#[derive(Clone, Debug, PartialEq)]
pub struct Wall {
    /// How results call it: "base plate", "x lower", or the case's own name.
    pub name: String,
    /// A point of the plane.
    pub point: Vector3<f64>,
    /// Unit normal, into the bed.
    pub normal: Vector3<f64>,
}

impl Wall {
    /// Height of a point above the plane, negative behind it.
    #[inline(always)]
    pub fn height_of(&self, position: &Vector3<f64>) -> f64 {
        self.normal.dot(&(position - self.point))
    }
}
