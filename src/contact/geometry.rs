//! Two touching bodies as a contact law sees them.

use nalgebra::Vector3;

/// A contact: the first body, a particle; the second, another particle or a wall.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// Depth of interpenetration; negative while a neck joins bodies that are apart.
    pub overlap: f64,
    /// Unit vector from the first body towards the second.
    pub normal: Vector3<f64>,
    /// Velocity of the second body's surface relative to the first's at the contact, rotation included.
    pub relative_velocity: Vector3<f64>,
    /// Angular velocity of the second body less that of the first.
    pub relative_spin: Vector3<f64>,
    /// m* with 1/m* = 1/m_1 + 1/m_2; the particle's mass at a wall.
    pub reduced_mass: f64,
    /// R* with 1/R* = 1/r_1 + 1/r_2; the particle's radius at a wall.
    pub reduced_radius: f64,
    /// I* with 1/I* = 1/I_1 + 1/I_2, I the moments of inertia about the centres; the particle's at a wall.
    pub reduced_inertia: f64,
    /// Magnitude of the cohesive force at this contact that is no part of the law.
    pub cohesion: f64,
}

/// What a contact does to its second body; the first feels the opposite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactForce {
    /// Along the normal: positive pushes the bodies apart.
    pub normal: f64,
    /// In the tangent plane.
    pub tangential: Vector3<f64>,
    /// Normal force that friction is proportional to, in sliding and in rolling; not negative.
    pub friction_normal: f64,
}

impl ContactForce {
    /// No force.
    pub fn zero() -> Self {
        Self { normal: 0.0, tangential: Vector3::zeros(), friction_normal: 0.0 }
    }
}
