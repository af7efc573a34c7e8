//! Walls: planes, cylinders and surfaces of limited extent, at rest or in a motion that is a function of time.

mod from_surface;
mod mesh;
mod rotation;
mod surface;

pub use self::from_surface::FromSurface;
pub use self::mesh::{Edge, Facet, Feature, Mesh, MeshError, NearestOnFacet, join_vertices};
pub use self::rotation::{Turn, WallRotation, rotation};
pub use self::surface::{Axis, Bend, Surface};

use super::{Bounds, BoxFace};
use crate::numbers::sine;
use nalgebra::{Vector2, Vector3};
use std::f64::consts::PI;

/// The face of the base plate, whose stress is reported, and its name in results.
const BASE_PLATE: (BoxFace, &str) = (BoxFace { axis: 2, side: 0 }, "base plate");

/// A wall in a face of the box, or one that the case defines.
#[derive(Clone, Debug, PartialEq)]
pub struct Wall {
    /// Its name in results: "base plate", "x lower", or the name given in the case.
    pub name: String,
    /// The face of the box in which it lies; `None` for a wall defined by the case, wherever it is.
    pub face: Option<BoxFace>,
    /// Its surface while it is at rest.
    pub shape: WallShape,
    /// Its translation.
    pub motion: WallMotion,
    /// Its rotation, if it turns.
    pub rotation: Option<WallRotation>,
    /// Where the initial bed may lie.
    pub side: Side,
}

/// The part of the box in which the particles of an initial bed may lie, as seen from a wall of limited extent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// On both sides.
    #[default]
    Both,
    /// In the room that the wall surrounds, or that another wall with this side surrounds.
    Inside,
    /// Outside of the room that the wall surrounds.
    Outside,
}

/// The surface of a wall. The particles are on one side of it.
#[derive(Clone, Debug, PartialEq)]
pub enum WallShape {
    /// An infinite plane.
    Plane {
        /// A point of the plane.
        point: Vector3<f64>,
        /// Unit normal, towards the particles.
        normal: Vector3<f64>,
    },
    /// An infinite cylinder along z, with the particles inside. In contact laws its curvature is neglected: R* = r.
    Cylinder {
        /// A point of the axis; its z is not used.
        centre: Vector3<f64>,
        /// Radius.
        radius: f64,
    },
    /// A thin surface of limited extent, with particles on both sides. In contact laws its curvature is neglected.
    Limited(Surface),
}

/// Translation of a wall: the displacement is v tau + A sin(2 pi f tau). tau is the time since `start`; before it tau
/// is 0, and after `end` it is constant. The motion depends on time alone, so that it has the same bits on all ranks
/// and after any restart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallMotion {
    /// Velocity v.
    pub velocity: Vector3<f64>,
    /// Amplitude A along each axis.
    pub amplitude: Vector3<f64>,
    /// Frequency f in cycles per time.
    pub frequency: f64,
    /// Start of the motion.
    pub start: f64,
    /// End of the motion; may be infinite.
    pub end: f64,
}

/// Displacement and velocity of a wall at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallPose {
    /// Displacement from the position at rest.
    pub displacement: Vector3<f64>,
    /// Velocity of all its points, besides their rotation.
    pub velocity: Vector3<f64>,
    /// Its rotation, if it turns.
    pub turn: Option<Turn>,
}

/// Walls with their poses at one instant.
#[derive(Clone, Copy, Debug)]
pub struct PosedWalls<'a> {
    /// The walls.
    pub walls: &'a [Wall],
    /// The pose of each wall, in the same order.
    pub poses: &'a [WallPose],
}

impl<'a> PosedWalls<'a> {
    /// Each wall with its pose, in order.
    pub fn iter(&self) -> impl Iterator<Item = (&'a Wall, &'a WallPose)> + use<'a> {
        self.walls.iter().zip(self.poses)
    }
}

impl WallMotion {
    /// No motion.
    pub const REST: Self = Self {
        velocity: Vector3::new(0.0, 0.0, 0.0),
        amplitude: Vector3::new(0.0, 0.0, 0.0),
        frequency: 0.0,
        start: 0.0,
        end: f64::INFINITY,
    };

