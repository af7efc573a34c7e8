//! The vector instructions that the program uses.

use std::sync::OnceLock;
use thiserror::Error;

/// Sets of vector instructions, from the narrowest to the widest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum InstructionSet {
    /// The instructions that every processor of the target has.
    Baseline,
    /// AVX2 of x86-64.
    Avx2,
    /// AVX-512 of x86-64: its parts F, VL, BW and DQ.
    Avx512,
}

/// The environment variable that narrows the choice, for tests and comparisons.
const VARIABLE: &str = "TALCUM_VECTORS";

/// A value of the variable that names no set.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("the environment variable {VARIABLE} = \"{0}\": must be baseline, avx2 or avx512")]
pub struct UnknownInstructionSet(String);

impl InstructionSet {
    /// The widest set that this processor has.
    #[cfg(target_arch = "x86_64")]
    fn of_this_processor() -> Self {
        use std::arch::is_x86_feature_detected as has;
        let has_avx512 =
            has!("avx512f") && has!("avx512vl") && has!("avx512bw") && has!("avx512dq");
        if !has!("avx2") {
            Self::Baseline
        } else if has_avx512 {
            Self::Avx512
        } else {
            Self::Avx2
        }
    }

    /// The widest set that this processor has.
    #[cfg(not(target_arch = "x86_64"))]
    fn of_this_processor() -> Self {
        Self::Baseline
    }

    /// Its name in `TALCUM_VECTORS`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Baseline => "baseline",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    fn named(name: &str) -> Result<Self, UnknownInstructionSet> {
        let mut all = [Self::Baseline, Self::Avx2, Self::Avx512].into_iter();
        all.find(|set| set.name() == name).ok_or_else(|| UnknownInstructionSet(name.to_owned()))
    }

    /// The widest set that is allowed.
    fn allowed() -> Result<Self, UnknownInstructionSet> {
        std::env::var(VARIABLE).map_or(Ok(Self::Avx512), |name| Self::named(&name))
    }
}

/// The widest set that the processor has and that `TALCUM_VECTORS` allows; chosen once.
#[inline]
pub fn instruction_set() -> InstructionSet {
    static CHOSEN: OnceLock<InstructionSet> = OnceLock::new();
    *CHOSEN.get_or_init(|| {
        let allowed = InstructionSet::allowed().unwrap_or(InstructionSet::Avx512);
        InstructionSet::of_this_processor().min(allowed)
    })
}

/// Rejects a value of `TALCUM_VECTORS` that names no set.
///
/// # Errors
/// If it is neither `baseline`, `avx2` nor `avx512`.
pub fn check_instruction_set() -> Result<(), UnknownInstructionSet> {
    InstructionSet::allowed().map(|_| ())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_named_from_the_narrowest_to_the_widest() {
        let found = ["baseline", "avx2", "avx512"].map(|name| InstructionSet::named(name).unwrap());
        assert!(found.is_sorted());
        let error = InstructionSet::named("AVX").unwrap_err().to_string();
        assert!(error.contains("TALCUM_VECTORS = \"AVX\": must be baseline, avx2 or avx512"));
    }

    #[test]
    fn the_chosen_set_is_one_that_the_processor_has() {
        assert!(instruction_set() <= InstructionSet::of_this_processor());
    }
}
