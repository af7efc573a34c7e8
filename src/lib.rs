//! Talcum: CFD-DEM of fluidised beds of fine, cohesive powders.

pub mod analysis;
pub mod case;
pub mod command_line;
pub mod contact;
pub mod coupling;
pub mod domain;
pub mod gas;
pub mod grid;
pub mod numbers;
pub mod output;
pub mod parallel;
pub mod particles;
pub mod simulation;
pub mod state;
pub mod time_step;
pub mod timers;
