//! What a particle knows of the agglomerate that it is in.

use bytemuck::{Pod, Zeroable};

/// The agglomerate of a particle as of the last look, and what it makes of the particle's drag. All zero where nobody looks;
/// a particle alone has no size of an agglomerate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Membership {
    /// Diameter of the sphere that the agglomerate is taken for.
    pub diameter: f64,
    /// Volume of the members over that of this sphere.
    pub packing: f64,
    /// xi, the drag on the particle over that of the law in the last step of the gas.
    pub drag_factor: f64,
}
