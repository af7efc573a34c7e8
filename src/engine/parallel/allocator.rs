//! An allocator that places large arrays in large pages and returns freed memory to the system. When there is no more
//! memory, the program reports how much it requested, and all ranks end.

#![allow(unsafe_code, reason = "an allocator hands out raw memory")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::fs::File;
use std::io::{Read, Write};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Exit code of all ranks; the same as for any other error.
const CODE: i32 = 1;
/// Time for the message, and for the end of all ranks.
const TIME_TO_END: Duration = Duration::from_secs(1);

/// This process among others: its rank, and a function that ends all of them with an exit code. Not set if this process
/// is alone.
static PROCESS: OnceLock<(usize, fn(i32))> = OnceLock::new();
/// Whether the message is being printed.
static ENDING: AtomicBool = AtomicBool::new(false);

/// The system's allocator, which requests large pages for large arrays. When it has no memory left, a message is
/// printed and all ranks end, whereas Rust's default is to abort this process.
#[derive(Clone, Copy, Debug, Default)]
pub struct AllocatorOfRanks;

/// Size from which arrays are large, in bytes. Large arrays are placed in large pages if possible (2 MiB on most
/// machines; smaller arrays would have too few of them), and return to the system as soon as they are freed. Smaller
/// arrays, such as those of a rank with up to some 20,000 particles, are kept for reuse, so that new lists need no
/// memory from the system.
#[cfg(target_os = "linux")]
const LARGE: usize = 4 << 20;

impl AllocatorOfRanks {
    /// Lets large arrays return to the system when they are freed. By default glibc keeps freed arrays below 32 MB,
    /// which leaves holes that the next arrays seldom fit into: a fifth of the peak memory of a large bed. To be called
    /// at the start of the program; with other allocators it does nothing.
    pub fn return_large_arrays() {
        #[cfg(all(target_os = "linux", target_env = "gnu"))]
        // SAFETY: two parameters of the allocator are set. The second is twice the first, as in glibc itself.
        unsafe {
            libc::mallopt(libc::M_MMAP_THRESHOLD, LARGE as libc::c_int);
            libc::mallopt(libc::M_TRIM_THRESHOLD, 2 * LARGE as libc::c_int);
        }
    }

    /// Returns freed memory to the system, where the allocator can do so (glibc). It is called after large temporary
    /// arrays that are not needed again soon: at a start or after a checkpoint.
    pub fn return_freed() {
        #[cfg(all(target_os = "linux", target_env = "gnu"))]
        // SAFETY: the function may be called at any time, from any thread.
        unsafe {
            libc::malloc_trim(0);
        }
    }
}

/// Registers this process as one rank of several, with a function that ends them all.
#[cfg(feature = "mpi")]
pub(super) fn set_process(rank: usize, end_all: fn(i32)) {
    // Ranks start once in a process.
    let _ = PROCESS.set((rank, end_all));
}

#[cfg(target_os = "linux")]
impl AllocatorOfRanks {
    /// Moves an array to a new place of this many bytes.
    ///
    /// # Safety
    /// Requirements as for [`GlobalAlloc::realloc`].
    #[cold]
    unsafe fn moved(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller promises a size that is not 0 and does not overflow with this alignment, and gives up the
        // old place; both places have at least the smaller of the two sizes.
        unsafe {
            let new = self.alloc(Layout::from_size_align_unchecked(size, layout.align()));
            std::ptr::copy_nonoverlapping(memory, new, size.min(layout.size()));
            self.dealloc(memory, layout);
            new
        }
    }
}

// SAFETY: the system's allocator does all the work, and receives the same requests as this one.
unsafe impl GlobalAlloc for AllocatorOfRanks {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promises are those that the system's allocator needs; the same holds below.
        given(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        given(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        #[cfg(target_os = "linux")]
        if moves_to_large_pages(layout, size) {
            // SAFETY: the caller's promises are those of this call.
            return unsafe { self.moved(memory, layout, size) };
        }
        // SAFETY: as above.
        given(unsafe { System.realloc(memory, layout, size) }, size)
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(memory, layout) }
    }
}

/// Checks the memory that the system gave for this many bytes. If there is none, all ranks end; if the array is large,
/// large pages are requested for it.
#[inline]
fn given(memory: *mut u8, size: usize) -> *mut u8 {
    if memory.is_null() {
        end_all_ranks(size);
    }
    #[cfg(target_os = "linux")]
    if size >= LARGE {
        ask_for_large_pages(memory, size);
    }
    memory
}

/// Requests large pages for an array, which the system may refuse. Allocates nothing.
#[cfg(target_os = "linux")]
#[cold]
fn ask_for_large_pages(memory: *mut u8, size: usize) {
    // SAFETY: a number is read.
    let page = match unsafe { libc::sysconf(libc::_SC_PAGESIZE) } {
        page if page > 0 => page as usize,
        _ => return,
    };
    // The request is for whole pages. The first and the last may hold other arrays too, which are left as they are.
    let before = memory as usize % page;
    // SAFETY: the range lies in memory of this process, whose contents do not change whether the system follows or not.
    unsafe {
        libc::madvise(memory.sub(before).cast(), size + before, libc::MADV_HUGEPAGE);
    }
}

