//! The planes that bound a facet, by which most facets that a point is not near are recognised at little cost.

use nalgebra::Vector3;

/// The plane of a facet and the three planes through its edges that are perpendicular to it, side by side: the heights
/// of a point above them are `x[k] p.x + y[k] p.y + z[k] p.z - at[k]`, above those of the edges inwards.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Planes {
    x: [f64; 4],
    y: [f64; 4],
    z: [f64; 4],
    at: [f64; 4],
    /// What rounding may change a height by, for a point near the facet.
    rounding: f64,
}

/// Rounding of a sum of four products, over the largest of them; a point near the facet has coordinates like its own.
const ROUNDING: f64 = 1.0e-15;

impl Planes {
    /// The planes of a facet with this unit normal.
    pub(super) fn of(normal: &Vector3<f64>, corners: [Vector3<f64>; 3]) -> Self {
        let inwards = |k: usize| normal.cross(&(corners[(k + 1) % 3] - corners[k])).normalize();
        let normals = [*normal, inwards(0), inwards(1), inwards(2)];
        let points = [corners[0], corners[0], corners[1], corners[2]];
        let reach = corners.iter().map(|corner| corner.amax()).fold(0.0, f64::max);
        Self {
            x: normals.map(|normal| normal.x),
            y: normals.map(|normal| normal.y),
            z: normals.map(|normal| normal.z),
            at: [0, 1, 2, 3].map(|k| normals[k].dot(&points[k])),
            rounding: 20.0 * ROUNDING * reach,
        }
    }

    /// The unit normal of the facet.
    #[inline(always)]
    pub(super) fn normal(&self) -> Vector3<f64> {
        Vector3::new(self.x[0], self.y[0], self.z[0])
    }

    /// Heights of a point above the plane of the facet, and inwards above those of its edges.
    #[inline(always)]
    pub(super) fn heights(&self, point: &Vector3<f64>) -> [f64; 4] {
        let mut heights = [0.0; 4];
        for (k, height) in heights.iter_mut().enumerate() {
            *height = self.x[k] * point.x + self.y[k] * point.y + self.z[k] * point.z - self.at[k];
        }
        heights
    }

    /// A lower bound of the distance of a point from the facet, which is the distance itself except beside a corner.
    #[inline(always)]
    pub(super) fn least_distance(&self, point: &Vector3<f64>) -> f64 {
        let [above, edges @ ..] = self.heights(point);
        let outside = edges.into_iter().fold(0.0, f64::min);
        (above * above + outside * outside).sqrt() * (1.0 - 10.0 * ROUNDING) - self.rounding
    }
}
