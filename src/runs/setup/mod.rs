//! A bed from Rust, without a case file: choose, start, step, read.
//!
//! ```
//! # mod talcum { pub use talcum_engine::*; pub use talcum_results::*; pub use talcum_runs::*; }
//! use talcum::contact::{FrictionCap, LinearSpringDashpot};
//! use talcum::domain::Face;
//! use talcum::setup::{Layers, Setup};
//! use talcum::state::Physics;
//!
//! // Dimensionless: solid density, diameter and gravity are 1.
//! let law = LinearSpringDashpot::new(1.0e4, 8.2e3, 0.9, 0.1, FrictionCap::Contact)?;
//! let faces = [[Face::Periodic; 2], [Face::Periodic; 2], [Face::Wall, Face::Open]];
//! let mut run = Setup::new([3.3, 3.3, 10.0], faces, Physics::new(law, 5.0e-4))?
//!     .gravity(1.0)
//!     .layers(&Layers { count: 27, ..Layers::default() })
//!     .start_alone()?;
//! run.steps(100)?;
//! assert!((run.time() - 0.05).abs() < 1.0e-12);
//! println!("digest {}", run.digest()?);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! All numbers are in one coherent system of units, SI or any other: nothing is converted. z points upwards.

mod builder;
mod checks;
mod layout;
mod run;
mod setup_error;
mod snapshot;

pub use crate::beds::{Layers, Sphere};
pub use builder::Setup;
pub use layout::{Layout, LayoutError};
pub use run::Run;
pub use setup_error::SetupError;
pub use snapshot::{DistributedState, Snapshot};
