//! The volume-averaged gas: its pressure equation, its flow, and the flow with particles.
#![allow(clippy::unwrap_used, reason = "in tests a panic is the report")]

#[path = "../beds/mod.rs"]
mod beds;

mod fluidised;
mod gas_flow;
mod pressure_solver;
