//! Thin surfaces of limited extent: rectangles, discs, cylinders, cones, spheres, bends of pipes and meshes. Particles
//! may touch them from both sides, and at their edges.

use super::from_surface::FromSurface;
use super::mesh::Mesh;
use nalgebra::{Vector2, Vector3};
use std::f64::consts::PI;
use std::sync::Arc;

/// A thin surface of limited extent.
#[derive(Clone, Debug, PartialEq)]
pub enum Surface {
    /// A flat rectangle.
    Rectangle {
        /// Its middle.
        centre: Vector3<f64>,
        /// The vectors from the middle to the middles of two edges, perpendicular to each other.
        half_edges: [Vector3<f64>; 2],
    },
    /// A line that is revolved about an axis: a disc, a ring, a cylinder, a cone or a frustum.
    Revolved {
        /// The axis.
        axis: Axis,
        /// The ends of the line: distance along the axis from its point, and distance from the axis.
        ends: [Vector2<f64>; 2],
    },
    /// A sphere.
    Sphere {
        /// Its centre.
        centre: Vector3<f64>,
        /// Its radius.
        radius: f64,
    },
    /// The bend of a round pipe: a part of a torus.
    Bend(Bend),
    /// A surface of triangles.
    Mesh(Arc<Mesh>),
}

/// A straight line in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// A point of it.
    pub point: Vector3<f64>,
    /// Its direction, a unit vector.
    pub direction: Vector3<f64>,
}

/// The bend of a round pipe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bend {
    /// The centre about which the pipe bends.
    pub centre: Vector3<f64>,
    /// Unit vector from the centre to the middle of the pipe where the bend begins.
    pub start: Vector3<f64>,
    /// Unit vector along the pipe where the bend begins, perpendicular to `start`.
    pub onwards: Vector3<f64>,
    /// Distance of the middle of the pipe from the centre.
    pub bend_radius: f64,
    /// Radius of the pipe.
    pub radius: f64,
    /// Angle of the bend, in radians, at most 2 pi.
    pub angle: f64,
}

impl Axis {
    /// Distance of a point along the axis, and its distance from the axis with the unit vector away from the axis.
    fn coordinates(&self, point: &Vector3<f64>) -> (Vector2<f64>, Vector3<f64>) {
        let arm = point - self.point;
        let along = self.direction.dot(&arm);
        let out = arm - self.direction * along;
        let distance = out.norm();
        let outwards =
            if distance > 0.0 { out / distance } else { perpendicular_to(&self.direction) };
        (Vector2::new(along, distance), outwards)
    }

    /// Whether a point lies on the axis, up to a part of a length.
    fn passes(&self, point: &Vector3<f64>, length: f64) -> bool {
        let (coordinates, _) = self.coordinates(point);
        coordinates.y <= ROUNDING * length
    }

    /// Whether another axis is the same line, up to a part of a length.
    fn is_along(&self, other: &Self, length: f64) -> bool {
        self.direction.cross(&other.direction).norm() <= ROUNDING
            && self.passes(&other.point, length)
    }
}

/// What decimal input loses: two lines that differ by this part of a length are the same.
const ROUNDING: f64 = 1.0e-9;

/// A unit vector that is perpendicular to a unit vector.
fn perpendicular_to(direction: &Vector3<f64>) -> Vector3<f64> {
    let other = if direction.x.abs() < 0.7 { Vector3::x() } else { Vector3::y() };
    direction.cross(&other).normalize()
}

impl Surface {
    /// Distance and direction of a point from the surface.
    pub fn nearest(&self, point: &Vector3<f64>) -> FromSurface {
        match self {
            Self::Rectangle { centre, half_edges } => from_rectangle(&(point - centre), half_edges),
            Self::Revolved { axis, ends } => {
                let (coordinates, outwards) = axis.coordinates(point);
                let (distance, [along, out]) = from_line(&coordinates, ends);
                FromSurface { distance, direction: axis.direction * along + outwards * out }
            }
            Self::Sphere { centre, radius } => {
                let arm = point - centre;
                let distance = arm.norm();
                let outwards = if distance > 0.0 { arm / distance } else { Vector3::zeros() };
                FromSurface::above(distance - radius, outwards)
            }
            Self::Bend(bend) => bend.nearest(point),
            Self::Mesh(mesh) => mesh.nearest(point),
        }
    }

