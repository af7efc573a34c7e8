//! What touching bodies remember.

use nalgebra::Vector3;

/// What a touching pair remembers: one record for all contact laws.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactMemory {
    /// Tangential displacement of the second body relative to the first since the contact began.
    pub tangential_spring: Vector3<f64>,
    /// Largest overlap since the contact began.
    pub largest_overlap: f64,
}
