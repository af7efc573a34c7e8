//! A stage: a part of the run during which the same models hold.

use crate::state::{Models, Physics, SizeRange};

/// A part of the run during which the same models hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Stage {
    /// Its name.
    pub name: String,
    /// When it begins.
    pub start: f64,
    /// When it ends: the next one's start.
    pub end: f64,
    /// What acts on the particles.
    pub physics: Physics,
}

impl Stage {
    /// The models of this stage for particles of these sizes, which are those at the start of the run, also in a restart.
    pub fn models(&self, sizes: &SizeRange) -> Models {
        Models::of(&self.physics, sizes)
    }
}
