//! Rules shared by several parts of the program, each stated once: `talcum check` prints the limits that a run
//! enforces.
//!
//! They are pure functions of numbers in one coherent system of units, and do not depend on the rest of the crate.

mod archimedes_number;
mod bond_number;
mod contact_duration;
mod drag_response;
mod gas_step;
mod interaction_range;
mod lone_fall;
mod parting;
mod speed_limit;
mod stokes_number;

pub use archimedes_number::archimedes_number;
pub use bond_number::{
    ContactPartner, attraction_of_bond_number, hamaker_constant_per_bond_number,
};
pub use contact_duration::{LEAST_STEPS_PER_CONTACT, ReducedBody};
pub use drag_response::{LARGEST_DRAG_RESPONSE, drag_response};
pub use gas_step::{LARGEST_STEP_NUMBER, courant_rate, step_number, viscous_rate};
pub use interaction_range::interaction_range;
pub use lone_fall::excess_of_lone_fall;
pub use parting::{LARGEST_SPRING_PART, WorkOfParting, adhesion_factor};
pub use speed_limit::speed_limit;
pub use stokes_number::{stokes_number, viscosity_of_stokes_number};
