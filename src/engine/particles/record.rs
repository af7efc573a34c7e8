//! The record of a particle: the list of all data that it carries.

use crate::fields::{Id, Record, records};
use bytemuck::{Pod, Zeroable};

records! {
    /// The state of one particle. Fields without a column of their own lie in [`Body`](super::Body) and
    /// [`ForceTorque`](super::ForceTorque), which loops over pairs read; a new optional quantity is a line at the end,
    /// with a column.
    pub struct ParticleRecord {
        [id]: "global id, ascending";
        position: Vector, Length, "centre, wrapped into the box";
        velocity: Vector, Speed, "velocity of the centre";
        angular_velocity: Vector, AngularSpeed, "angular velocity";
        force: Vector, Force, "total force at the end of the last step";
        torque: Vector, Torque, "total torque at the end of the last step";
        radius: Number, Length, "radius";
        mass: Number, Mass, "mass";
        gas_force: Vector, Force,
            "force of a volume-averaged gas as of its last step, which holds until the next"
            => column_of("a volume-averaged gas");
        species: Integer, One, "number of the species, from 0" => comes_with("species");
        agglomerate_diameter: Number, Length,
            "diameter of the particle's agglomerate when it was last found; 0: alone"
            => column_of("drag of agglomerates");
        agglomerate_packing: Number, One,
            "volume of its members over that of a sphere of this diameter"
            => column_of("drag of agglomerates");
        drag_factor: Number, One, "drag over that of the law in the last step of the gas"
            => column_of("drag of agglomerates");
    }
}

impl Record for ParticleRecord {
    const GROUP: &'static str = "/particles";
    const IDS: &'static [Id] = Self::IDS;
    const FIELDS: &'static [crate::fields::Field] = Self::FIELDS;
}

/// Data of a particle on its agglomerate, side by side as in the record.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct AgglomerateOfParticle {
    /// Diameter of the sphere that represents the agglomerate; 0 for a particle alone.
    pub diameter: f64,
    /// Ratio of the volume of the members to that of this sphere.
    pub packing: f64,
    /// xi, the ratio of the drag on the particle to that of the law in the last step of the gas.
    pub drag_factor: f64,
}
