//! How threads wait for each other: they look for a moment, and then sleep until they are woken.
//!
//! Whoever changes what another may wait for wakes it afterwards. Both sides are sequentially consistent: either the
//! one who waits sees the change after it has said that it sleeps, or the one who changes sees that it sleeps.
//!
//! How long a thread looks follows from what it has met. On cores of its own the others need some microseconds more, and
//! to be woken would take longer than that. Where threads, or programs, share cores, the other may not even run, and to
//! look keeps it from its core. To let others run (`sched_yield`) was worse than either: Linux then puts the thread behind
//! all others, for milliseconds (measured: eight times the time of sleeping at once, on two cores with ten programs).

use std::hint::spin_loop;
use std::panic::resume_unwind;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::thread::{Thread, current, park};
use std::time::{Duration, Instant};

/// The fewest checks before a thread sleeps, about a microsecond, and the most, about 100.
const LOOKS: [u32; 2] = [50, 4000];
/// After a sleep shorter than this a thread looks longer the next time: to be woken takes about as long.
const SHORT: Duration = Duration::from_micros(100);

/// The panic payload of a thread that waited for another rank when that ended.
pub(super) struct RankLost;

/// All ranks as those who wait.
pub(super) struct Waiters(Vec<Member>);

#[derive(Default)]
#[repr(align(128))]
struct Member {
    thread: OnceLock<Thread>,
    sleeps: AtomicBool,
    has_ended: AtomicBool,
    /// Looks before it sleeps; only its own thread uses them.
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

    /// A rank begins; called by its thread.
    pub(super) fn enter(&self, rank: usize) {
        let _ = self.0[rank].thread.set(current());
    }

    /// A rank has ended.
    pub(super) fn leave(&self, rank: usize) {
        self.0[rank].has_ended.store(true, Ordering::SeqCst);
        (0..self.0.len()).for_each(|other| self.wake(other));
    }

    /// Makes a rank look again at what it waits for.
    pub(super) fn wake(&self, rank: usize) {
        let member = &self.0[rank];
        if member.sleeps.load(Ordering::SeqCst)
            && let Some(thread) = member.thread.get()
        {
            thread.unpark();
        }
    }

    /// Waits on one rank until another has made something so. Ends the rank that waits, by [`RankLost`], if the other has
    /// ended before.
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
            // What the other did before it ended counts.
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
