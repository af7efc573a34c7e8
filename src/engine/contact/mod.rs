//! Forces between particles that touch or attract each other, and at walls: pure functions of kinematics and contact
//! history, and the loops that evaluate them.

mod block_law;
mod by_species;
mod coarse_graining;
mod energy;
mod energy_pass;
mod exchange;
mod force_laws;
mod force_loop;
mod invalid_law;
mod kinematics;
mod lanes;
mod law;
mod laws;
mod model;
mod pair_loop;
mod parting;
mod readout;
mod rolling;
mod softening;
mod twisting;
mod van_der_waals;
mod wall_tallies;
mod walls;

pub use block_law::BlockLaw;
pub use by_species::{ByPair, BySpecies};
pub use coarse_graining::{COARSE_GRAINING, CoarseGraining, Kept};
pub use energy::{ContactStep, ContactWork, SpringStep, StoredInContact};
pub(crate) use energy_pass::{
    WallWork, attraction_energy, elastic_energy, work_of_pairs, work_of_walls,
};
pub use exchange::{ContactExchange, Exchanges, TouchingParticles};
pub(crate) use exchange::{add_flows, advance_fields};
pub use force_laws::{ForceLaws, WallLaws};
pub use force_loop::{LoopPoint, force_loop};
pub use invalid_law::InvalidContactLaw;
pub use kinematics::{Contact, ContactForce};
pub use law::ContactForceLaw;
pub use laws::*;
pub use model::ContactModel;
pub(crate) use pair_loop::{add_contact_forces, find_contacts, prepare_pairs};
pub use parting::{AttractionInContact, overlap_under, pull_off_force, work_of_parting};
pub use readout::{PairForce, WallPairForce};
pub use readout::{for_each_pair_force, wall_pair_forces};
pub use rolling::{ROLLING, RollingFriction, RollingKind};
pub use softening::{SOFTENING, Softening};
pub use twisting::{TWISTING, TwistingFriction};
pub use van_der_waals::{CohesionExpression, VanDerWaals, VanDerWaalsNow};
pub use wall_tallies::WallTallies;
pub(crate) use walls::{add_wall_forces, find_mesh_contacts};
