//! Particles: their data, neighbour lists, contact histories, and time integration.

mod body;
mod cell_grid;
mod contact_history;
mod contacts;
mod ghosts;
mod inner_list;
mod integrate;
mod membership;
mod neighbour_list;
mod optional_column;
mod pair_blocks;
mod pair_kind;
mod pairs_of_kind;
mod places;
mod proximity;
mod range;
mod skin;
mod store;

pub use body::{Body, ForceTorque, sphere_volume};
pub(crate) use cell_grid::CellGrid;
pub use contact_history::{ContactHistories, ContactHistory, PairHistory, WallHistory};
pub use contacts::{Contacts, LostContact};
pub(crate) use ghosts::{drift_copies, follow_originals};
pub(crate) use inner_list::{InnerList, InteractionRanges, PairCounts, PairGroup};
pub(crate) use integrate::{DriftStep, Weight, kick, kick_and_drift, set_first_forces};
pub use membership::Membership;
pub use neighbour_list::NeighbourList;
pub use optional_column::OptionalColumn;
pub(crate) use pair_blocks::{
    AngleLanes, LANES, Lanes, Pair, PairBlock, PairBlocks, Remembered, SpringLanes,
};
pub(crate) use pair_kind::{kind_of_bodies, kind_of_species};
pub(crate) use pairs_of_kind::{Candidates, PairsOfKind};
pub(crate) use proximity::{four_of, push_set_bits};
pub use range::ListRange;
pub use skin::Skin;
pub use store::Particles;
