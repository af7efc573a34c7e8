//! What sections need to know of each other.

use super::particles::Scales;
use super::species::SpeciesSections;
use super::units::Units;
use crate::input::Section;
use crate::state::Domain;
use std::ops::Range;

/// What other sections of the file say, as far as it is known, for those who need it.
#[derive(Clone, Copy)]
pub(super) struct ReadContext<'a> {
    pub(super) units: Option<Units>,
    pub(super) scales: Scales,
    pub(super) species: &'a SpeciesSections<'a>,
    pub(super) domain: Option<&'a Domain>,
    /// g.
    pub(super) gravity: Option<f64>,
    /// When each stage begins and ends.
    pub(super) times: &'a [Range<f64>],
}

/// A span of time must last for a step at least.
pub(super) fn require_a_step(
    section: &Section<'_>,
    name: &str,
    span: Option<f64>,
    step: Option<f64>,
) {
    if let (Some(step), Some(span)) = (step, span)
        && span < step
    {
        section.fail(name, format!("must be at least time.step, {step}"));
    }
}