    /// Displacement from the position at rest, at a time.
    ///
    /// ```
    /// # use talcum_engine as talcum;
    /// use nalgebra::Vector3;
    /// use talcum::domain::WallMotion;
    /// let amplitude = Vector3::new(0.0, 0.0, 0.1);
    /// let shaken = WallMotion { amplitude, frequency: 0.25, start: 8.0, ..WallMotion::REST };
    /// assert_eq!(shaken.displacement(7.0).z, 0.0);
    /// assert_eq!(shaken.displacement(9.0).z, 0.1); // a quarter of a period later
    /// ```
    pub fn displacement(&self, time: f64) -> Vector3<f64> {
        let tau = time.clamp(self.start, self.end) - self.start;
        self.velocity * tau + self.amplitude * sine(2.0 * PI * self.frequency * tau)
    }

    /// Velocity at a time; 0 before the start and from the end on.
    pub fn velocity_at(&self, time: f64) -> Vector3<f64> {
        if time < self.start || time >= self.end {
            return Vector3::zeros();
        }
        let omega = 2.0 * PI * self.frequency;
        let cosine = sine(omega * (time - self.start) + 0.5 * PI);
        self.velocity + self.amplitude * (omega * cosine)
    }

    /// The largest speed along a direction over all times.
    pub fn largest_speed(&self, direction: &Vector3<f64>) -> f64 {
        let oscillation = 2.0 * PI * self.frequency * self.amplitude.dot(direction).abs();
        self.velocity.dot(direction).abs() + oscillation
    }

    /// Whether the wall never moves.
    pub fn is_rest(&self) -> bool {
        self.velocity == Vector3::zeros() && self.amplitude == Vector3::zeros()
    }
}

impl WallPose {
    /// At rest in the initial position.
    pub const REST: Self = Self {
        displacement: Vector3::new(0.0, 0.0, 0.0),
        velocity: Vector3::new(0.0, 0.0, 0.0),
        turn: None,
    };

    /// Angular velocity of the wall, in radians per time.
    pub fn angular_velocity(&self) -> Vector3<f64> {
        self.turn.map_or(Vector3::zeros(), |turn| turn.angular_velocity)
    }

    /// Velocity of the wall at a point.
    pub fn velocity_at(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let Some(Turn { point: centre, angular_velocity, .. }) = &self.turn else {
            return self.velocity;
        };
        self.velocity + angular_velocity.cross(&(point - (centre + self.displacement)))
    }

    /// The place of a point relative to the wall, as if the wall were at rest.
    pub fn seen_at_rest(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let point = point - self.displacement;
        match &self.turn {
            Some(Turn { point: centre, matrix: Some(matrix), .. }) => {
                centre + matrix.tr_mul(&(point - centre))
            }
            _ => point,
        }
    }

    /// A direction that moves with the wall, in this pose.
    fn turned(&self, direction: Vector3<f64>) -> Vector3<f64> {
        match &self.turn {
            Some(Turn { matrix: Some(matrix), .. }) => matrix * direction,
            _ => direction,
        }
    }

    /// Distance and direction of a point from a surface in this pose.
    fn nearest(&self, surface: &Surface, point: &Vector3<f64>) -> FromSurface {
        let found = surface.nearest(&self.seen_at_rest(point));
        FromSurface { direction: self.turned(found.direction), ..found }
    }

    /// Distance and direction of a point from one facet of a mesh in this pose, and where on the facet the nearest point
    /// lies.
    pub fn nearest_on(&self, mesh: &Mesh, point: &Vector3<f64>, facet: u32) -> NearestOnFacet {
        let NearestOnFacet { from, feature } = mesh.nearest_on(&self.seen_at_rest(point), facet);
        let direction = self.turned(from.direction);
        NearestOnFacet { from: FromSurface { direction, ..from }, feature }
    }
}

impl Wall {
    /// A plane at rest.
    pub fn plane(name: impl Into<String>, point: Vector3<f64>, normal: Vector3<f64>) -> Self {
        Self::of_shape(name, WallShape::Plane { point, normal })
    }

    /// A wall at rest, with particles on both sides if it is of limited extent.
    pub fn of_shape(name: impl Into<String>, shape: WallShape) -> Self {
        let (motion, rotation, side) = (WallMotion::REST, None, Side::Both);
        Self { name: name.into(), face: None, shape, motion, rotation, side }
    }

    /// A plane at rest in a face of the box.
    pub fn in_face(bounds: &Bounds, face: BoxFace) -> Self {
        let mut point = Vector3::zeros();
        point[face.axis] = bounds.lengths()[face.axis] * face.side as f64;
        let name = if face == BASE_PLATE.0 { BASE_PLATE.1 } else { face.name() };
        Self { face: Some(face), ..Self::plane(name, point, face.inward_normal()) }
    }

