//! The particles at the start of a case.

use super::Case;
use crate::beds::{self, BedPart, BedPlan, BedProblem, InitialBed};
use crate::input::InputErrors;
use talcum_engine::state::SizeRange;
use thiserror::Error;

/// Why a case has no initial bed.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BedError {
    /// What the case asks for does not fit, or does not suit the sizes of the particles.
    #[error(transparent)]
    Case(#[from] InputErrors),
    /// Its file is wrong, or it is the end of another run.
    #[error(transparent)]
    Bed(BedProblem),
}

impl Case {
    /// The particles at the start: those of a part of the bed, in the order of their ids. They are what they are in the
    /// whole bed.
    ///
    /// # Errors
    /// If the bed does not fit, if its file is wrong, or if the start is the end of another run; the same for all parts.
    pub fn initial_bed(&self, part: BedPart) -> Result<InitialBed, BedError> {
        let check_sizes = |sizes: &SizeRange| self.check_sizes(sizes);
        let (particles, domain) = (&self.particles, &self.domain);
        let plan = BedPlan { particles, domain, check_sizes: &check_sizes };
        beds::build(&plan, part).map_err(|problem| match problem {
            BedProblem::Keys(wrong) => self.places.errors(wrong).into(),
            other => BedError::Bed(other),
        })
    }
}
