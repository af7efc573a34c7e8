//! What is read off a state: never changes it, knows no files.

mod bed_profile;
mod digest;
mod measures;

pub use bed_profile::BedProfile;
pub use digest::Digest;
pub use measures::{Measures, MomentumProbe, measure};
