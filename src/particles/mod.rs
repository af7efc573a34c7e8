//! Particles: their data, neighbour lists, contact histories, and time integration.

mod body;
mod cell_grid;
mod contacts;
mod inner_list;
mod integrate;
mod neighbour_list;
mod pair_blocks;
mod proximity;
mod store;

pub use body::{Body, ForceTorque, sphere_volume};
pub(crate) use cell_grid::CellGrid;
pub use contacts::{
    ContactHistories, ContactHistory, Contacts, LostContact, PairHistory, WallHistory,
};
pub(crate) use inner_list::Candidates;
pub(crate) use inner_list::{InnerList, InteractionRanges};
pub(crate) use integrate::{DriftStep, Weight, kick, kick_and_drift, set_forces_to_weight};
pub use neighbour_list::{ListRange, NeighbourList};
pub(crate) use pair_blocks::{
    AngleLanes, HISTORY_FIELDS, HistoryLanes, LANES, Pair, PairBlock, PairBlocks,
};
pub use store::Particles;
