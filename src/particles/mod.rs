//! Particles: their columns, who is near whom, what touching pairs remember, and how they move.

mod body;
mod cell_grid;
mod closeness;
mod contacts;
mod integrate;
mod near_pairs;
mod neighbours;
mod pair_blocks;
mod store;

pub use body::{Body, ForceTorque, sphere_volume};
pub use cell_grid::CellGrid;
pub use contacts::{
    ContactHistories, ContactHistory, Contacts, LostContact, PairHistory, WallHistory,
};
pub use integrate::{Step, Weight, begin_with_weight, kick, kick_and_drift};
pub(crate) use near_pairs::Waiting;
pub use near_pairs::{NearPairs, Ranges};
pub use neighbours::{Neighbours, Reach};
pub use pair_blocks::{
    AngleLanes, HISTORY_FIELDS, HistoryLanes, LANES, Pair, PairBlock, PairBlocks,
};
pub use store::Particles;
