//! What is freed returns to the system. When there is no more memory, the program says how much it asked for, and all ranks end.

#![allow(unsafe_code, reason = "an allocator hands out raw memory")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::fs::File;
use std::io::{Read, Write};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// Exit code of all ranks, that of any other error.
const CODE: i32 = 1;

/// This process among others: its rank, and how to end all of them with an exit code. Not set where this process is alone.
static PROCESS: OnceLock<(usize, fn(i32))> = OnceLock::new();
/// Whether the message is on its way.
static ENDING: AtomicBool = AtomicBool::new(false);

/// The system's allocator. Where it has no memory left, a message is printed and all ranks end, while Rust's own way is to
/// crash this process.
#[derive(Clone, Copy, Debug, Default)]
pub struct AllocatorOfRanks;

/// Arrays of this many bytes are returned to the system as soon as they are freed. Smaller ones, those of a rank with up to some
/// 20,000 particles, are kept for the next, so that new lists need no memory from the system.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const RETURNED: libc::c_int = 4 << 20;

impl AllocatorOfRanks {
    /// Lets large arrays return to the system when they are freed. By itself glibc keeps what is freed below 32 MB, holes that the
    /// next arrays seldom fit into: a fifth of the most that a large bed takes. To be called at the start of the program;
    /// with other allocators nothing happens.
    pub fn return_large_arrays() {
        #[cfg(all(target_os = "linux", target_env = "gnu"))]
        // SAFETY: two numbers of the allocator are set. The second is twice the first, as glibc itself has them.
        unsafe {
            libc::mallopt(libc::M_MMAP_THRESHOLD, RETURNED);
            libc::mallopt(libc::M_TRIM_THRESHOLD, 2 * RETURNED);
        }
    }

    /// Returns to the system what was freed, where the allocator can do that (glibc): after something large that does not come again
    /// soon, a start or a checkpoint.
    pub(crate) fn return_freed() {
        #[cfg(all(target_os = "linux", target_env = "gnu"))]
        // SAFETY: it may be called at any time, from any thread.
        unsafe {
            libc::malloc_trim(0);
        }
    }
}

/// Says that this process is one rank of several, and how to end them all.
#[cfg(feature = "mpi")]
pub(super) fn set_process(rank: usize, end_all: fn(i32)) {
    // Ranks start once in a process.
    let _ = PROCESS.set((rank, end_all));
}

// SAFETY: the system's allocator does all the work, and is asked for exactly what this one is asked for.
unsafe impl GlobalAlloc for AllocatorOfRanks {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promises are those that the system's allocator needs; so below.
        or_end(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        or_end(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as above.
        or_end(unsafe { System.realloc(memory, layout, size) }, size)
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(memory, layout) }
    }
}

#[inline]
fn or_end(memory: *mut u8, size: usize) -> *mut u8 {
    if memory.is_null() {
        end_all_ranks(size);
    }
    memory
}

/// Allocates nothing.
#[cold]
fn end_all_ranks(size: usize) -> ! {
    if ENDING.swap(true, Ordering::SeqCst) {
        std::process::abort();
    }
    let mut text = [0_u8; 400];
    let mut rest = &mut text[..];
    let [has, refused] = [resident(), size].map(|bytes| 1.0e-6 * bytes as f64);
    // The text is short enough, and nothing is left to do if standard error is closed.
    let _ = match PROCESS.get() {
        Some((rank, _)) => write!(rest, "error: rank {rank} is out of memory: it"),
        None => write!(rest, "error: out of memory: the program"),
    };
    let _ = writeln!(
        rest,
        " has {has:.0} MB and was refused {refused:.0} MB more. Use more machines, or fewer ranks on each; talcum check \
         estimates what a case needs"
    );
    let left = rest.len();
    let _ = std::io::stderr().write_all(&text[..text.len() - left]);
    if let Some((_, end_all)) = PROCESS.get() {
        end_all(CODE);
    }
    super::end_at_once(CODE)
}

/// Bytes of this process in the machine's memory; 0 where that is not known.
fn resident() -> usize {
    let mut text = [0_u8; 4096];
    let read = File::open("/proc/self/status").and_then(|mut file| file.read(&mut text));
    let text = std::str::from_utf8(&text[..read.unwrap_or(0)]).unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let kilobytes = line.and_then(|line| line.trim().strip_suffix("kB")?.trim().parse().ok());
    1024 * kilobytes.unwrap_or(0_usize)
}
