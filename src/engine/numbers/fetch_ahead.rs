//! Prefetching of memory that will soon be used.

/// Bytes of a cache line.
const LINE: usize = 64;

/// Prefetches an item that will soon be read or changed. It only affects speed, and has no effect on processors other
/// than x86-64. The index is not checked, which saves time and does no harm if there is no such item.
#[inline(always)]
pub(crate) fn fetch_ahead<T>(items: &[T], index: usize) {
    let item = items.as_ptr().wrapping_add(index).cast::<i8>();
    (0..size_of::<T>()).step_by(LINE).for_each(|offset| fetch_line(item.wrapping_add(offset)));
}

/// Prefetches one of `PARTS` parts of a value. All parts have the same number of lines, which is known to the compiler,
/// so that the last part may reach beyond the value.
#[inline(always)]
pub(crate) fn fetch_part_ahead<const PARTS: usize, T>(value: &T, part: usize) {
    let lines = const { size_of::<T>().div_ceil(LINE).div_ceil(PARTS) };
    let first = std::ptr::from_ref(value).cast::<i8>().wrapping_add(part * lines * LINE);
    (0..lines).for_each(|line| fetch_line(first.wrapping_add(line * LINE)));
}

#[inline(always)]
fn fetch_line(address: *const i8) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: a prefetch is a hint. It neither reads nor writes, and does not fault, whatever the address. SSE,
        // which has the instruction, is part of every x86-64 processor.
        #[allow(unsafe_code, reason = "a prefetch instruction, which accesses nothing")]
        unsafe {
            _mm_prefetch::<_MM_HINT_T0>(address);
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = address;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prefetching_beyond_the_items_does_no_harm() {
        let items = [[1.0_f64; 24]; 3];
        for index in [0, 2, 3, 1 << 40, usize::MAX] {
            fetch_ahead(&items, index);
        }
        (0..8).for_each(|part| fetch_part_ahead::<8, _>(&items, part));
        assert_eq!(items, [[1.0; 24]; 3]);
    }
}
