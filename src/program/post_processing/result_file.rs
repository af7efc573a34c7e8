//! The files of results that analyses read.

use talcum_results::analysis::NoValue;
use talcum_runs::case::Case;

/// A file of results, and the key of the case that gives it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ResultFile {
    Series,
    Profiles,
    Particles,
    Gas,
}

impl ResultFile {
    /// Its name in the folder of results.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Series => "series.csv",
            Self::Profiles => "profiles.h5",
            Self::Particles => "particles.vtkhdf",
            Self::Gas => "gas.vtkhdf",
        }
    }

    /// The message that there is no such file, with the key that would give it.
    pub(super) fn absent(self) -> NoValue {
        let key = match self {
            Self::Series => "output.series",
            Self::Profiles => "output.profiles",
            Self::Particles => "output.particles",
            Self::Gas => "output.gas, of a volume-averaged gas,",
        };
        let name = self.name();
        NoValue::because(format!("there is no {name}: the key {key} of the case would give it"))
    }

    /// Whether a run of this case writes it.
    ///
    /// # Errors
    /// If not.
    pub(super) fn require_of(self, case: &Case) -> Result<(), NoValue> {
        let plan = &case.output;
        let is_written = match self {
            Self::Series => true,
            Self::Profiles => plan.profiles.is_some(),
            Self::Particles => plan.particles.is_some(),
            Self::Gas => plan.gas.is_some(),
        };
        if is_written { Ok(()) } else { Err(self.absent()) }
    }
}
