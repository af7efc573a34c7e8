//! State of a run.

use crate::command_line::progress::readable;
use std::path::Path;
use std::time::{Duration, SystemTime};
use talcum_results::output::{lock, read_text};

/// Age of a file up to which a process that has ended may have written it.
const JUST_NOW: Duration = Duration::from_secs(5);

/// State of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in super::super) enum RunState {
    /// It has not written anything yet.
    Waiting,
    /// It is in progress.
    Running {
        /// The holder of the lock, if it is known.
        holder: Option<String>,
    },
    /// It seems to be in progress, but has not written for a long time.
    Quiet {
        /// The holder of the lock, if it is known.
        holder: Option<String>,
        /// Time since it last wrote.
        silence: Duration,
    },
    /// It was stopped before its end.
    Stopped,
    /// It has died: its lock exists, but its process does not.
    Died {
        /// The holder of the lock.
        holder: String,
    },
    /// It came to its requested end.
    Complete {
        /// Digest of the last state.
        digest: String,
    },
}

impl RunState {
    /// One word, by which the page identifies it.
    pub(in super::super) fn word(&self) -> &'static str {
        match self {
            Self::Waiting => "waiting",
            Self::Running { .. } => "running",
            Self::Quiet { .. } => "quiet",
            Self::Stopped => "stopped",
            Self::Died { .. } => "died",
            Self::Complete { .. } => "complete",
        }
    }

    /// Its description for the user.
    pub(in super::super) fn text(&self) -> String {
        let name = |holder: &Option<String>| match holder {
            Some(holder) => format!(": {holder}"),
            None => String::new(),
        };
        match self {
            Self::Waiting => "waiting: nothing has been written yet".to_owned(),
            Self::Running { holder } => format!("running{}", name(holder)),
            Self::Quiet { holder, silence } => {
                let silence = readable(silence.as_secs_f64());
                format!("nothing written for {silence}{}", name(holder))
            }
            Self::Stopped => {
                "stopped before its end; `talcum run --resume` continues it".to_owned()
            }
            Self::Died { holder } => {
                format!("died: {holder}, is gone; `talcum run --resume` continues it")
            }
            Self::Complete { digest } => format!("complete, digest {digest}"),
        }
    }

    /// Whether further rows are expected.
    pub(in super::super) fn is_active(&self) -> bool {
        matches!(self, Self::Running { .. } | Self::Quiet { .. })
    }
}

/// Marks that show the state of a run.
#[derive(Clone, Debug, Default)]
pub(super) struct Marks {
    /// The digest in the mark of completion.
    pub(super) complete: Option<String>,
    /// The holder named in the lock.
    pub(super) holder: Option<String>,
    /// Whether that process still exists, if this can be determined from here.
    pub(super) is_alive: Option<bool>,
    /// Whether files have grown without a lock, because the file system has none.
    pub(super) grows_without_lock: bool,
    /// Time at which the run last wrote.
    pub(super) last_write: Option<SystemTime>,
}

impl Marks {
    /// Reads the marks of completion and of the lock. The lock itself is not taken: a run that begins at this instant
    /// must find it free.
    pub(super) fn read(folder: &Path) -> Self {
        let mark = read_text(&folder.join("complete")).ok();
        let digest = |line: &str| Some(line.strip_prefix("digest ")?.trim().to_owned());
        let locked = folder.join("running");
        let holder = locked.exists().then(|| lock::holder(&locked));
        Self {
            complete: mark.map(|text| text.lines().find_map(digest).unwrap_or_default()),
            is_alive: holder.as_deref().and_then(lock::is_alive),
            holder,
            ..Self::default()
        }
    }

    /// The state at an instant; a run that has not written for longer than `patience` counts as quiet.
    pub(super) fn state(&self, now: SystemTime, patience: Duration) -> RunState {
        if let Some(digest) = &self.complete {
            return RunState::Complete { digest: digest.clone() };
        }
        let age = |last: SystemTime| now.duration_since(last).unwrap_or(Duration::ZERO);
        let holder = self.holder.clone();
        match (&self.holder, self.last_write) {
            (None, None) => RunState::Waiting,
            (None, Some(_)) if !self.grows_without_lock => RunState::Stopped,
            (Some(gone), last)
                if self.is_alive == Some(false) && last.is_none_or(|last| age(last) > JUST_NOW) =>
            {
                RunState::Died { holder: gone.clone() }
            }
            (_, Some(last)) if age(last) > patience => {
                RunState::Quiet { holder, silence: age(last) }
            }
            _ => RunState::Running { holder },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::UNIX_EPOCH;

    const PATIENCE: Duration = Duration::from_secs(60);

    fn at(seconds: u64) -> SystemTime {
        UNIX_EPOCH + Duration::from_secs(seconds)
    }

    fn word(marks: &Marks) -> &'static str {
        marks.state(at(1_000), PATIENCE).word()
    }

    #[test]
    fn lock_mark_and_last_write_show_what_a_run_is_doing() {
        let locked = Marks {
            holder: Some("process 7 on here".to_owned()),
            is_alive: Some(true),
            last_write: Some(at(990)),
            ..Marks::default()
        };
        assert_eq!(word(&Marks::default()), "waiting");
        assert_eq!(word(&locked), "running");
        assert_eq!(word(&Marks { last_write: None, ..locked.clone() }), "running");
        assert_eq!(word(&Marks { last_write: Some(at(900)), ..locked.clone() }), "quiet");
        assert_eq!(word(&Marks { is_alive: Some(false), ..locked.clone() }), "died");
        // This cannot be determined on another host; but a file that has just been written needs a process.
        assert_eq!(word(&Marks { is_alive: None, ..locked.clone() }), "running");
        let moment_ago =
            Marks { is_alive: Some(false), last_write: Some(at(998)), ..locked.clone() };
        assert_eq!(word(&moment_ago), "running");
        let unlocked = Marks { holder: None, is_alive: None, ..locked.clone() };
        assert_eq!(word(&unlocked), "stopped");
        assert_eq!(word(&Marks { grows_without_lock: true, ..unlocked }), "running");
        assert_eq!(word(&Marks { complete: Some("12ab".to_owned()), ..locked }), "complete");
    }

    #[test]
    fn marks_are_read_without_touching_the_lock() {
        let folder = tempfile::tempdir().unwrap();
        let marks = Marks::read(folder.path());
        assert!(marks.holder.is_none() && marks.complete.is_none());
        assert!(!folder.path().join("running").exists());
        std::fs::write(folder.path().join("complete"), "digest 0123\n").unwrap();
        let held = lock::try_lock(&folder.path().join("running"), lock::Sharing::Exclusive);
        lock::sign(&held.unwrap().unwrap());
        let marks = Marks::read(folder.path());
        assert_eq!((marks.complete.as_deref(), marks.is_alive), (Some("0123"), Some(true)));
    }
}
