//! Particles: their columns, who is near whom, what touching pairs remember, and how they move.

mod body;
mod cell_grid;
mod contacts;
mod displacement;
mod integrate;
mod near_pairs;
mod neighbours;
mod store;

pub use body::{Body, Load, sphere_volume};
pub use cell_grid::CellGrid;
pub use contacts::{ContactMemory, Contacts, LostContact, PairMemory, WallMemory};
pub use integrate::{kick, kick_and_drift};
pub use near_pairs::{AngleLanes, LANES, MEMORY_FIELDS, MemoryLanes, NearPairs};
pub use neighbours::{Neighbours, Reach};
pub use store::Particles;