    /// The facets of a mesh; `None` for other surfaces.
    pub fn mesh(&self) -> Option<&Mesh> {
        if let Self::Mesh(mesh) = self { Some(mesh) } else { None }
    }

    /// Whether a point lies in the room that the surface surrounds: inside a cylinder or cone and between its ends, in a
    /// sphere, in a bend of a pipe, in a closed mesh. Rectangles and discs surround none.
    pub fn surrounds(&self, point: &Vector3<f64>) -> bool {
        match self {
            Self::Rectangle { .. } => false,
            Self::Revolved { axis, ends: [first, last] } => {
                let (coordinates, _) = axis.coordinates(point);
                let part = (coordinates.x - first.x) / (last.x - first.x);
                let radius = first.y + part * (last.y - first.y);
                (0.0..=1.0).contains(&part) && coordinates.y < radius
            }
            Self::Sphere { centre, radius } => (point - centre).norm() < *radius,
            Self::Bend(bend) => bend.surrounds(point),
            Self::Mesh(mesh) => mesh.surrounds(point),
        }
    }

    /// A sphere that holds the surface: its centre and its radius.
    pub fn hull(&self) -> (Vector3<f64>, f64) {
        match self {
            Self::Rectangle { centre, half_edges: [one, other] } => (*centre, (one + other).norm()),
            Self::Revolved { axis, ends: [first, last] } => {
                let middle = 0.5 * (first.x + last.x);
                let reach = |end: &Vector2<f64>| (end.x - middle).hypot(end.y);
                (axis.point + axis.direction * middle, reach(first).max(reach(last)))
            }
            Self::Sphere { centre, radius } => (*centre, *radius),
            Self::Bend(bend) => (bend.centre, bend.bend_radius + bend.radius),
            Self::Mesh(mesh) => {
                let [lower, upper] = mesh.extent();
                (0.5 * (lower + upper), 0.5 * (upper - lower).norm())
            }
        }
    }

    /// Whether a rotation about an axis leaves the surface where it is.
    pub fn is_symmetric_about(&self, axis: &Axis) -> bool {
        let (_, size) = self.hull();
        match self {
            Self::Rectangle { .. } | Self::Bend(_) | Self::Mesh(_) => false,
            Self::Revolved { axis: own, .. } => own.is_along(axis, size),
            Self::Sphere { centre, .. } => axis.passes(centre, size),
        }
    }

    /// The axis about which it turns if no other is given.
    pub fn own_axis(&self) -> Option<Axis> {
        match self {
            Self::Revolved { axis, .. } => Some(*axis),
            Self::Rectangle { .. } | Self::Sphere { .. } | Self::Bend(_) | Self::Mesh(_) => None,
        }
    }

    /// The range that it covers along an axis of the box if it is the same everywhere in this range: a cylinder or a
    /// rectangle that is parallel to the axis.
    pub fn uniform_range(&self, axis: usize) -> Option<[f64; 2]> {
        let range = |middle: f64, half: f64| [middle - half.abs(), middle + half.abs()];
        match self {
            Self::Rectangle { centre, half_edges: [one, other] } => {
                let is_along = |edge: &&Vector3<f64>| edge[axis].abs() == edge.norm();
                let edge = [one, other].into_iter().find(is_along)?;
                Some(range(centre[axis], edge[axis]))
            }
            Self::Revolved { axis: own, ends: [first, last] } => {
                let direction = own.direction[axis];
                let middle = own.point[axis] + 0.5 * (first.x + last.x) * direction;
                (direction.abs() == 1.0 && first.y == last.y)
                    .then(|| range(middle, 0.5 * (last.x - first.x)))
            }
            Self::Sphere { .. } | Self::Bend(_) | Self::Mesh(_) => None,
        }
    }
}

