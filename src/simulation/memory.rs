//! Memory that the allocator keeps without need.

/// Gives memory that was freed back to the system, where the allocator can do that (the GNU C library). After
/// something large that does not come again soon: a start, a checkpoint.
#[allow(unsafe_code, reason = "the standard library has no function for this")]
pub(super) fn give_back() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: it may be called at any time, from any thread.
    unsafe {
        libc::malloc_trim(0);
    }
}