/// Whether an array is moved when it grows to this many bytes: if it becomes large, or if the system's allocator would
/// move it because of its alignment and fill small pages before large ones are requested. Otherwise a large array keeps
/// its large pages.
#[cfg(target_os = "linux")]
#[inline]
fn moves_to_large_pages(layout: Layout, size: usize) -> bool {
    /// Alignment of every array of the system; bytes.
    const ALIGNED: usize = 2 * size_of::<usize>();
    size >= LARGE && (layout.size() < LARGE || layout.align() > ALIGNED)
}

/// Prints the message and ends all ranks. Allocates nothing.
#[cold]
fn end_all_ranks(size: usize) -> ! {
    if ENDING.swap(true, Ordering::SeqCst) {
        // Another thread has no memory either, and leaves the first the time to print; or what ends the ranks has none.
        std::thread::sleep(TIME_TO_END);
        signal_hook::low_level::exit(CODE);
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

/// Bytes of this process in the machine's memory; 0 if that is not known.
fn resident() -> usize {
    let mut text = [0_u8; 4096];
    let read = File::open("/proc/self/status").and_then(|mut file| file.read(&mut text));
    let text = std::str::from_utf8(&text[..read.unwrap_or(0)]).unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let kilobytes = line.and_then(|line| line.trim().strip_suffix("kB")?.trim().parse().ok());
    1024 * kilobytes.unwrap_or(0_usize)
}

#[cfg(all(test, target_os = "linux"))]
#[allow(clippy::unwrap_used, reason = "in tests a panic is the report")]
mod tests {
    use super::*;

    /// Whether large pages were requested for the memory that begins here; `None` if the system does not report it.
    fn asked_for(memory: *const u8) -> Option<bool> {
        std::fs::metadata("/sys/kernel/mm/transparent_hugepage").ok()?;
        let maps = std::fs::read_to_string("/proc/self/smaps").ok()?;
        let holds = |line: &str| {
            let range = line.split(' ').next()?.split_once('-')?;
            let [from, to] = [range.0, range.1].map(|end| usize::from_str_radix(end, 16));
            Some((from.ok()?..to.ok()?).contains(&(memory as usize)))
        };
        let flags = maps
            .lines()
            .skip_while(|line| holds(line) != Some(true))
            .find_map(|line| line.strip_prefix("VmFlags:"));
        Some(flags.unwrap().split_whitespace().any(|flag| flag == "hg"))
    }

    /// Keeps large arrays separate from now on, as in the program: small ones are not placed where a large one was.
    fn begin() {
        AllocatorOfRanks::return_large_arrays();
    }

    fn is_in(large: bool, memory: *const u8) {
        assert_eq!(asked_for(memory).unwrap_or(large), large);
    }

    /// Runs a test again in a process of its own, in which no other test has freed a large array; returns whether this
    /// is that process.
    fn is_alone(test: &str) -> bool {
        const ALONE: &str = "TALCUM_TEST_IS_ALONE";
        if std::env::var_os(ALONE).is_some() {
            return true;
        }
        let mut again = std::process::Command::new(std::env::current_exe().unwrap());
        let name = format!("parallel::allocator::tests::{test}");
        let found = again.args([&name, "--exact"]).env(ALONE, "1").output().unwrap();
        let text = String::from_utf8_lossy(&found.stdout);
        assert!(found.status.success() && text.contains("1 passed"), "{text}");
        false
    }

    #[test]
    fn large_arrays_are_asked_to_lie_in_large_pages() {
        if !is_alone("large_arrays_are_asked_to_lie_in_large_pages") {
            return;
        }
        begin();
        for align in [1, 16, 64, 4096] {
            let layout = |size| Layout::from_size_align(size, align).unwrap();
            // SAFETY: each array is used with its own layout, and freed once.
            unsafe {
                let small = AllocatorOfRanks.alloc(layout(LARGE / 4));
                is_in(false, small);
                AllocatorOfRanks.dealloc(small, layout(LARGE / 4));
                let large = AllocatorOfRanks.alloc_zeroed(layout(LARGE));
                is_in(true, large.add(LARGE / 2));
                AllocatorOfRanks.dealloc(large, layout(LARGE));
            }
        }
    }

    #[test]
    fn arrays_that_grow_large_keep_what_they_hold() {
        begin();
        for align in [1, 16, 64, 4096] {
            let layout = |size| Layout::from_size_align(size, align).unwrap();
            let value = |i: usize| (i % 251) as u8;
            let sizes = [LARGE / 4, LARGE / 2, LARGE + 3, 3 * LARGE, LARGE, 1000];
            // SAFETY: each array is used with its own layout, read where it was written, and freed once.
            unsafe {
                let mut memory = AllocatorOfRanks.alloc(layout(sizes[0]));
                (0..sizes[0]).for_each(|i| memory.add(i).write(value(i)));
                for pair in sizes.windows(2) {
                    memory = AllocatorOfRanks.realloc(memory, layout(pair[0]), pair[1]);
                    assert_eq!(memory as usize % align, 0);
                    assert!(
                        (0..pair[0].min(pair[1]).min(sizes[0]))
                            .all(|i| memory.add(i).read() == value(i))
                    );
                    if pair[1] >= LARGE {
                        is_in(true, memory.add(LARGE / 2));
                    }
                }
                AllocatorOfRanks.dealloc(memory, layout(sizes[sizes.len() - 1]));
            }
        }
    }
}
