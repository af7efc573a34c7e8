//! Physics, compared with closed forms, published numbers and balances.
#![allow(clippy::unwrap_used, reason = "in tests a panic is the report")]

#[path = "../beds/mod.rs"]
mod beds;

mod compressible_column;
mod contact_laws;
mod energy;
mod energy_ledger;
mod gas_column;
mod instruments;
mod integrator_order;
mod limited_walls;
mod measures_never_panic;
mod meshes;
mod minimum_fluidisation;
mod plenum;
mod single_particle;
mod species;
mod wall_forces;
