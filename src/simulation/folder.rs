//! The folder of results: what belongs to it, and its mark of completion.

use super::outputs::LISTED;
use crate::analysis::Digest;
use crate::output::{OutputError, on_root};
use crate::parallel::Communicator;
use std::path::{Path, PathBuf};

/// Where results go, and where relative paths in the case refer to.
#[derive(Clone, Debug)]
pub struct OutputFolder {
    /// The folder of results.
    pub path: PathBuf,
    /// The folder of the case file.
    pub case_folder: PathBuf,
}

/// The mark of a run that came to its end: holds the digest.
const COMPLETE: &str = "complete";

impl OutputFolder {
    /// Whether an earlier run has left results here.
    pub fn holds_results(&self) -> bool {
        let Ok(entries) = std::fs::read_dir(&self.path) else { return false };
        entries.flatten().any(|entry| is_result(&entry.file_name().to_string_lossy()))
    }

    /// Removes an earlier run's results, and nothing else.
    ///
    /// # Errors
    /// If the folder cannot be read or a file not be removed.
    pub fn clear(&self) -> Result<(), String> {
        if !self.path.exists() {
            return Ok(());
        }
        let entries = std::fs::read_dir(&self.path).map_err(|error| error.to_string())?;
        for entry in entries.flatten() {
            if is_result(&entry.file_name().to_string_lossy()) {
                let path = entry.path();
                std::fs::remove_file(&path)
                    .map_err(|error| format!("{} cannot be removed: {error}", path.display()))?;
            }
        }
        Ok(())
    }
}

fn is_result(name: &str) -> bool {
    let checkpoint = name.starts_with("checkpoint-");
    let is_listed = |file: &str| LISTED.iter().any(|listed| listed.kind.file_name == file);
    let of_listed = |suffix| name.strip_suffix(suffix).is_some_and(is_listed);
    let fixed = ["case.toml", COMPLETE];
    checkpoint || fixed.contains(&name) || ["", ".metadata", ".partial"].into_iter().any(of_listed)
}

/// Makes the folder, with the case in effect; a run that goes on is no longer complete.
pub(super) fn make_folder(
    path: &Path,
    case_text: &str,
    ranks: &dyn Communicator,
) -> Result<(), OutputError> {
    let make = || {
        std::fs::create_dir_all(path)?;
        match std::fs::remove_file(path.join(COMPLETE)) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => return Err(error),
            _ => {}
        }
        std::fs::write(path.join("case.toml"), case_text)
    };
    on_root(path, ranks, || make().map_err(|error| error.to_string())).map(|_| ())
}

/// Marks the run as complete: batch scripts need not start it again. Collective.
pub(super) fn mark_complete(
    path: &Path,
    digest: &Digest,
    ranks: &dyn Communicator,
) -> Result<(), OutputError> {
    let mark = path.join(COMPLETE);
    on_root(&mark, ranks, || {
        std::fs::write(&mark, format!("digest {digest}\n")).map_err(|error| error.to_string())
    })
    .map(|_| ())
}
