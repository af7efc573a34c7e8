//! Particles: their columns, who is near whom, what touching pairs remember, and how they move.

mod cell_grid;
mod contacts;
mod integrate;
mod neighbours;
mod store;

pub use cell_grid::CellGrid;
pub use contacts::{ContactMemory, Contacts, LostContact, PairMemory, WallMemory};
pub use integrate::{kick, kick_and_drift};
pub use neighbours::{Neighbours, Reach};
pub use store::Particles;
