//! Data that sections need from each other.

use super::particles::Scales;
use super::species::SpeciesSections;
use super::units::Units;
use crate::input::Section;
use std::ops::Range;
use talcum_engine::state::Domain;

/// Data from other sections of the file, as far as they are known.
#[derive(Clone, Copy)]
pub(super) struct ReadContext<'a> {
    pub(super) units: Option<Units>,
    pub(super) scales: Scales,
    pub(super) species: &'a SpeciesSections<'a>,
    pub(super) domain: Option<&'a Domain>,
    /// g.
    pub(super) gravity: Option<f64>,
    /// Start and end of each stage.
    pub(super) times: &'a [Range<f64>],
}

/// Requires that a span of time lasts for at least one step.
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
