//! Custom contact laws: those from outside the crate.

use super::ContactLaw;
use crate::contact::BlockLaw;
use std::sync::Arc;

/// A contact law whose type is not known to the crate.
///
/// It is compiled into the loop over pairs, for every instruction set, like the laws of the registry: mark its `force`
/// and `touches` as `#[inline(always)]`.
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

/// Two are equal if they are the same object; equal parameters do not suffice, since they are not known here.
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