/// Distance and direction from a rectangle about the origin.
fn from_rectangle(arm: &Vector3<f64>, half_edges: &[Vector3<f64>; 2]) -> FromSurface {
    let parts = half_edges.map(|edge| arm.dot(&edge) / edge.norm_squared());
    if parts.iter().all(|part| part.abs() <= 1.0) {
        let normal = half_edges[0].cross(&half_edges[1]).normalize();
        return FromSurface::above(normal.dot(arm), normal);
    }
    let [one, other] = [0, 1].map(|k| half_edges[k] * parts[k].clamp(-1.0, 1.0));
    FromSurface::at(arm - one - other)
}

/// Distance of a point from a line between two ends in a plane, and the components of the unit vector away from it.
fn from_line(point: &Vector2<f64>, [first, last]: &[Vector2<f64>; 2]) -> (f64, [f64; 2]) {
    let line = last - first;
    let arm = point - first;
    let part = arm.dot(&line) / line.norm_squared();
    if (0.0..=1.0).contains(&part) {
        let normal = Vector2::new(-line.y, line.x) / line.norm();
        let height = normal.dot(&arm);
        return (height.abs(), [normal.x * height.signum(), normal.y * height.signum()]);
    }
    let arm = if part < 0.0 { arm } else { point - last };
    let distance = arm.norm();
    (distance, [arm.x / distance, arm.y / distance])
}

impl Bend {
    /// The direction from the centre to the middle of the pipe at an angle, and the direction along the pipe there.
    fn directions(&self, [sine, cosine]: [f64; 2]) -> [Vector3<f64>; 2] {
        let outwards = self.start * cosine + self.onwards * sine;
        [outwards, self.onwards * cosine - self.start * sine]
    }

    /// Sine and cosine of the angle of a point about the centre, and whether it is an angle of the bend.
    fn angle_of(&self, arm: &Vector3<f64>) -> ([f64; 2], bool) {
        let (x, y) = (arm.dot(&self.start), arm.dot(&self.onwards));
        let distance = (x * x + y * y).sqrt();
        let angle = libm::atan2(y, x);
        let angle = if angle < 0.0 { angle + 2.0 * PI } else { angle };
        let direction = if distance > 0.0 { [y / distance, x / distance] } else { [0.0, 1.0] };
        (direction, angle <= self.angle)
    }

    fn nearest(&self, point: &Vector3<f64>) -> FromSurface {
        let arm = point - self.centre;
        let (direction, is_of_bend) = self.angle_of(&arm);
        if is_of_bend {
            let [outwards, _] = self.directions(direction);
            let out = arm - outwards * self.bend_radius;
            let distance = out.norm();
            let normal = if distance > 0.0 { out / distance } else { Vector3::zeros() };
            return FromSurface::above(distance - self.radius, normal);
        }
        let [first, last] = [0.0, self.angle]
            .map(|angle| self.nearest_of_rim(&arm, [libm::sin(angle), libm::cos(angle)]));
        if last.distance < first.distance { last } else { first }
    }

    /// Distance and direction from the rim of the pipe at one end.
    fn nearest_of_rim(&self, arm: &Vector3<f64>, angle: [f64; 2]) -> FromSurface {
        let [outwards, onwards] = self.directions(angle);
        let arm = arm - outwards * self.bend_radius;
        let beyond = onwards * onwards.dot(&arm);
        let in_plane = arm - beyond;
        let distance = in_plane.norm();
        let direction = if distance > 0.0 { in_plane / distance } else { outwards };
        FromSurface::at(beyond + direction * (distance - self.radius))
    }

