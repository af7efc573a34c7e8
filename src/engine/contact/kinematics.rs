//! Input and output of a contact law.

use nalgebra::Vector3;

/// A contact of two bodies: the first is a particle, the second another particle or a wall.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// Overlap delta; negative while a neck joins bodies whose surfaces are separated.
    pub overlap: f64,
    /// Unit vector n from the first body towards the second.
    pub normal: Vector3<f64>,
    /// Velocity of the second body's surface relative to the first's at the contact, rotation included. Its normal
    /// component v_n is positive if the bodies separate.
    pub relative_velocity: Vector3<f64>,
    /// Angular velocity of the second body less that of the first.
    pub relative_spin: Vector3<f64>,
    /// Reduced mass m* with 1/m* = 1/m_1 + 1/m_2; the particle's mass at a wall.
    pub reduced_mass: f64,
    /// Reduced radius R* with 1/R* = 1/r_1 + 1/r_2; the particle's radius at a wall.
    pub reduced_radius: f64,
    /// Reduced moment of inertia I* with 1/I* = 1/I_1 + 1/I_2, about the centres; the particle's moment of inertia at a
    /// wall.
    pub reduced_inertia: f64,
    /// Magnitude of the cohesive force at this contact that is not part of the law.
    pub cohesion: f64,
}

impl Contact {
    /// The part of a vector in the tangent plane.
    #[inline(always)]
    pub(crate) fn tangential(&self, vector: &Vector3<f64>) -> Vector3<f64> {
        vector - self.normal * self.normal.dot(vector)
    }
}

/// The force of a contact on its second body; the force on the first body is the opposite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactForce {
    /// Component along the normal; positive if it pushes the bodies apart.
    pub normal: f64,
    /// Component in the tangent plane.
    pub tangential: Vector3<f64>,
    /// Normal force to which friction is proportional, in sliding and in rolling; not negative.
    pub friction_normal: f64,
}

impl ContactForce {
    /// No force.
    pub fn zero() -> Self {
        Self { normal: 0.0, tangential: Vector3::zeros(), friction_normal: 0.0 }
    }
}
