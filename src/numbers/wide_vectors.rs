//! The same code compiled for two instruction sets, of which one is chosen at run time.

use super::vectorised;

/// Work on many numbers. `run`, and all it calls, must be `#[inline(always)]`: only what is inlined is compiled
/// for wider vectors (a closure would not be).
///
/// Two rules keep the loop over a row free of what is not arithmetic, which would take longer than a short row itself:
/// * It lies in a function of its own that takes each row it writes to as an argument `&mut [T]`. The compiler then knows that the
///   row overlaps with no other, and compares no addresses at run time.
/// * It counts `0..n`, and all rows are slices of one length, cut with the same variable. A bounds check that is left in the loop sends
///   the last cells of each row, at least one of them, through a loop without vectors.
pub(crate) trait VectorWork {
    /// What it returns.
    type Output;

    /// Does the work.
    fn run(self) -> Self::Output;
}

vectorised!(
    /// Runs work compiled for AVX2 if the processor has it.
    pub(crate) fn in_wide_vectors<W: VectorWork>(work: W) -> W::Output {
        work.run()
    }
);