    /// Whether it is the base plate: the wall in the lower z face of the box, even if another wall has this name.
    pub fn is_base_plate(&self) -> bool {
        self.face == Some(BASE_PLATE.0)
    }

    /// A cylinder along z at rest, given by a point of its axis and its radius.
    pub fn cylinder(name: impl Into<String>, centre: Vector3<f64>, radius: f64) -> Self {
        Self::of_shape(name, WallShape::Cylinder { centre, radius })
    }

    /// Whether it is a round column: a cylinder along z without ends.
    pub fn is_round(&self) -> bool {
        matches!(self.shape, WallShape::Cylinder { .. })
    }

    /// Its displacement at the end of a step of this length, and its velocity at the middle of the step: the velocities
    /// of particles are also taken at the half step.
    pub fn pose(&self, time: f64, step: f64) -> WallPose {
        WallPose {
            displacement: self.motion.displacement(time),
            velocity: self.motion.velocity_at(time - 0.5 * step),
            turn: self.rotation.map(|it| it.turn(time, step, self.is_symmetric_about(&it.axis))),
        }
    }

    /// Whether a rotation about an axis leaves the wall where it is.
    pub fn is_symmetric_about(&self, axis: &Axis) -> bool {
        match &self.shape {
            WallShape::Plane { normal, .. } => normal.cross(&axis.direction) == Vector3::zeros(),
            WallShape::Cylinder { centre, .. } => {
                axis.direction.xy() == Vector2::zeros() && axis.point.xy() == centre.xy()
            }
            WallShape::Limited(surface) => surface.is_symmetric_about(axis),
        }
    }

    /// Whether a point lies in the room that the wall at rest surrounds; walls without limits surround none.
    pub fn surrounds(&self, point: &Vector3<f64>) -> bool {
        matches!(&self.shape, WallShape::Limited(surface) if surface.surrounds(point))
    }

    /// Distance of a point from the wall at rest, negative behind it.
    #[inline(always)]
    pub fn height_of(&self, position: &Vector3<f64>) -> f64 {
        self.height_at(position, &WallPose::REST)
    }

    /// Distance of a point from the wall in its present pose, negative behind it.
    #[inline(always)]
    pub fn height_at(&self, position: &Vector3<f64>, pose: &WallPose) -> f64 {
        match &self.shape {
            WallShape::Plane { point, normal } => {
                normal.dot(&(position - (point + pose.displacement)))
            }
            WallShape::Cylinder { centre, radius } => {
                let out = position - (centre + pose.displacement);
                radius - (out.x * out.x + out.y * out.y).sqrt()
            }
            WallShape::Limited(surface) => pose.nearest(surface, position).distance,
        }
    }

    /// Unit normal, towards the particles, at the point of the wall nearest to a position; zero on the axis of a
    /// cylinder.
    #[inline(always)]
    pub fn normal_at(&self, position: &Vector3<f64>, pose: &WallPose) -> Vector3<f64> {
        match &self.shape {
            WallShape::Plane { normal, .. } => *normal,
            WallShape::Cylinder { centre, .. } => {
                let out = position - (centre + pose.displacement);
                let distance = (out.x * out.x + out.y * out.y).sqrt();
                let per = if distance > 0.0 { 1.0 / distance } else { 0.0 };
                Vector3::new(-out.x * per, -out.y * per, 0.0)
            }
            WallShape::Limited(surface) => pose.nearest(surface, position).direction,
        }
    }

    /// Distance of a point from the wall, and the unit normal there, as by [`Wall::height_at`] and [`Wall::normal_at`];
    /// for a mesh, from this facet of it.
    #[inline(always)]
    pub fn height_and_normal(
        &self,
        position: &Vector3<f64>,
        pose: &WallPose,
        facet: u32,
    ) -> (f64, Vector3<f64>) {
        let FromSurface { distance, direction } = match &self.shape {
            WallShape::Plane { .. } | WallShape::Cylinder { .. } => {
                return (self.height_at(position, pose), self.normal_at(position, pose));
            }
            WallShape::Limited(Surface::Mesh(mesh)) => pose.nearest_on(mesh, position, facet).from,
            WallShape::Limited(surface) => pose.nearest(surface, position),
        };
        (distance, direction)
    }

