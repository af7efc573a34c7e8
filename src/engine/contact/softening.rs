//! Particles that are softer in the run than the real ones, which allows longer time steps.

use crate::rules::adhesion_factor;
use crate::schema::{Allowed, Key, Value, Word};

const STIFFNESS_REDUCTION: Key = Key::number(
    "stiffness_reduction",
    Allowed::at_least(1.0),
    "Stiffness (or Young's modulus) of the real particles over that of the law",
);

const WORDS: &[Word] = &[
    Word::new("unstated", "nothing is said of the real particles"),
    Word::with(
        "keeps_force",
        "adhesive forces are the given ones: softer particles take more work to part",
        &[STIFFNESS_REDUCTION],
    ),
    Word::with(
        "keeps_work",
        "adhesive forces are scaled so that the work of separation is that of the real particles",
        &[STIFFNESS_REDUCTION],
    ),
];

/// `contact.softening`.
pub const SOFTENING: Key =
    Key::word("softening", WORDS, "What stays of the adhesion of stiffer, real particles")
        .default(Value::Word("unstated"));

/// The degree to which a law is softer than the real particles, and the treatment of their adhesion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Softening {
    /// Lambda, the ratio of the stiffness of the real particles to that of the law.
    pub reduction: f64,
    /// Whether adhesion is scaled such that the work of separation is that of the real particles.
    pub keeps_work: bool,
}

impl Softening {
    /// The factor of adhesive forces, for a law whose force grows as this power of the overlap.
    pub fn adhesion_factor(&self, overlap_exponent: f64) -> f64 {
        if self.keeps_work { adhesion_factor(self.reduction, overlap_exponent) } else { 1.0 }
    }
}
