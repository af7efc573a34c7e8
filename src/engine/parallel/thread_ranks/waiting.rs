//! Waiting of threads for each other: they check for a moment, and then sleep until they are woken.
//!
//! A thread that changes a value for which another may wait wakes it afterwards. Both sides are sequentially
//! consistent: either the waiting thread sees the change after it has announced its sleep, or the changing thread sees
//! that it sleeps.
//!
//! The number of checks before a sleep is adapted to earlier waits. If each thread has a core of its own, the others
//! need only a few microseconds more, and waking would take longer than that. If threads, or programs, share cores, the
//! other thread may not even run, and checking keeps it from its core. Yielding to others (`sched_yield`) was worse
//! than either: Linux then puts the thread behind all others, for milliseconds (measured: eight times the time of
//! sleeping at once, on two cores with ten programs).

use std::hint::spin_loop;
use std::panic::resume_unwind;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::thread::{Thread, current, park};
use std::time::{Duration, Instant};

/// Smallest number of checks before a thread sleeps, about a microsecond, and largest, about 100 microseconds.
const LOOKS: [u32; 2] = [50, 4000];
/// After a sleep shorter than this, a thread checks for longer the next time: waking takes about as long.
const SHORT: Duration = Duration::from_micros(100);

/// The panic payload of a thread that waited for another rank when that ended.
pub(super) struct RankLost;

/// All ranks, as waiting threads.
pub(super) struct Waiters(Vec<Member>);

#[derive(Default)]
#[repr(align(128))]
struct Member {
    thread: OnceLock<Thread>,
    sleeps: AtomicBool,
    has_ended: AtomicBool,
    /// Number of checks before it sleeps; only its own thread uses it.
    looks: AtomicU32,
}

impl Waiters {
    pub(super) fn new(n: usize) -> Self {
        Self(
            (0..n)
                .map(|_| Member { looks: AtomicU32::new(LOOKS[1]), ..Default::default() })
                .collect(),
        )
    }

    /// Records that a rank begins; called by its thread.
    pub(super) fn enter(&self, rank: usize) {
        let _ = self.0[rank].thread.set(current());
    }

    /// Records that a rank has ended.
    pub(super) fn leave(&self, rank: usize) {
        self.0[rank].has_ended.store(true, Ordering::SeqCst);
        (0..self.0.len()).for_each(|other| self.wake(other));
    }

    /// Makes a rank check its condition again.
    pub(super) fn wake(&self, rank: usize) {
        let member = &self.0[rank];
        if member.sleeps.load(Ordering::SeqCst)
            && let Some(thread) = member.thread.get()
        {
            thread.unpark();
        }
    }

    /// Waits on one rank until another has made a condition true. Ends the waiting rank, by [`RankLost`], if the other
    /// has ended before.
    pub(super) fn wait(&self, rank: usize, other: usize, is_so: impl Fn() -> bool) {
        let looks = &self.0[rank].looks;
        let most = looks.load(Ordering::Relaxed);
        for _ in 0..most {
            if is_so() {
                return;
            }
            spin_loop();
        }
        let begin = Instant::now();
        self.sleep(rank, other, is_so);
        let next = if begin.elapsed() < SHORT { 2 * most } else { most / 2 };
        looks.store(next.clamp(LOOKS[0], LOOKS[1]), Ordering::Relaxed);
    }

    fn sleep(&self, rank: usize, other: usize, is_so: impl Fn() -> bool) {
        let sleeps = &self.0[rank].sleeps;
        sleeps.store(true, Ordering::SeqCst);
        loop {
            // Changes that the other made before it ended count.
            let is_lost = self.0[other].has_ended.load(Ordering::SeqCst);
            if is_so() {
                break;
            }
            if is_lost {
                resume_unwind(Box::new(RankLost));
            }
            park();
        }
        sleeps.store(false, Ordering::SeqCst);
    }
}
