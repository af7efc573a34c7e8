//! A stage: a part of the run with the same models.

use talcum_engine::state::{Models, Physics, SizeRange};

/// A part of the run with the same models.
#[derive(Clone, Debug, PartialEq)]
pub struct Stage {
    /// Its name.
    pub name: String,
    /// Time at which it begins.
    pub start: f64,
    /// Time at which it ends: the start of the next one.
    pub end: f64,
    /// The models that act on the particles.
    pub physics: Physics,
}

impl Stage {
    /// The models of this stage for particles of these sizes, which are those at the start of the run, also after a
    /// restart.
    pub fn models(&self, sizes: &SizeRange) -> Models {
        Models::of(&self.physics, sizes)
    }
}
