//! Contents of a folder of results, with the times at which they were written.

use std::collections::BTreeMap;
use std::fmt;
use std::fs::Metadata;
use std::io;
use std::path::Path;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Identifies a version of a growing file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) struct Version {
    length: u64,
    pub(super) modified: SystemTime,
}

impl Version {
    fn of(metadata: &Metadata) -> io::Result<Self> {
        Ok(Self { length: metadata.len(), modified: metadata.modified()? })
    }
}

impl fmt::Display for Version {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let since = self.modified.duration_since(UNIX_EPOCH).unwrap_or(Duration::ZERO);
        write!(formatter, "{}-{}", self.length, since.as_nanos())
    }
}

/// The files of a folder at one instant.
#[derive(Clone, Debug, Default)]
pub(super) struct Listing {
    files: BTreeMap<String, Version>,
}

impl Listing {
    /// Lists a folder.
    ///
    /// # Errors
    /// If it does not exist or is not a folder.
    pub(super) fn of(folder: &Path) -> io::Result<Self> {
        let mut files = BTreeMap::new();
        for entry in std::fs::read_dir(folder)? {
            let entry = entry?;
            // A file that is removed between the two calls is treated as absent.
            let version = entry.metadata().and_then(|metadata| Version::of(&metadata));
            if let (Ok(name), Ok(version)) = (entry.file_name().into_string(), version) {
                files.insert(name, version);
            }
        }
        Ok(Self { files })
    }

    pub(super) fn version(&self, name: &str) -> Option<Version> {
        self.files.get(name).copied()
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.files.contains_key(name)
    }

    /// Whether a run may still begin here: the folder contains no foreign files.
    pub(super) fn is_unused(&self) -> bool {
        self.files.keys().all(|name| name == "running" || name.starts_with('.'))
    }

    /// Time at which the run last wrote; `None` if it has not written yet.
    pub(super) fn last_write(&self) -> Option<SystemTime> {
        let by_run = self.files.iter().filter(|(name, _)| is_written_by_runs(name));
        by_run.map(|(_, version)| version.modified).max()
    }

    /// The newest checkpoint.
    pub(super) fn newest_checkpoint(&self) -> Option<&str> {
        let mut names = self.files.keys().map(String::as_str);
        names.rfind(|name| name.starts_with("checkpoint-") && name.ends_with(".h5"))
    }

    /// Damaged files that a resumed run has set aside.
    pub(super) fn set_aside(&self) -> Vec<&str> {
        let names = self.files.keys().map(String::as_str);
        names.filter(|name| name.contains(".unreadable-")).collect()
    }
}

/// Whether a file is written by runs; others, such as drawings and analysis.h5, come from users.
fn is_written_by_runs(name: &str) -> bool {
    let endings = [".csv", ".h5", ".vtkhdf", ".partial"];
    name != "analysis.h5" && endings.iter().any(|end| name.ends_with(end))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn the_last_write_is_that_of_the_run_not_of_its_readers() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str| {
            fs::write(folder.path().join(name), name).unwrap();
            Listing::of(folder.path()).unwrap()
        };
        assert_eq!(write("spacetime.png").last_write(), None);
        assert_eq!(write("case.toml").last_write(), None);
        let begun = write("walls.csv").last_write();
        assert!(begun.is_some());
        std::thread::sleep(Duration::from_millis(20));
        assert_eq!(write("analysis.h5").last_write(), begun);
        assert!(write("series.csv").last_write() > begun);
    }

    #[test]
    fn checkpoints_are_ordered_and_others_left_out() {
        let folder = tempfile::tempdir().unwrap();
        assert!(Listing::of(folder.path()).unwrap().is_unused());
        for step in ["000000000900", "000000001000", "000000001100"] {
            fs::write(folder.path().join(format!("checkpoint-{step}.h5")), step).unwrap();
        }
        fs::write(folder.path().join("checkpoint-000000001200.h5.superseded"), "").unwrap();
        fs::write(folder.path().join("profiles.h5.unreadable-1"), "").unwrap();
        let listing = Listing::of(folder.path()).unwrap();
        assert_eq!(listing.newest_checkpoint(), Some("checkpoint-000000001100.h5"));
        assert_eq!(listing.set_aside(), ["profiles.h5.unreadable-1"]);
        assert!(!listing.is_unused());
        assert!(Listing::of(&folder.path().join("nowhere")).is_err());
    }
}
