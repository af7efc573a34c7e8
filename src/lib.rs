//! Talcum: CFD-DEM of fluidised beds of fine, cohesive powders.

pub mod analysis;
pub mod case;
pub mod contact;
pub mod coupling;
pub mod domain;
pub mod gas;
pub mod grid;
pub mod numbers;
pub mod output;
pub mod parallel;
pub mod particles;
pub mod state;
pub mod time_step;
pub mod timers;
