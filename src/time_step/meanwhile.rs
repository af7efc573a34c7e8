//! Work that is done while ranks communicate.

use std::time::{Duration, Instant};

/// Communicates; `communicate` calls what it is given once, and that is when other work is done. Returns what the work returned, and
/// how long the rest took.
pub(super) fn with_other_work<T>(
    communicate: impl FnOnce(&mut dyn FnMut()),
    other_work: impl FnOnce() -> T,
) -> (T, Duration) {
    let begin = Instant::now();
    let (mut other_work, mut result, mut took) = (Some(other_work), None, Duration::ZERO);
    communicate(&mut || {
        let begin = Instant::now();
        result = other_work.take().map(|other_work| other_work());
        took = begin.elapsed();
    });
    let result = result.expect("ranks that communicate do the work that is given to them");
    (result, begin.elapsed() - took)
}
