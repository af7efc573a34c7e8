//! The choice of the normal force that limits friction.

use crate::contact::ContactLawValues;
use crate::schema::Word;

/// Name of the key of the case file.
pub(in crate::contact::laws) const FRICTION_CAP: &str = "friction_cap";
/// Its meaning.
pub(in crate::contact::laws) const MEANING: &str = "Normal force that limits friction";

/// The normal force that limits friction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrictionCap {
    /// The force of spring and dashpot, |F_n|.
    Contact,
    /// The net normal force, less the attraction F_c: |F_n - F_c|.
    Net,
}

impl FrictionCap {
    /// Words of the case file.
    pub(in crate::contact::laws) const WORDS: &'static [Word] = &[
        Word::new("contact", "that of spring and dashpot"),
        Word::new("net", "that of spring and dashpot, less cohesion"),
    ];

    /// The chosen one; `None` if the word is wrong.
    pub(in crate::contact::laws) fn from_keys(values: &dyn ContactLawValues) -> Option<Self> {
        Some(match values.word(FRICTION_CAP)? {
            "net" => Self::Net,
            _ => Self::Contact,
        })
    }
}
