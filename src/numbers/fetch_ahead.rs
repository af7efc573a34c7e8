//! Hints on memory that will soon be needed.

/// Bytes that come from memory together.
const LINE: usize = 64;

/// Asks for a value that will soon be read or changed. Changes nothing; does nothing on processors other than
/// x86-64.
#[inline(always)]
pub fn fetch_ahead<T>(value: &T) {
    #[cfg(target_arch = "x86_64")]
    for offset in (0..size_of::<T>()).step_by(LINE) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let address = std::ptr::from_ref(value).cast::<i8>().wrapping_add(offset);
        #[allow(unsafe_code, reason = "a hint, which reads nothing")]
        unsafe {
            _mm_prefetch::<_MM_HINT_T0>(address);
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (value, LINE);
}
