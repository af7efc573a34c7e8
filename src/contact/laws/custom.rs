//! Custom contact laws: those from outside the crate.

use super::ContactLaw;
use crate::contact::BlockLaw;
use std::sync::Arc;

/// A contact law that the crate does not know by its type.
///
/// It is compiled into the loop over pairs, for every instruction set, as the laws of the registry are: mark its `force` and
/// `touches` `#[inline(always)]`.
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
