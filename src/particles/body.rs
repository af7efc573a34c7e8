//! Records of particles: all that a pair needs of a particle in one place of memory.

use bytemuck::{Pod, Zeroable};
use nalgebra::Vector3;

/// Size and motion of a particle. In memory: three times four numbers, each at an address that vector instructions
/// like.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(32))]
pub struct Body {
    /// Centre, on the position lattice of the box.
    pub position: Vector3<f64>,
    /// Radius.
    pub radius: f64,
    /// Velocity of the centre.
    pub velocity: Vector3<f64>,
    /// Mass.
    pub mass: f64,
    /// Angular velocity, right-handed.
    pub angular_velocity: Vector3<f64>,
    /// Zero.
    spare: f64,
}

/// What acts on a particle. In memory: twice four numbers.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(64))]
pub struct ForceTorque {
    /// Total force, on the force lattice.
    pub force: Vector3<f64>,
    /// Zero.
    spare_of_force: f64,
    /// Total torque about the centre, on the torque lattice.
    pub torque: Vector3<f64>,
    /// Zero.
    spare_of_torque: f64,
}

/// Solid sphere: I = (2/5) m r^2.
const INERTIA_FACTOR: f64 = 0.4;

/// 4/3 pi r^3.
#[inline(always)]
pub fn sphere_volume(radius: f64) -> f64 {
    4.0 / 3.0 * std::f64::consts::PI * radius.powi(3)
}

impl Body {
    /// A body without spin.
    pub fn new(position: Vector3<f64>, velocity: Vector3<f64>, radius: f64, mass: f64) -> Self {
        Self { position, radius, velocity, mass, angular_velocity: Vector3::zeros(), spare: 0.0 }
    }

    /// Moment of inertia of a solid sphere, (2/5) m r^2.
    #[inline(always)]
    pub fn inertia(&self) -> f64 {
        INERTIA_FACTOR * self.mass * self.radius * self.radius
    }

    /// Position and radius, velocity and mass, angular velocity and zero.
    #[inline(always)]
    pub fn vectors(&self) -> &[[f64; 4]; 3] {
        bytemuck::cast_ref(self)
    }

    /// The same, to be changed.
    #[inline(always)]
    pub fn vectors_mut(&mut self) -> &mut [[f64; 4]; 3] {
        bytemuck::cast_mut(self)
    }
}

impl ForceTorque {
    /// A force without torque.
    #[inline(always)]
    pub fn of(force: Vector3<f64>) -> Self {
        Self { force, ..Self::zeroed() }
    }

    /// A force along z, and no torque.
    #[inline(always)]
    pub fn along_z(force: f64) -> Self {
        Self::of(Vector3::new(0.0, 0.0, force))
    }

    /// Force and zero, torque and zero.
    #[inline(always)]
    pub fn vectors(&self) -> &[[f64; 4]; 2] {
        bytemuck::cast_ref(self)
    }

    /// The same, to be changed; the zeros remain.
    #[inline(always)]
    pub fn vectors_mut(&mut self) -> &mut [[f64; 4]; 2] {
        bytemuck::cast_mut(self)
    }
}
