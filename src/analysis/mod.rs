//! What is read off a state: never changes it, knows no files.

mod bed_profile;
mod digest;
mod measures;
mod momentum;
mod observation;
mod sums;

pub use bed_profile::BedProfile;
pub use digest::{Digest, StateRecords};
pub use measures::{Column, Measures, Quantity, measure};
pub use momentum::MomentumProbe;
pub use observation::RunView;
