//! The checkpoints of a folder: the newest one that can be used, and the surplus ones.

use std::path::{Path, PathBuf};

use super::Checkpoint;
use super::read::read_whole;
use crate::analysis::Digest;
use crate::output::checksum::{self, Refusal};
use crate::output::{MessageResult, OutputError, Provenance, is_error_of_system, on_root};
use talcum_engine::parallel::Communicator;

/// Suffix appended to the name of a checkpoint of a later step than the one from which a run continues.
const SUPERSEDED: &str = ".superseded";

/// Result of a search for checkpoints.
#[derive(Debug)]
pub struct Search {
    /// The newest good checkpoint: its file, this rank's share, its provenance, and its digest.
    pub found: Option<(PathBuf, Checkpoint, Provenance, Digest)>,
    /// Newer files that had to be rejected, with the reasons; newest first.
    pub refused: Vec<OutputError>,
}

/// Name of the checkpoint of a step: `checkpoint-000000012000.h5`.
pub fn file_name(step: u64) -> String {
    format!("checkpoint-{step:012}.h5")
}

/// The step in a checkpoint's file name.
fn step_of(name: &str) -> Option<u64> {
    let digits = name.strip_prefix("checkpoint-")?.strip_suffix(".h5")?;
    let step = digits.parse().ok()?;
    (file_name(step) == name).then_some(step)
}

/// Whether a file is a checkpoint of a run, complete or not, or was one until it was superseded.
pub fn is_checkpoint(name: &str) -> bool {
    let of_suffix = |suffix| name.strip_suffix(suffix).and_then(step_of).is_some();
    ["", ".partial", SUPERSEDED].into_iter().any(of_suffix)
}

/// Name under which the state at the end of a stage is kept: `stage-1-settle.h5`; stages count from 1, and characters
/// that are not allowed in every file name become `_`.
pub fn stage_file_name(number: usize, name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '_' };
    format!("stage-{number}-{}.h5", name.chars().map(plain).collect::<String>())
}

/// Whether a file is the state at the end of a stage.
pub fn is_stage_end(name: &str) -> bool {
    let is_numbered = |rest: &str| {
        rest.split_once('-').is_some_and(|(number, _)| number.parse::<usize>().is_ok())
    };
    let whole = name.strip_suffix(".partial").unwrap_or(name);
    let inner = whole.strip_suffix(".h5").and_then(|name| name.strip_prefix("stage-"));
    inner.is_some_and(is_numbered)
}

/// Keeps a checkpoint under a further name, which [`prune`] does not touch. Collective.
///
/// # Errors
/// If it can neither be linked nor copied.
pub fn keep_as(path: &Path, name: &str, ranks: &dyn Communicator) -> Result<(), OutputError> {
    on_root(path, ranks, || {
        let kept = path.with_file_name(name);
        let partial = path.with_file_name(format!("{name}.partial"));
        // A file left by an earlier attempt.
        let _ = std::fs::remove_file(&partial);
        // Not every file system has links.
        std::fs::hard_link(path, &partial)
            .or_else(|_| std::fs::copy(path, &partial).map(|_| ()))
            .and_then(|()| std::fs::rename(&partial, &kept))
            .map_err(|error| format!("{name} cannot be written: {error}"))
    })?;
    Ok(())
}

/// Reads the newest complete checkpoint of a folder, trying from the newest to the oldest. Collective.
///
/// # Errors
/// If the folder, or a file in it, cannot be read. Damaged checkpoints are not an error; they are named in the result.
pub fn newest_good(folder: &Path, ranks: &dyn Communicator) -> Result<Search, OutputError> {
    let steps = on_root(folder, ranks, || steps_in(folder))?.unwrap_or_default();
    let mut bytes: Vec<u8> = bytemuck::cast_slice(&steps).to_vec();
    ranks.broadcast_from_root(&mut bytes);
    let steps: Vec<u64> = talcum_engine::parallel::records_of_bytes(&bytes).collect();
    let mut refused = Vec::new();
    for &step in steps.iter().rev() {
        let path = folder.join(file_name(step));
        let read = match checksum::check(&path, ranks) {
            Ok(()) => read_whole(&path, ranks),
            Err(Refusal::Damaged(error)) => Err(error),
            // It may be good, and must not be skipped.
            Err(Refusal::Unreadable(error)) => return Err(error),
        };
        match read {
            Ok((checkpoint, provenance, digest)) => {
                let found = Some((path, checkpoint, provenance, digest));
                return Ok(Search { found, refused });
            }
            Err(error) if is_error_of_system(&error.message) => return Err(error),
            Err(error) => refused.push(error),
        }
    }
    Ok(Search { found: None, refused })
}

/// Removes all except the newest `keep` checkpoints of a folder (at least one is kept), and remains of interrupted
/// writing. Collective.
///
/// # Errors
/// If the folder cannot be read or a file cannot be removed.
pub fn prune(folder: &Path, keep: usize, ranks: &dyn Communicator) -> Result<(), OutputError> {
    on_root(folder, ranks, || {
        let steps = steps_in(folder)?;
        let surplus = steps.len().saturating_sub(keep.max(1));
        let old = steps[..surplus].iter().map(|&step| file_name(step));
        let names = file_names(folder)?;
        let is_partial = |name: &String| name.strip_suffix(".partial").and_then(step_of).is_some();
        for name in old.chain(names.into_iter().filter(is_partial)) {
            std::fs::remove_file(folder.join(&name))
                .map_err(|error| format!("{name} cannot be removed: {error}"))?;
        }
        Ok(())
    })?;
    Ok(())
}

/// Renames the checkpoints of steps after `step` to `<name>.superseded`: they do not belong to a run that
/// continues from this step. Collective.
///
/// # Errors
/// If the folder cannot be read or a file cannot be renamed.
pub fn supersede(folder: &Path, step: u64, ranks: &dyn Communicator) -> Result<(), OutputError> {
    on_root(folder, ranks, || {
        for later in steps_in(folder)?.into_iter().filter(|&later| later > step) {
            let name = file_name(later);
            let aside = name.clone() + SUPERSEDED;
            std::fs::rename(folder.join(&name), folder.join(&aside))
                .map_err(|error| format!("{name} cannot be renamed: {error}"))?;
            log::warn!(
                "{name} is of a later time than the one this run continues from; it is kept as {aside}"
            );
        }
        Ok(())
    })?;
    Ok(())
}

/// The checkpoints of a folder, by ascending step; none is opened.
///
/// # Errors
/// If the folder cannot be read.
pub fn files_in(folder: &Path) -> Result<Vec<PathBuf>, OutputError> {
    let steps = steps_in(folder);
    let steps = steps.map_err(|message| OutputError { path: folder.to_owned(), message })?;
    Ok(steps.into_iter().map(|step| folder.join(file_name(step))).collect())
}

/// The steps of a folder's checkpoints, ascending.
fn steps_in(folder: &Path) -> MessageResult<Vec<u64>> {
    let mut steps: Vec<u64> = file_names(folder)?.iter().filter_map(|name| step_of(name)).collect();
    steps.sort_unstable();
    Ok(steps)
}

fn file_names(folder: &Path) -> MessageResult<Vec<String>> {
    let unreadable = |error: std::io::Error| format!("the folder cannot be read: {error}");
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        names.extend(entry.map_err(unreadable)?.file_name().into_string().ok());
    }
    Ok(names)
}
