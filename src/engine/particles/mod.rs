//! Particles: their data, neighbour lists, contact histories, and time integration.

mod body;
mod cell_grid;
mod columns;
mod contact_state;
mod contacts;
mod custom_fields;
mod ghosts;
mod inner_list;
mod integrate;
mod neighbour_list;
mod packing;
mod pair_blocks;
mod pair_kind;
mod pairs_of_kind;
mod places;
mod proximity;
mod range;
mod record;
mod skin;
mod store;

pub use body::{Body, ForceTorque, sphere_volume};
pub(crate) use cell_grid::CellGrid;
pub use columns::{AGGLOMERATE, GAS_FORCE};
pub use columns::{Column, Columns};
pub use contact_state::{
    ContactHistories, ContactHistory, ContactRecord, ContactState, WallContactRecord,
};
pub use contacts::{Contacts, LostContact};
pub(crate) use contacts::{MeshMargin, WallPair};
pub use custom_fields::CustomFields;
pub(crate) use ghosts::{drift_copies, follow_originals};
pub(crate) use inner_list::{InnerList, InteractionRanges, PairCounts, PairGroup};
pub(crate) use integrate::{DriftStep, Weight, kick, kick_and_drift, set_first_forces};
pub use neighbour_list::NeighbourList;
pub(crate) use pair_blocks::{
    AngleLanes, ContactColumns, LANES, Lanes, Pair, PairBlock, PairBlocks, SpringLanes,
};
pub(crate) use pair_kind::{kind_of_bodies, kind_of_species};
pub(crate) use pairs_of_kind::{Candidates, PairsOfKind};
pub(crate) use proximity::{four_of, push_set_bits};
pub use range::ListRange;
pub use record::{AgglomerateOfParticle, ParticleRecord};
pub use skin::Skin;
pub use store::Particles;
