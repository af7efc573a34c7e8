//! Flags of the lanes of a vector loop.

/// Whether a flag is not 0.
#[inline(always)]
pub(crate) fn any_flagged(flags: &[u64]) -> bool {
    flags.iter().fold(0, |any, flag| any | flag) != 0
}

/// Index of the first flag that is not 0. A single test of all flags together comes first, since nearly always there is
/// none.
#[inline(always)]
pub(crate) fn first_flagged<const N: usize>(flags: &[u64; N]) -> Option<usize> {
    if any_flagged(flags) { search(flags) } else { None }
}

/// The search itself. It is not inlined, because the test above would then not be vectorised.
#[cold]
#[inline(never)]
fn search(flags: &[u64]) -> Option<usize> {
    flags.iter().position(|&flag| flag != 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_of_several_flags_is_found() {
        assert_eq!(first_flagged(&[0; 8]), None);
        assert_eq!(first_flagged(&[0, 0, 1, 0, 1 << 63]), Some(2));
        assert_eq!(first_flagged(&[0, 0, 0, 1 << 63]), Some(3));
    }
}
