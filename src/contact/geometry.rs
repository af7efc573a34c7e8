//! Two touching bodies as a contact law sees them.

use nalgebra::Vector3;

/// A contact: the first body, a particle; the second, another particle or a wall.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// Depth of interpenetration, > 0.
    pub overlap: f64,
    /// Unit vector from the first body towards the second.
    pub normal: Vector3<f64>,
    /// Velocity of the second body's surface relative to the first's at the contact, rotation included.
    pub relative_velocity: Vector3<f64>,
    /// m* with 1/m* = 1/m_1 + 1/m_2; the particle's mass at a wall.
    pub reduced_mass: f64,
    /// Magnitude of the cohesive force at this contact.
    pub cohesion: f64,
}

/// What a contact does to its second body; the first feels the opposite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactForce {
    /// Along the normal: positive pushes the bodies apart.
    pub normal: f64,
    /// In the tangent plane.
    pub tangential: Vector3<f64>,
}
