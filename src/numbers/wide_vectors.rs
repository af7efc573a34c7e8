//! The same code compiled for two instruction sets, of which one is chosen at run time.

#[cfg(target_arch = "x86_64")]
use super::{InstructionSet, instruction_set};

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

/// Runs work compiled for the widest vectors that the processor has: AVX2 on x86-64 if it is there, otherwise the
/// instructions that every processor of the target has. Wider ones gain nothing on rows, most of which are short.
///
/// The bits are the same: each operation is rounded once, multiplications and additions are never fused, and the width
/// of a vector is only the number of values that are worked on side by side.
#[inline(always)]
pub(crate) fn in_wide_vectors<W: VectorWork>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if instruction_set() >= InstructionSet::Avx2 {
        // SAFETY: `with_avx2` is safe code, compiled for AVX2; its one requirement is that the processor has AVX2, which
        // was detected.
        #[allow(unsafe_code, reason = "the instruction set is chosen at run time")]
        return unsafe { with_avx2(work) };
    }
    work.run()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn with_avx2<W: VectorWork>(work: W) -> W::Output {
    work.run()
}
