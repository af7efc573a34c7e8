//! Files that are written in one piece: each exists under its name either completely or not at all.

use std::fs::File;
use std::path::{Path, PathBuf};

use super::{MessageResult, sync_folder, with_suffix};

/// Suffix of a file's name while it is made, before the number of the process.
const PARTIAL: &str = ".partial";

/// Writes a file, replacing any existing one.
///
/// # Errors
/// If it cannot be written. The earlier file, if there is one, is then unchanged.
pub fn write_whole(path: &Path, content: &[u8]) -> MessageResult<()> {
    make_whole(path, |partial| std::fs::write(partial, content).map_err(|error| error.to_string()))
}

/// Lets a function make a file next to its final place, syncs it to the disk and replaces any existing file by it.
///
/// # Errors
/// If it cannot be made or put there. The earlier file, if there is one, is then unchanged.
pub(super) fn make_whole(
    path: &Path,
    make: impl FnOnce(&Path) -> MessageResult<()>,
) -> MessageResult<()> {
    let partial = partial_of(path);
    let made = make(&partial).and_then(|()| put(&partial, path));
    if made.is_err() {
        // The partial file is of no use; if it cannot be removed, it does no harm.
        let _ = std::fs::remove_file(&partial);
    }
    made
}

/// Path of the partial file, which differs between processes that write the same file at the same time.
fn partial_of(path: &Path) -> PathBuf {
    with_suffix(path, &format!("{PARTIAL}-{}", std::process::id()))
}

fn put(partial: &Path, path: &Path) -> MessageResult<()> {
    let renamed = File::open(partial)
        .and_then(|file| file.sync_all())
        .and_then(|()| std::fs::rename(partial, path));
    renamed.map_err(|error| error.to_string())?;
    sync_folder(path)
}

/// The final name of a file whose making may have been interrupted.
pub fn name_when_whole(name: &str) -> &str {
    match name.rsplit_once(PARTIAL) {
        Some((whole, "")) => whole,
        Some((whole, rest)) if is_number(rest.strip_prefix('-')) => whole,
        _ => name,
    }
}

fn is_number(text: Option<&str>) -> bool {
    text.is_some_and(|text| text.parse::<u32>().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_write_that_fails_leaves_the_file_that_was_there_and_nothing_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("case.toml");
        let fails = |partial: &Path| {
            std::fs::write(partial, "half").unwrap();
            Err("the disk is full".to_owned())
        };
        assert!(make_whole(&path, fails).is_err());
        assert!(!path.exists());
        write_whole(&path, b"old").unwrap();
        assert!(make_whole(&path, fails).is_err());
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        write_whole(&path, b"new").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn what_an_interrupted_write_leaves_is_known_by_its_name() {
        let partial = partial_of(Path::new("case.toml")).display().to_string();
        assert_eq!(name_when_whole(&partial), "case.toml");
        assert_eq!(name_when_whole("profiles.h5.partial"), "profiles.h5");
        for own in ["case.toml", "case.toml.partial-notes", "case.partial.toml"] {
            assert_eq!(name_when_whole(own), own);
        }
    }
}
