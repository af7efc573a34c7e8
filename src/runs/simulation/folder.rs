//! The folder of results: its files, and the mark of completion.

use super::outputs::LISTED;
use crate::case::{Case, is_mesh_in_results};
use std::fs::File;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use talcum_engine::parallel::Communicator;
use talcum_results::analysis::Digest;
use talcum_results::output::checkpoint::{is_checkpoint, is_stage_end};
use talcum_results::output::lock::{self, Sharing, try_lock};
use talcum_results::output::{OutputError, name_when_whole, on_root, write_whole};

/// Folder of results, and the folder for relative paths in the case.
#[derive(Clone, Debug)]
pub struct OutputFolder {
    /// The folder of results.
    pub path: PathBuf,
    /// The folder of the case file.
    pub case_folder: PathBuf,
}

/// The mark of a run that came to its requested end: it contains the digest.
const COMPLETE: &str = "complete";
/// Lock file of an active run; it names the process.
const RUNNING: &str = "running";

/// Keeps other runs out of a folder of results for as long as it exists, on rank 0. The file system releases the lock
/// of a process that has died, on any machine.
#[derive(Debug)]
pub struct FolderLock {
    /// Path of the lock file, which is removed at the end.
    path: PathBuf,
    /// `None` on other ranks, and if the file system has no locks.
    file: Option<File>,
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        if self.file.is_some() {
            // Only a message to others depends on this: without the file they lock a new one.
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

impl OutputFolder {
    /// Makes the folder and keeps other runs out of it. Collective.
    ///
    /// # Errors
    /// If another run has locked the folder, or if it cannot be made or its files cannot be named.
    pub fn lock(&self, ranks: &dyn Communicator) -> Result<FolderLock, OutputError> {
        let path = self.path.join(RUNNING);
        let taken = on_root(&self.path, ranks, || {
            self.path.to_str().ok_or("HDF5 has no names for files that are not in UTF-8")?;
            std::fs::create_dir_all(&self.path).map_err(|error| error.to_string())?;
            take_lock(&path)
        })?;
        Ok(FolderLock { path, file: taken.flatten() })
    }

    /// Whether an earlier run has left results here.
    pub fn holds_results(&self) -> bool {
        let Ok(entries) = std::fs::read_dir(&self.path) else { return false };
        entries.flatten().any(|entry| is_result(&entry.file_name().to_string_lossy()))
    }

    /// Whether the run in this folder has come to its end, or to `--until`.
    pub fn is_complete(&self) -> bool {
        self.path.join(COMPLETE).exists()
    }

    /// Removes an earlier run's results, and nothing else.
    ///
    /// # Errors
    /// If the folder cannot be read or a file cannot be removed.
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

/// The lock of a folder; `None`, with a warning, if the file system has no locks.
fn take_lock(path: &Path) -> Result<Option<File>, String> {
    loop {
        let file = match try_lock(path, Sharing::Exclusive) {
            Ok(Some(file)) => file,
            Ok(None) => {
                return Err(format!("another run is writing here: {}", lock::holder(path)));
            }
            Err(reason) => {
                log::warn!("{reason}: nothing keeps a second run out of this folder");
                return Ok(None);
            }
        };
        // The run that held the lock may have removed the file after we had opened it.
        let same = |held: std::fs::Metadata| {
            std::fs::metadata(path).is_ok_and(|named| named.ino() == held.ino())
        };
        if file.metadata().is_ok_and(same) {
            lock::sign(&file);
            return Ok(Some(file));
        }
    }
}

fn is_result(name: &str) -> bool {
    let name = name_when_whole(name);
    let is_listed = |file: &str| LISTED.iter().any(|listed| listed.kind.file_name == file);
    let of_listed = |suffix| name.strip_suffix(suffix).is_some_and(is_listed);
    let fixed = ["case.toml", "analysis.h5", COMPLETE];
    is_checkpoint(name)
        || is_stage_end(name)
        || is_of_measure(name)
        || is_mesh_in_results(name)
        || fixed.contains(&name)
        || ["", ".metadata"].into_iter().any(of_listed)
}

/// Whether a file belongs to an instrument of any name.
fn is_of_measure(name: &str) -> bool {
    let of_measure = |name: &str| name.ends_with(".h5") || name.ends_with(".vtkhdf");
    let plain = |suffix| name.strip_suffix(suffix).is_some_and(of_measure);
    name.starts_with("measure-") && ["", ".metadata"].into_iter().any(plain)
}

/// Makes the folder, with the case in effect and copies of its meshes; a run that is continued is no longer complete.
pub(super) fn make_folder(
    path: &Path,
    case: &Case,
    ranks: &dyn Communicator,
) -> Result<(), OutputError> {
    let make = || {
        std::fs::create_dir_all(path)?;
        match std::fs::remove_file(path.join(COMPLETE)) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => return Err(error),
            _ => {}
        }
        Ok(())
    };
    on_root(path, ranks, || make().map_err(|error| error.to_string()))?;
    for file in &case.mesh_files {
        let copy = path.join(file.name_in_results());
        on_root(&copy, ranks, || copy_whole(&file.path, &copy))?;
    }
    let file = path.join("case.toml");
    on_root(&file, ranks, || write_whole(&file, case.text.as_bytes())).map(|_| ())
}

/// Copies a mesh, unless it is there.
fn copy_whole(file: &Path, copy: &Path) -> Result<(), String> {
    let content = std::fs::read(file).map_err(|error| error.to_string())?;
    if std::fs::read(copy).is_ok_and(|former| former == content) {
        return Ok(());
    }
    write_whole(copy, &content)
}

/// Marks the run as complete: batch scripts need not start it again. Collective.
pub(super) fn mark_complete(
    path: &Path,
    digest: &Digest,
    ranks: &dyn Communicator,
) -> Result<(), OutputError> {
    let mark = path.join(COMPLETE);
    let text = format!("digest {digest}\n");
    on_root(&mark, ranks, || write_whole(&mark, text.as_bytes())).map(|_| ())
}
