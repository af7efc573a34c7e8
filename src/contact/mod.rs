//! Forces between particles that touch, or nearly do: pure functions of geometry and memory.

mod forces;
mod geometry;
mod lanes;
mod law;
mod linear_spring_dashpot;
mod van_der_waals;

pub use forces::{ForceLaws, ForceOutOfRange, add_pair_forces, add_wall_forces};
pub use geometry::{Contact, ContactForce};
pub use law::{ContactLaw, ContactModel};
pub use linear_spring_dashpot::{FrictionCap, InvalidContactLaw, LinearSpringDashpot};
pub use van_der_waals::{CohesionExpression, VanDerWaals, VanDerWaalsNow};
