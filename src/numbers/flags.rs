//! Flags of things that are worked on side by side.

/// The first flag that is not 0; nearly always there is none, which one look at all together tells.
#[inline(always)]
pub fn first_flagged<const N: usize>(flags: &[u64; N]) -> Option<usize> {
    let mut any = 0;
    for flag in flags {
        any |= flag;
    }
    if any == 0 { None } else { search(flags) }
}

/// Apart from the look at all: where both are compiled together, that one is not done in vector instructions.
#[cold]
#[inline(never)]
fn search(flags: &[u64]) -> Option<usize> {
    flags.iter().position(|&flag| flag != 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_of_several_is_found() {
        assert_eq!(first_flagged(&[0; 8]), None);
        assert_eq!(first_flagged(&[0, 0, 1, 0, 1 << 63]), Some(2));
        assert_eq!(first_flagged(&[0, 0, 0, 1 << 63]), Some(3));
    }
}