    fn surrounds(&self, point: &Vector3<f64>) -> bool {
        let arm = point - self.centre;
        let (direction, is_of_bend) = self.angle_of(&arm);
        let [outwards, _] = self.directions(direction);
        is_of_bend && (arm - outwards * self.bend_radius).norm() < self.radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surfaces() -> Vec<Surface> {
        let direction = Vector3::new(1.0, 2.0, -2.0) / 3.0;
        let axis = Axis { point: Vector3::new(0.3, -0.2, 0.1), direction };
        let across = perpendicular_to(&direction);
        let revolved =
            |ends: [[f64; 2]; 2]| Surface::Revolved { axis, ends: ends.map(Vector2::from) };
        let bend = Bend {
            centre: axis.point,
            start: across,
            onwards: direction.cross(&across),
            bend_radius: 2.0,
            radius: 0.6,
            angle: 1.7,
        };
        vec![
            Surface::Rectangle { centre: axis.point, half_edges: [direction * 0.7, across * 1.2] },
            revolved([[0.5, 0.0], [0.5, 1.3]]),  // a disc
            revolved([[0.5, 0.4], [0.5, 1.3]]),  // a ring
            revolved([[-1.0, 0.8], [1.4, 0.8]]), // a cylinder
            revolved([[-1.0, 0.0], [1.4, 0.8]]), // a cone
            revolved([[-1.0, 1.2], [1.4, 0.4]]), // a frustum
            Surface::Sphere { centre: axis.point, radius: 0.9 },
            Surface::Bend(bend),
        ]
    }

    /// Points that fill the surface, on a grid of its two parameters.
    fn points_of(surface: &Surface) -> Vec<Vector3<f64>> {
        const COUNT: usize = 240;
        let parts = || (0..=COUNT).map(|k| k as f64 / COUNT as f64);
        let place = |u: f64, v: f64| match surface {
            Surface::Rectangle { centre, half_edges: [one, other] } => {
                centre + one * (2.0 * u - 1.0) + other * (2.0 * v - 1.0)
            }
            Surface::Revolved { axis, ends: [first, last] } => {
                let at = first + (last - first) * u;
                let across = perpendicular_to(&axis.direction);
                let other = axis.direction.cross(&across);
                let (sine, cosine) = (2.0 * PI * v).sin_cos();
                axis.point + axis.direction * at.x + (across * cosine + other * sine) * at.y
            }
            Surface::Sphere { centre, radius } => {
                let (sine, cosine) = (2.0 * PI * v).sin_cos();
                let (ring, height) = (PI * u).sin_cos();
                centre + Vector3::new(ring * cosine, ring * sine, height) * *radius
            }
            Surface::Bend(bend) => {
                let angle = bend.angle * u;
                let [outwards, _] = bend.directions([angle.sin(), angle.cos()]);
                let (sine, cosine) = (2.0 * PI * v).sin_cos();
                let normal = bend.start.cross(&bend.onwards);
                bend.centre
                    + outwards * (bend.bend_radius + bend.radius * cosine)
                    + normal * (bend.radius * sine)
            }
            Surface::Mesh(_) => unreachable!("meshes have tests of their own"),
        };
        parts().flat_map(|u| parts().map(move |v| place(u, v))).collect()
    }

    fn probes() -> impl Iterator<Item = Vector3<f64>> {
        let places = [-2.9, -1.3, -0.4, 0.21, 1.1, 2.3];
        places.into_iter().flat_map(move |x| {
            places
                .into_iter()
                .flat_map(move |y| places.into_iter().map(move |z| Vector3::new(x, y, z)))
        })
    }

    #[test]
    fn distances_are_those_of_the_nearest_of_many_points() {
        for surface in surfaces() {
            let points = points_of(&surface);
            for probe in probes() {
                let found = surface.nearest(&probe);
                let nearest =
                    points.iter().map(|point| (probe - point).norm()).fold(f64::INFINITY, f64::min);
                // Points lie up to 0.04 apart: at a distance D the nearest of them is 0.02^2 / 2 D farther, at most 0.02.
                let excess = nearest - found.distance;
                assert!((-1.0e-12..0.02).contains(&excess), "{surface:?} at {probe}: {excess}");
                assert!((found.direction.norm() - 1.0).abs() < 1.0e-12, "{surface:?}");
            }
        }
    }

    #[test]
    fn directions_point_from_the_surface() {
        for surface in surfaces() {
            let mut misses = 0;
            for probe in probes() {
                let found = surface.nearest(&probe);
                let at = |way: f64| surface.nearest(&(probe + found.direction * way)).distance;
                let foot = at(-found.distance);
                assert!(foot < 1.0e-12, "rounding of some sums: {surface:?} at {probe}: {foot}");
                misses += usize::from(at(found.distance) > 0.5 * found.distance);
            }
            // Negative control: the other way leads away from the surface, except inside it.
            assert!(misses > 150, "{surface:?}: {misses} of 216");
        }
    }

    #[test]
    fn hulls_hold_all_points() {
        for surface in surfaces() {
            let (centre, radius) = surface.hull();
            let farthest =
                points_of(&surface).iter().map(|point| (point - centre).norm()).fold(0.0, f64::max);
            assert!(farthest <= radius * (1.0 + 1.0e-12), "{surface:?}: {farthest}");
        }
    }

    #[test]
    fn rooms_are_surrounded_by_closed_shapes() {
        let [_, disc, _, cylinder, cone, _, sphere, bend] = &surfaces()[..] else { panic!() };
        let axis = cylinder.own_axis().unwrap();
        let inside = axis.point + axis.direction * 1.2;
        assert!(cylinder.surrounds(&inside) && cone.surrounds(&inside) && !disc.surrounds(&inside));
        assert!(!cylinder.surrounds(&(axis.point + axis.direction * 1.5)), "beyond its end");
        let narrow = axis.point - axis.direction * 0.5 + perpendicular_to(&axis.direction) * 0.3;
        assert!(cylinder.surrounds(&narrow) && !cone.surrounds(&narrow));
        assert!(sphere.surrounds(&axis.point) && !sphere.surrounds(&inside));
        let Surface::Bend(pipe) = bend else { panic!() };
        let in_pipe = |angle: f64| {
            pipe.centre + pipe.directions([angle.sin(), angle.cos()])[0] * pipe.bend_radius
        };
        assert!(bend.surrounds(&in_pipe(1.6)) && !bend.surrounds(&in_pipe(1.8)));
    }

    #[test]
    fn a_rectangle_has_the_distances_of_its_plane_to_the_bit() {
        let half_edges = [Vector3::new(2.5, 0.0, 0.0), Vector3::new(0.0, 1.5, 0.0)];
        let centre = Vector3::new(0.1, 0.7, 0.3);
        let rectangle = Surface::Rectangle { centre, half_edges };
        let point = Vector3::new(-1.3, 1.9, 0.83);
        let found = rectangle.nearest(&point);
        assert_eq!((found.distance, found.direction), (point.z - centre.z, Vector3::z()));
    }

    #[test]
    fn symmetry_is_that_of_the_axis() {
        let [rectangle, disc, .., sphere, _] = &surfaces()[..] else { panic!() };
        let axis = disc.own_axis().unwrap();
        let opposite = Axis { direction: -axis.direction, ..axis };
        let shifted = Axis { point: axis.point + Vector3::new(1.0e-3, 0.0, 0.0), ..axis };
        let tilted = Axis { direction: Vector3::z(), ..axis };
        assert!(disc.is_symmetric_about(&opposite) && !disc.is_symmetric_about(&shifted));
        assert!(sphere.is_symmetric_about(&tilted) && !disc.is_symmetric_about(&tilted));
        assert!(!rectangle.is_symmetric_about(&axis));
    }
}
