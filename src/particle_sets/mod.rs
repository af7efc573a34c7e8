//! Sets of particles that are spread over ranks: who owns which particle, pairs that touch, contacts that persist, connected
//! sets of them, and agglomerates.
//!
//! What a sample finds depends on ids, positions and contacts alone, and is the same bits for any distribution over ranks, if
//! positions are multiples of the quantum of positions. It knows nothing of forces: the drag of agglomerates and the measures
//! of a run are made of it alike.

pub(crate) mod exact_sums;
pub(crate) mod fixed_point;
mod look;
mod ownership;
pub(crate) mod pair;
mod periodicity;
mod persistent_contacts;
pub(crate) mod rendezvous;

pub mod agglomerates;
pub mod components;

pub use look::{samples, touching_pairs};
pub use ownership::Ownership;
pub use pair::Pair;
pub use periodicity::{Image, Periodicity};
pub use persistent_contacts::{Persistence, PersistentContacts};
