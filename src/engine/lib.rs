//! The step of Talcum: particles, contacts and gas, and the ranks that share them. The crate `talcum` shows these modules
//! as its own, and has the equations.

pub mod balance;
pub mod contact;
pub mod coupling;
pub mod domain;
pub mod fields;
pub mod gas;
pub mod grid;
pub mod linear_solver;
pub mod numbers;
pub mod parallel;
pub mod particle_sets;
pub mod particles;
pub mod rules;
pub mod schema;
pub mod state;
pub mod time_step;
pub mod timers;
