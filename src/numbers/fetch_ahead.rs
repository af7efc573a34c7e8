//! Prefetching of memory that will soon be used.

/// Bytes of a cache line.
const LINE: usize = 64;

/// Prefetches a value that will soon be read or changed. It has no effect but on speed, and none at all on processors
/// other than x86-64.
#[inline(always)]
pub(crate) fn fetch_ahead<T>(value: &T) {
    #[cfg(target_arch = "x86_64")]
    for offset in (0..size_of::<T>()).step_by(LINE) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let address = std::ptr::from_ref(value).cast::<i8>().wrapping_add(offset);
        // SAFETY: a prefetch is a hint. It neither reads nor writes, and does not fault, whatever the address, which is
        // moreover within `value` (its first byte, or a whole number of lines after it). SSE, which has the instruction, is
        // part of every x86-64 processor.
        #[allow(unsafe_code, reason = "a prefetch instruction, which accesses nothing")]
        unsafe {
            _mm_prefetch::<_MM_HINT_T0>(address);
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (value, LINE);
}
