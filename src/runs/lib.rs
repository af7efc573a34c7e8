//! Runs of Talcum: described by a case file or from Rust, and carried to their end. The crate `talcum` shows these modules
//! as its own.

pub mod beds;
pub mod case;
pub mod input;
pub mod setup;
pub mod simulation;
