//! Forces between particles that touch, or nearly do: pure functions of geometry and memory.

mod forces;
mod geometry;
mod lanes;
mod law;
mod linear_spring_dashpot;
mod rolling;
mod van_der_waals;
mod wall_forces;

pub use forces::{ForceLaws, ForceOutOfRange, NearPair, add_pair_forces};
pub use geometry::{Contact, ContactForce};
pub use law::{ContactLaw, ContactModel, Interface};
pub use linear_spring_dashpot::{FrictionCap, InvalidContactLaw, LinearSpringDashpot};
pub use rolling::{RollingFriction, RollingKind};
pub use van_der_waals::{CohesionExpression, VanDerWaals, VanDerWaalsNow};
pub use wall_forces::add_wall_forces;
