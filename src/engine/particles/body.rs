//! Records of particles: the data that the evaluation of a pair needs, contiguous in memory.

use bytemuck::{Pod, Zeroable};
use nalgebra::Vector3;
use std::ops::AddAssign;

/// Size, position and velocities of a particle: three times four numbers, each aligned for vector instructions.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(32))]
pub struct Body {
    /// Centre, a multiple of the position quantum of the box.
    pub position: Vector3<f64>,
    /// Radius.
    pub radius: f64,
    /// Velocity of the centre.
    pub velocity: Vector3<f64>,
    /// Mass.
    pub mass: f64,
    /// Angular velocity, right-handed.
    pub angular_velocity: Vector3<f64>,
    /// Number of the species, a whole number from 0: [`Body::species`].
    species: f64,
}

/// Force and torque on a particle: twice four numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C, align(64))]
pub struct ForceTorque {
    /// Total force, a multiple of the force quantum.
    pub force: Vector3<f64>,
    /// Padding, zero.
    spare_of_force: f64,
    /// Total torque about the centre, a multiple of the torque quantum.
    pub torque: Vector3<f64>,
    /// Padding, zero.
    spare_of_torque: f64,
}

/// I / (m r^2) of a solid sphere.
const INERTIA_FACTOR: f64 = 0.4;

/// Volume of a sphere, 4/3 pi r^3.
#[inline(always)]
pub fn sphere_volume(radius: f64) -> f64 {
    4.0 / 3.0 * std::f64::consts::PI * radius.powi(3)
}

impl Body {
    /// Makes a body without spin, of the first species.
    pub fn new(position: Vector3<f64>, velocity: Vector3<f64>, radius: f64, mass: f64) -> Self {
        Self { position, radius, velocity, mass, angular_velocity: Vector3::zeros(), species: 0.0 }
    }

    /// This body with another species.
    #[must_use]
    pub fn of_species(self, species: usize) -> Self {
        Self { species: species as f64, ..self }
    }

    /// Number of the species, which is the material of the body; 0 in a bed of one species.
    #[inline(always)]
    pub fn species(&self) -> usize {
        self.species as usize
    }

    /// Moment of inertia of a solid sphere, (2/5) m r^2.
    #[inline(always)]
    pub fn inertia(&self) -> f64 {
        INERTIA_FACTOR * self.mass * self.radius * self.radius
    }

    /// The data as three vectors: position and radius, velocity and mass, angular velocity and number of the species.
    #[inline(always)]
    pub fn vectors(&self) -> &[[f64; 4]; 3] {
        bytemuck::cast_ref(self)
    }

    /// Mutable access to these vectors.
    #[inline(always)]
    pub fn vectors_mut(&mut self) -> &mut [[f64; 4]; 3] {
        bytemuck::cast_mut(self)
    }
}

impl AddAssign for ForceTorque {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        self.force += other.force;
        self.torque += other.torque;
    }
}

impl ForceTorque {
    /// A force and a torque.
    #[inline(always)]
    pub fn new(force: Vector3<f64>, torque: Vector3<f64>) -> Self {
        Self { force, torque, ..Self::zeroed() }
    }

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

    /// The data as two vectors: force and zero, torque and zero.
    #[inline(always)]
    pub fn vectors(&self) -> &[[f64; 4]; 2] {
        bytemuck::cast_ref(self)
    }

    /// Mutable access to these vectors; the zeros must stay.
    #[inline(always)]
    pub fn vectors_mut(&mut self) -> &mut [[f64; 4]; 2] {
        bytemuck::cast_mut(self)
    }
}
