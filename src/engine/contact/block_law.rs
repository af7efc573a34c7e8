//! A contact law compiled into the loops over blocks of pairs.

use super::ContactForceLaw;
use super::force_laws::ForceOutOfRange;
use super::pair_loop::{ContactLoop, add_contacts};
use super::walls::{WallLoop, add_wall};
use std::fmt::Debug;

/// A contact law that is compiled into the loops over blocks of pairs, which are called through a table of functions.
/// Every [`ContactForceLaw`] whose type is `Send`, `Sync` and `Debug` implements it; there can be no other
/// implementation.
pub trait BlockLaw: ContactForceLaw + Send + Sync + Debug {
    /// Adds the forces and torques of pairs that may touch.
    ///
    /// # Errors
    /// If a force exceeds the limit or is undefined.
    #[doc(hidden)]
    fn add_contacts(&self, contacts: ContactLoop<'_, false>) -> Result<(), ForceOutOfRange>;

    /// The loop of [`add_contacts`](Self::add_contacts) with resistance to twisting or attraction of asperities.
    ///
    /// # Errors
    /// If a force exceeds the limit or is undefined.
    #[doc(hidden)]
    fn add_contacts_with_extras(
        &self,
        contacts: ContactLoop<'_, true>,
    ) -> Result<(), ForceOutOfRange>;

    /// Adds the forces and torques of one wall.
    ///
    /// # Errors
    /// If a force exceeds the limit or is undefined.
    #[doc(hidden)]
    fn add_wall(&self, at_wall: WallLoop<'_>) -> Result<(), ForceOutOfRange>;
}

impl<L: ContactForceLaw + Send + Sync + Debug> BlockLaw for L {
    fn add_contacts(&self, contacts: ContactLoop<'_, false>) -> Result<(), ForceOutOfRange> {
        add_contacts(self, contacts)
    }

    fn add_contacts_with_extras(
        &self,
        contacts: ContactLoop<'_, true>,
    ) -> Result<(), ForceOutOfRange> {
        add_contacts(self, contacts)
    }

    fn add_wall(&self, at_wall: WallLoop<'_>) -> Result<(), ForceOutOfRange> {
        add_wall(self, at_wall)
    }
}
