//! Walls: planes and round columns, at rest or in a motion that is a function of time.

use super::{Bounds, BoxFace};
use crate::numbers::sine;
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Name of the wall in the lower z face, whose stress is reported.
pub const BASE_PLATE: &str = "base plate";

/// A wall of the box or of the case's own.
#[derive(Clone, Debug, PartialEq)]
pub struct Wall {
    /// How results call it: "base plate", "x lower", or the case's own name.
    pub name: String,
    /// Where it is while it is at rest.
    pub shape: WallShape,
    /// How it moves.
    pub motion: WallMotion,
}

/// The surface of a wall; particles are on one side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WallShape {
    /// An infinite plane.
    Plane {
        /// A point of it.
        point: Vector3<f64>,
        /// Unit normal, into the bed.
        normal: Vector3<f64>,
    },
    /// An infinite round column along z, with the particles inside. Contact laws see it as flat: R* = r.
    Cylinder {
        /// A point of its axis; z does not matter.
        centre: Vector3<f64>,
        /// Radius.
        radius: f64,
    },
}

/// Translation of a wall: displacement v tau + A sin(2 pi f tau) with tau the time since `start`, 0 before and what
/// it is at `end` after. A function of time alone: ranks and restarts agree on it to the last bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallMotion {
    /// v, velocity.
    pub velocity: Vector3<f64>,
    /// A, amplitude along each axis.
    pub amplitude: Vector3<f64>,
    /// f, cycles per time.
    pub frequency: f64,
    /// When it begins.
    pub start: f64,
    /// When it ends; may be infinite.
    pub end: f64,
}

/// Where a wall is, and how fast, at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallPose {
    /// From where it is at rest.
    pub displacement: Vector3<f64>,
    /// Velocity of all its points.
    pub velocity: Vector3<f64>,
}

/// Walls together with where they are at one instant.
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

    /// From where the wall is at rest, at a time.
    ///
    /// ```
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

    /// The largest speed along a direction at any time.
    pub fn largest_speed(&self, direction: &Vector3<f64>) -> f64 {
        let oscillation = 2.0 * PI * self.frequency * self.amplitude.dot(direction).abs();
        self.velocity.dot(direction).abs() + oscillation
    }

    /// Whether it ever moves.
    pub fn is_rest(&self) -> bool {
        self.velocity == Vector3::zeros() && self.amplitude == Vector3::zeros()
    }
}

impl WallPose {
    /// At rest where it stands at first.
    pub const REST: Self =
        Self { displacement: Vector3::new(0.0, 0.0, 0.0), velocity: Vector3::new(0.0, 0.0, 0.0) };
}

impl Wall {
    /// A plane at rest.
    pub fn plane(name: impl Into<String>, point: Vector3<f64>, normal: Vector3<f64>) -> Self {
        let shape = WallShape::Plane { point, normal };
        Self { name: name.into(), shape, motion: WallMotion::REST }
    }

    /// A plane at rest in a face of the box, with the name that results call it.
    pub fn in_face(bounds: &Bounds, face: BoxFace) -> Self {
        let mut point = Vector3::zeros();
        point[face.axis] = bounds.lengths()[face.axis] * face.side as f64;
        Self::plane(Self::name_in_face(face), point, face.inward_normal())
    }

    /// How results call the wall in a face: "base plate" for the lower z face, otherwise as the face.
    pub fn name_in_face(face: BoxFace) -> &'static str {
        if face == (BoxFace { axis: 2, side: 0 }) { BASE_PLATE } else { face.name() }
    }

    /// A round column along z, at rest, through a point and of a radius.
    pub fn cylinder(name: impl Into<String>, centre: Vector3<f64>, radius: f64) -> Self {
        let shape = WallShape::Cylinder { centre, radius };
        Self { name: name.into(), shape, motion: WallMotion::REST }
    }

    /// Where it is at the end of a step of this length, and how fast it was in the middle of the step: the
    /// velocities of particles are those of the half step, too.
    pub fn pose(&self, time: f64, step: f64) -> WallPose {
        WallPose {
            displacement: self.motion.displacement(time),
            velocity: self.motion.velocity_at(time - 0.5 * step),
        }
    }

    /// Height of a point above the wall where it is at rest, negative behind it.
    #[inline(always)]
    pub fn height_of(&self, position: &Vector3<f64>) -> f64 {
        self.height_at(position, &WallPose::REST)
    }

    /// Height of a point above the wall where it is now.
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
        }
    }

    /// Unit normal, into the bed, where a point is nearest; zero on the axis of a cylinder.
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
        }
    }

    /// How far a displacement can have moved the wall towards particles.
    pub fn approach(&self, displacement: &Vector3<f64>) -> f64 {
        match &self.shape {
            WallShape::Plane { normal, .. } => normal.dot(displacement).abs(),
            WallShape::Cylinder { .. } => displacement.xy().norm(),
        }
    }

    /// How much nearer to the wall a point may get by displacements up to these along each axis.
    pub fn approach_within(&self, displacements: &[f64; 3]) -> f64 {
        match &self.shape {
            WallShape::Plane { normal, .. } => {
                displacements.iter().zip(normal.iter()).map(|(d, n)| d * n.abs()).sum()
            }
            WallShape::Cylinder { .. } => {
                (displacements[0].powi(2) + displacements[1].powi(2)).sqrt()
            }
        }
    }

    /// Its largest speed towards particles at any time.
    pub fn largest_approach_speed(&self) -> f64 {
        match &self.shape {
            WallShape::Plane { normal, .. } => self.motion.largest_speed(normal),
            WallShape::Cylinder { .. } => {
                let [x, y] =
                    [Vector3::x(), Vector3::y()].map(|axis| self.motion.largest_speed(&axis));
                (x * x + y * y).sqrt()
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
        // Negative control: half a step off.
        assert!((motion.velocity_at(1.1) - motion.velocity_at(1.11)).norm() > 1.0e-3);
    }

    #[test]
    fn heights_in_a_cylinder_are_from_the_wall_inwards() {
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
