//! What is read off a state: never changes it, knows no files.

mod bed_profile;
mod measures;

pub use bed_profile::BedProfile;
pub use measures::{Measures, MomentumProbe, measure};
