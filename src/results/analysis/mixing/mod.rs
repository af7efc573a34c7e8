//! Spreading of particles: mean square displacement, dispersion coefficients, and the Lacey index.

mod dispersion;
mod displacements;
mod lacey;

pub use dispersion::{Dispersion, largest_secant, slope_between};
pub use displacements::{Displacements, MeanDisplacement, Positioned};
pub use lacey::{LaceyIndex, Sample, lacey_index};
