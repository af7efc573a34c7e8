//! Rotation of a wall about a fixed axis, as a function of time alone.

use super::surface::Axis;
use crate::numbers::sine;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;

/// Rotation of a wall. With the time tau since `start` the angle is omega (tau - T / 2) + A sin(2 pi f tau); during the
/// ramp, up to tau = T, its first part is omega tau^2 / (2 T), so that the speed rises linearly from 0. Before `start` tau
/// is 0, and after `end` it is constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallRotation {
    /// The axis, at rest; it moves with the translation of the wall. Positive angles turn right-handed about its direction.
    pub axis: Axis,
    /// Angular speed omega after the ramp, in radians per time.
    pub speed: f64,
    /// Duration T of the ramp.
    pub ramp: f64,
    /// Amplitude A of an oscillation, in radians.
    pub amplitude: f64,
    /// Frequency f of the oscillation in cycles per time.
    pub frequency: f64,
    /// Start of the motion.
    pub start: f64,
    /// End of the motion; may be infinite.
    pub end: f64,
}

/// Rotation of a wall at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// A point of the axis at rest.
    pub point: Vector3<f64>,
    /// Angle from the position at rest, in radians.
    pub angle: f64,
    /// The rotation from rest to now; `None` if the surface looks the same at any angle.
    pub matrix: Option<Matrix3<f64>>,
    /// Angular velocity, in radians per time.
    pub angular_velocity: Vector3<f64>,
}

impl WallRotation {
    /// The angle at a time.
    pub fn angle(&self, time: f64) -> f64 {
        let tau = time.clamp(self.start, self.end) - self.start;
        let steady = if tau < self.ramp {
            0.5 * self.speed * tau * (tau / self.ramp)
        } else {
            self.speed * (tau - 0.5 * self.ramp)
        };
        steady + self.amplitude * sine(2.0 * PI * self.frequency * tau)
    }

    /// Angular speed at a time; 0 before the start and from the end on.
    pub fn angular_speed(&self, time: f64) -> f64 {
        if time < self.start || time >= self.end {
            return 0.0;
        }
        let tau = time - self.start;
        let steady = if tau < self.ramp { self.speed * (tau / self.ramp) } else { self.speed };
        let omega = 2.0 * PI * self.frequency;
        steady + self.amplitude * omega * sine(omega * tau + 0.5 * PI)
    }

    /// The largest angular speed over all times.
    pub fn largest_speed(&self) -> f64 {
        self.speed.abs() + 2.0 * PI * self.frequency * self.amplitude.abs()
    }

    /// The rotation at the end of a step, with the angular velocity at its middle.
    pub(super) fn turn(&self, time: f64, step: f64, is_symmetric: bool) -> Turn {
        let Axis { point, direction } = self.axis;
        let angle = self.angle(time);
        Turn {
            point,
            angle,
            matrix: (!is_symmetric).then(|| rotation(&direction, angle)),
            angular_velocity: direction * self.angular_speed(time - 0.5 * step),
        }
    }
}

/// The matrix of a rotation about a unit vector k by an angle in radians: cos I + sin K + (1 - cos) k k^T, where
/// K v = k x v.
pub fn rotation(k: &Vector3<f64>, angle: f64) -> Matrix3<f64> {
    let (sine, cosine) = (sine(angle), sine(angle + 0.5 * PI));
    Matrix3::identity() * cosine + k.cross_matrix() * sine + k * k.transpose() * (1.0 - cosine)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROTATION: WallRotation = WallRotation {
        axis: Axis { point: Vector3::new(1.0, 2.0, 3.0), direction: Vector3::new(0.0, 0.6, 0.8) },
        speed: 0.7,
        ramp: 0.4,
        amplitude: 0.2,
        frequency: 1.3,
        start: 0.5,
        end: 3.0,
    };

    #[test]
    fn angular_speed_is_the_slope_of_the_angle() {
        for time in [0.2, 0.6, 0.85, 1.1, 2.9, 3.5] {
            let h = 1.0e-4;
            let slope = (ROTATION.angle(time + h) - ROTATION.angle(time - h)) / (2.0 * h);
            // Central differences: A omega^3 h^2 / 6, and rounding of the angles.
            let allowed = 0.2 * (2.0 * PI * 1.3).powi(3) * h * h / 6.0 + 1.0e-11;
            let error = (slope - ROTATION.angular_speed(time)).abs();
            assert!(error < allowed, "{time}: {error}");
        }
        // Negative control: without the ramp.
        let sudden = WallRotation { ramp: 0.0, ..ROTATION };
        assert!((sudden.angular_speed(0.6) - ROTATION.angular_speed(0.6)).abs() > 0.1);
    }

    #[test]
    fn the_matrix_turns_right_handed_about_the_axis() {
        let turned = rotation(&Vector3::z(), 0.3) * Vector3::x();
        assert!((turned - Vector3::new(0.3_f64.cos(), 0.3_f64.sin(), 0.0)).norm() < 1.0e-15);
        let k = ROTATION.axis.direction;
        let matrix = rotation(&k, 1.1);
        assert!((matrix * k - k).norm() < 1.0e-15);
        assert!((matrix * matrix.transpose() - Matrix3::identity()).norm() < 1.0e-15);
    }
}
