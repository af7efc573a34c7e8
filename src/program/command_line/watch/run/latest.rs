//! Reading of files that grow at the same time.

use super::listing::Version;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Pause between two readings of a file, relative to the duration of one: for any length of the run, reading takes at
/// most a twentieth of a core.
const REST: u32 = 20;
/// Number of successive readings that may fail before a warning: the run may be in the middle of a write.
const FORGIVEN: u32 = 3;

/// The newest good reading of a file. A failed reading leaves the previous one in place.
#[derive(Debug)]
pub(super) struct Latest<T> {
    read: Option<(PathBuf, Version)>,
    value: Option<T>,
    failures: u32,
    error: String,
    next: Option<Instant>,
}

impl<T> Default for Latest<T> {
    fn default() -> Self {
        Self { read: None, value: None, failures: 0, error: String::new(), next: None }
    }
}

impl<T> Latest<T> {
    /// Reads the file if it has changed. Without a file there is no value.
    pub(super) fn renew<E: Display>(
        &mut self,
        file: Option<(PathBuf, Version)>,
        read: impl FnOnce(&Path) -> Result<T, E>,
    ) {
        let Some((path, version)) = file else {
            *self = Self::default();
            return;
        };
        let is_known = self.read.as_ref().is_some_and(|known| *known == (path.clone(), version));
        if is_known || self.next.is_some_and(|next| Instant::now() < next) {
            return;
        }
        let begin = Instant::now();
        match read(&path) {
            Ok(value) => {
                (self.value, self.failures) = (Some(value), 0);
                self.read = Some((path, version));
            }
            Err(error) => {
                self.failures += 1;
                self.error = error.to_string();
            }
        }
        self.next = Some(Instant::now() + REST * begin.elapsed());
    }

    pub(super) fn value(&self) -> Option<&T> {
        self.value.as_ref()
    }

    /// The last reading, with the version of the file.
    pub(super) fn read(&self) -> Option<(&T, Version)> {
        Some((self.value.as_ref()?, self.read.as_ref()?.1))
    }

    /// The reason why the file cannot be read: reported at once if it never could be read, otherwise after some
    /// attempts.
    pub(super) fn complaint(&self) -> Option<&str> {
        let limit = if self.value.is_some() { FORGIVEN } else { 1 };
        (self.failures >= limit).then_some(self.error.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command_line::watch::run::listing::Listing;
    use std::fs;
    use std::time::Duration;

    fn look(latest: &mut Latest<u32>, path: &Path) -> Option<u32> {
        let version = Listing::of(path.parent().unwrap()).unwrap().version("number");
        // A reading of some microseconds requires a pause of some more.
        std::thread::sleep(Duration::from_millis(20));
        latest.renew(version.map(|version| (path.to_owned(), version)), |path| {
            fs::read_to_string(path).unwrap().parse::<u32>()
        });
        latest.value().copied()
    }

    #[test]
    fn a_reading_that_fails_leaves_the_one_before_and_complains_in_the_end() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("number");
        let mut latest = Latest::default();
        assert_eq!((look(&mut latest, &path), latest.complaint()), (None, None));
        fs::write(&path, "half-written").unwrap();
        assert_eq!(look(&mut latest, &path), None);
        assert!(latest.complaint().unwrap().contains("invalid digit"));
        fs::write(&path, "17").unwrap();
        assert_eq!((look(&mut latest, &path), latest.complaint()), (Some(17), None));
        fs::write(&path, "half-written").unwrap();
        for complains in [false, false, true] {
            assert_eq!(look(&mut latest, &path), Some(17));
            assert_eq!(latest.complaint().is_some(), complains);
        }
        fs::remove_file(&path).unwrap();
        assert_eq!((look(&mut latest, &path), latest.complaint()), (None, None));
    }

    #[test]
    fn a_file_that_has_not_changed_is_not_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("number");
        fs::write(&path, "1").unwrap();
        let mut latest = Latest::default();
        look(&mut latest, &path);
        let file = latest.read.clone();
        latest.renew(file, |_| -> Result<u32, String> { panic!("it was read again") });
        fs::write(&path, "2").unwrap();
        assert_eq!(look(&mut latest, &path), Some(2));
    }
}
