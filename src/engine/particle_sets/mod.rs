//! Sets of particles that are spread over ranks: ownership of particles, pairs that touch, contacts that persist,
//! connected sets of these, and agglomerates.
//!
//! The results of a sample depend only on ids, positions and contacts, and have the same bits for any distribution over
//! ranks, if positions are multiples of the quantum of positions. Forces are not used: both the drag on agglomerates
//! and the instruments of a run are based on this module.

pub mod exact_sums;
pub mod fixed_point;
mod look;
mod ownership;
pub mod pair;
mod periodicity;
mod persistent_contacts;
pub mod rendezvous;

pub mod agglomerates;
pub mod components;

pub use look::{samples, touching_pairs};
pub use ownership::Ownership;
pub use pair::Pair;
pub use periodicity::{Image, Periodicity};
pub use persistent_contacts::{Persistence, PersistentContacts};
