//! What is computed from the state and never changes it.

mod digest;

pub use digest::Digest;
