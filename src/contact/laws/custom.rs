//! Contact laws from outside the crate.

use super::ContactLaw;
use crate::contact::ContactForceLaw;
use crate::contact::lanes::BlockLaw;
use std::sync::Arc;

/// A contact law that the crate does not know by its type.
///
/// The loop over pairs calls it once per block of 32 pairs, so that it costs hardly more than a law of the registry, and
/// its results have the same bits. It is compiled for both instruction sets, like the laws of the registry: mark its
/// `force` and `touches` `#[inline(always)]`.
#[derive(Clone, Debug)]
pub struct CustomContactLaw {
    name: Arc<str>,
    law: Arc<dyn BlockLaw>,
}

impl CustomContactLaw {
    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    pub(super) fn as_law(&self) -> &dyn ContactForceLaw {
        &*self.law
    }

    pub(super) fn as_block_law(&self) -> &dyn BlockLaw {
        &*self.law
    }
}

/// Two are equal if they are the same law, not only alike: its parameters are not known here.
impl PartialEq for CustomContactLaw {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name && Arc::ptr_eq(&self.law, &other.law)
    }
}

impl ContactLaw {
    /// A law from outside the crate, with a name for messages and files.
    pub fn custom(name: &str, law: impl BlockLaw + 'static) -> Self {
        Self::Custom(CustomContactLaw { name: name.into(), law: Arc::new(law) })
    }
}
