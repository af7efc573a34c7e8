//! A contact law compiled into the loops over blocks of pairs.

use super::ContactForceLaw;
use super::force_laws::ForceOutOfRange;
use super::pair_loop::{ContactLoop, add_contacts};
use super::walls::{WallLoop, add_wall};
use std::fmt::Debug;

/// A contact law that is compiled into the loops over blocks of pairs, which are called through a table of functions: every
/// [`ContactForceLaw`] whose type the compiler may send between threads and print. It cannot be implemented otherwise.
pub trait BlockLaw: ContactForceLaw + Send + Sync + Debug {
    /// Adds the forces and torques of pairs that may touch.
    ///
    /// # Errors
    /// If a force exceeds the limit or is undefined.
    #[doc(hidden)]
    fn add_contacts(&self, contacts: ContactLoop<'_, false>) -> Result<(), ForceOutOfRange>;

    /// The same loop where twisting is resisted, or where asperities attract.
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
