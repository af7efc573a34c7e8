//! Where a point lies, as seen from the nearest point of a surface.

use nalgebra::Vector3;

/// Distance and direction of a point from the nearest point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FromSurface {
    /// Distance; length.
    pub distance: f64,
    /// Unit vector from the nearest point of the surface; zero on the surface and where no point is the nearest.
    pub direction: Vector3<f64>,
}

impl FromSurface {
    /// The distance and direction of a point that lies at an offset from the nearest point of the surface.
    pub(super) fn at(offset: Vector3<f64>) -> Self {
        let distance = offset.norm();
        let direction = if distance > 0.0 { offset / distance } else { Vector3::zeros() };
        Self { distance, direction }
    }

    /// The distance and direction of a point at a signed height along a unit normal of the surface.
    pub(super) fn above(height: f64, normal: Vector3<f64>) -> Self {
        Self { distance: height.abs(), direction: normal * height.signum() }
    }
}
