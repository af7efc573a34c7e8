//! Particles: their columns, who is near whom, what touching pairs remember, and how they move.

mod contacts;
mod store;

pub use contacts::ContactMemory;
pub use store::Particles;
