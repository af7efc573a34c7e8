//! Forces between particles that touch, or nearly do: pure functions of geometry and memory.

mod adhesive_elastic_plastic;
mod apart;
mod block;
mod elastic;
mod force_loop;
mod forces;
mod geometry;
mod hertz_mindlin;
mod hysteresis;
mod jkr;
mod lanes;
mod law;
mod linear_hysteretic;
mod linear_spring_dashpot;
mod rolling;
mod slider;
mod van_der_waals;
mod wall_forces;

pub use adhesive_elastic_plastic::AdhesiveElasticPlastic;
pub use elastic::{ContactModuli, Elasticity};
pub use force_loop::{LoopPoint, force_loop};
pub use forces::{ForceLaws, ForceOutOfRange, add_pair_forces};
pub use geometry::{Contact, ContactForce};
pub use hertz_mindlin::HertzMindlin;
pub use hysteresis::HystereticParameters;
pub use jkr::Jkr;
pub use law::{ContactForceLaw, ContactLaw, ContactModel};
pub use linear_hysteretic::LinearHysteretic;
pub use linear_spring_dashpot::{FrictionCap, InvalidContactLaw, LinearSpringDashpot};
pub use rolling::{RollingFriction, RollingKind};
pub use van_der_waals::{CohesionExpression, VanDerWaals, VanDerWaalsNow};
pub use wall_forces::add_wall_forces;
