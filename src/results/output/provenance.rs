//! Provenance of results: program, case, machine and time; part of every result.

use std::sync::OnceLock;
use std::time::{SystemTime, UNIX_EPOCH};

use talcum_engine::parallel::Communicator;

/// The commit that the program was built from, once it has said so.
static COMMIT: OnceLock<&str> = OnceLock::new();

/// Names the commit that the program was built from. The libraries do not know it: otherwise each commit would compile them again.
pub fn set_commit(commit: &'static str) {
    let _ = COMMIT.set(commit);
}

/// The commit that the program was built from, or `unknown`.
pub fn commit() -> &'static str {
    COMMIT.get().copied().unwrap_or("unknown")
}

/// Provenance of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Provenance {
    /// Version of Talcum.
    pub version: String,
    /// Commit from which it was built, or `unknown`.
    pub commit: String,
    /// Number of ranks.
    pub ranks: u64,
    /// Kind of ranks: MPI processes, or threads; unknown for files from before this was recorded.
    pub ranks_are: Option<String>,
    /// Rank 0's host, processor and number of cores.
    pub machine: String,
    /// Date and time, UTC.
    pub date: String,
    /// Title of the case.
    pub title: String,
    /// System of units, as named in the case.
    pub units: String,
}

impl Provenance {
    /// Describes this program, the present time and these ranks; equal on all ranks. Collective.
    pub fn here_and_now(title: &str, units: &str, ranks: &dyn Communicator) -> Self {
        let mut here = machine().into_bytes();
        ranks.broadcast_from_root(&mut here);
        let mut now = date(SystemTime::now()).into_bytes();
        ranks.broadcast_from_root(&mut now);
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            commit: commit().to_owned(),
            ranks: ranks.size() as u64,
            ranks_are: Some(ranks.kind().to_owned()),
            machine: String::from_utf8_lossy(&here).into_owned(),
            date: String::from_utf8_lossy(&now).into_owned(),
            title: title.to_owned(),
            units: units.to_owned(),
        }
    }

    /// Names and texts, in the order in which they are printed.
    pub(crate) fn entries(&self) -> [(&'static str, String); 8] {
        [
            ("talcum_version", self.version.clone()),
            ("commit", self.commit.clone()),
            ("ranks", self.ranks.to_string()),
            ("ranks_are", self.ranks_are.clone().unwrap_or_default()),
            ("machine", self.machine.clone()),
            ("date", self.date.clone()),
            ("title", self.title.clone()),
            ("units", self.units.clone()),
        ]
    }
}

/// Host, processor and number of cores.
fn machine() -> String {
    let read = |path: &str| std::fs::read_to_string(path).unwrap_or_default();
    let host = read("/proc/sys/kernel/hostname");
    let host = if host.trim().is_empty() { "unknown host" } else { host.trim() };
    let processors = read("/proc/cpuinfo");
    let processor = processors
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(':'))
        .map_or(std::env::consts::ARCH, |(_, name)| name.trim());
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{host}, {processor}, {cores} cores")
}

/// A time as `2026-11-21 05:06:03 UTC`.
pub(super) fn date(moment: SystemTime) -> String {
    let seconds = moment.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let (year, month, day) = civil_date(seconds / 86_400);
    let [hour, minute, second] = [seconds / 3600 % 24, seconds / 60 % 60, seconds % 60];
    format!("{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02} UTC")
}

/// Year, month and day of a number of days after 1970-01-01 in the Gregorian calendar.
fn civil_date(days: u64) -> (u64, u64, u64) {
    let is_leap = |year: u64| {
        year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400))
    };
    let (mut year, mut left) = (1970, days);
    loop {
        let length = if is_leap(year) { 366 } else { 365 };
        if left < length {
            break;
        }
        left -= length;
        year += 1;
    }
    let february = if is_leap(year) { 29 } else { 28 };
    let mut month = 1;
    for length in [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31] {
        if left < length {
            break;
        }
        left -= length;
        month += 1;
    }
    (year, month, left + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;
    use talcum_engine::parallel::run_on_threads;

    #[test]
    fn dates_are_those_of_the_calendar() {
        let after = |seconds| date(UNIX_EPOCH + Duration::from_secs(seconds));
        assert_eq!(after(0), "1970-01-01 00:00:00 UTC");
        assert_eq!(after(951_782_400), "2000-02-29 00:00:00 UTC");
        assert_eq!(after(1_795_237_563), "2026-11-21 05:06:03 UTC");
        assert_eq!(after(4_107_542_399), "2100-02-28 23:59:59 UTC");
    }

    #[test]
    fn all_ranks_say_the_same() {
        let all = run_on_threads(3, |ranks| Provenance::here_and_now("A bed", "si", ranks));
        assert!(all.iter().all(|one| one == &all[0]));
        assert_eq!((all[0].ranks, all[0].ranks_are.as_deref()), (3, Some("threads")));
        assert!(all[0].machine.contains("cores"));
    }
}