    /// The facets of a mesh; `None` for other walls.
    pub fn mesh(&self) -> Option<&Mesh> {
        if let WallShape::Limited(surface) = &self.shape { surface.mesh() } else { None }
    }

    /// Largest distance by which the wall can have moved towards particles from one pose to another.
    pub fn approach(&self, then: &WallPose, now: &WallPose) -> f64 {
        let displacement = now.displacement - then.displacement;
        let translation = match &self.shape {
            WallShape::Plane { normal, .. } => normal.dot(&displacement).abs(),
            WallShape::Cylinder { .. } => displacement.xy().norm(),
            WallShape::Limited(_) => displacement.norm(),
        };
        match (&then.turn, &now.turn) {
            (Some(then), Some(now)) if now.matrix.is_some() => {
                translation + (now.angle - then.angle).abs() * self.reach()
            }
            _ => translation,
        }
    }

    /// Largest distance of a point of the wall from the axis of its rotation; 0 if it does not turn, or if its surface
    /// stays where it is as it turns.
    fn reach(&self) -> f64 {
        match (&self.rotation, &self.shape) {
            (Some(WallRotation { axis, .. }), WallShape::Limited(surface))
                if !surface.is_symmetric_about(axis) =>
            {
                let (centre, radius) = surface.hull();
                axis.direction.cross(&(centre - axis.point)).norm() + radius
            }
            _ => 0.0,
        }
    }

    /// The largest decrease of the distance to the wall by displacements of at most these magnitudes along each axis.
    pub fn approach_within(&self, displacements: &[f64; 3]) -> f64 {
        match &self.shape {
            WallShape::Plane { normal, .. } => {
                displacements.iter().zip(normal.iter()).map(|(d, n)| d * n.abs()).sum()
            }
            WallShape::Cylinder { .. } => {
                (displacements[0].powi(2) + displacements[1].powi(2)).sqrt()
            }
            WallShape::Limited(_) => Vector3::from(*displacements).norm(),
        }
    }

    /// The largest speed towards particles over all times.
    pub fn largest_approach_speed(&self) -> f64 {
        match &self.shape {
            WallShape::Plane { normal, .. } => self.motion.largest_speed(normal),
            WallShape::Cylinder { .. } => {
                let [x, y] =
                    [Vector3::x(), Vector3::y()].map(|axis| self.motion.largest_speed(&axis));
                (x * x + y * y).sqrt()
            }
            WallShape::Limited(_) => {
                let along = |axis: usize| self.motion.largest_speed(&Vector3::ith(axis, 1.0));
                let turning = self.rotation.map_or(0.0, |rotation| rotation.largest_speed());
                Vector3::new(along(0), along(1), along(2)).norm() + turning * self.reach()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn velocity_is_the_slope_of_displacement() {
        let motion = WallMotion {
            velocity: Vector3::new(0.3, 0.0, -0.1),
            amplitude: Vector3::new(0.0, 0.2, 0.1),
            frequency: 1.7,
            start: 0.5,
            end: 3.0,
        };
        for time in [0.2, 0.6, 1.1, 2.9, 3.5] {
            let h = 1.0e-4;
            let slope = (motion.displacement(time + h) - motion.displacement(time - h)) / (2.0 * h);
            // Central differences: A omega^3 h^2 / 6.
            let error = (slope - motion.velocity_at(time)).norm();
            assert!(
                error < 0.3 * (2.0 * PI * 1.7).powi(3) * h * h / 6.0 + 1.0e-11,
                "{time}: {error}"
            );
        }
        // Negative control: a time off by half a step.
        assert!((motion.velocity_at(1.1) - motion.velocity_at(1.11)).norm() > 1.0e-3);
    }

    #[test]
    fn heights_in_a_cylinder_are_measured_inwards_from_the_wall() {
        let column = Wall::cylinder("column", Vector3::new(1.0, 2.0, 0.0), 5.0);
        let position = Vector3::new(4.0, 6.0, -7.0);
        assert_eq!(column.height_of(&position), 0.0);
        let normal = column.normal_at(&position, &WallPose::REST);
        assert!((normal - Vector3::new(-0.6, -0.8, 0.0)).norm() < 1.0e-15, "{normal}"); // one rounding each
        let pose = WallPose { displacement: Vector3::new(3.0, 4.0, 1.0), ..WallPose::REST };
        assert_eq!(column.height_at(&position, &pose), 5.0);
        assert_eq!(column.normal_at(&position, &pose), Vector3::zeros());
    }
}
