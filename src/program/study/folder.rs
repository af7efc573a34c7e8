//! The folder of a study: it contains a folder for each run, from which the state of the study follows.
//!
//! The state of a study is not stored anywhere else. A run is complete if Talcum has marked its folder as complete, and
//! the case that was run is the one required by the study.

use crate::study::case_text::EffectiveCase;
use crate::study::known::{KnownRun, KnownRuns};
use crate::study::member::Member;
use crate::study::quantity::{Measured, NamedQuantity};
use crate::study::setting::shortest;
use crate::study::task::{Records, RunState};
use std::cell::RefCell;
use std::collections::HashMap;
use std::fs::File;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use talcum_results::output;
use talcum_results::output::lock::{Sharing, try_lock};
use talcum_results::output::readers::SeriesTable;

/// Written by Talcum at the end of a run; contains the digest.
pub(crate) const COMPLETE: &str = "complete";
/// Contains the reason why a run failed.
pub(crate) const FAILED: &str = "failed";
/// Number of hexadecimal digits of a digest.
const DIGITS: usize = 32;
/// Locked while a run is active.
const RUN_LOCK: &str = "lock";

/// The folder of a study.
#[derive(Debug)]
pub(crate) struct StudyFolder {
    root: PathBuf,
    /// Folders of runs, by the marks at the ends of their names.
    by_mark: HashMap<String, String>,
    /// Digests of runs that have been found complete.
    complete: RefCell<HashMap<String, String>>,
    /// Runs that need not be made here.
    known: KnownRuns,
}

impl StudyFolder {
    /// The folder at a path, with the runs in it. Nothing is written.
    pub(crate) fn at(root: &Path) -> Self {
        let entries = std::fs::read_dir(root.join("runs")).into_iter().flatten().flatten();
        let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
        let by_mark = names.filter_map(|name| Some((name.rsplit_once("__")?.1.to_owned(), name)));
        Self {
            root: root.to_owned(),
            by_mark: by_mark.collect(),
            complete: RefCell::default(),
            known: KnownRuns::default(),
        }
    }

    /// This folder with runs that were made elsewhere.
    pub(crate) fn with_known(self, known: KnownRuns) -> Self {
        Self { known, ..self }
    }

    /// The default folder for a study file.
    pub(crate) fn default_of(study: &Path) -> PathBuf {
        Path::new("results").join(study.file_stem().unwrap_or_default())
    }

    /// Its path.
    pub(crate) fn root(&self) -> &Path {
        &self.root
    }

    /// The case of continued runs.
    pub(crate) fn continued_case(&self) -> PathBuf {
        self.root.join("continued.toml")
    }

    /// The name of the folder of a run: that of the same run in an earlier form of the study, if there is one.
    pub(crate) fn name_of<'a>(&'a self, member: &'a Member) -> &'a str {
        self.by_mark.get(member.mark()).unwrap_or(&member.name)
    }

    /// The folder of a run.
    pub(crate) fn run(&self, member: &Member) -> PathBuf {
        self.root.join("runs").join(self.name_of(member))
    }

    /// The last checkpoint of a run, relative to the folder of the study.
    pub(crate) fn last_checkpoint(&self, member: &Member) -> Option<PathBuf> {
        let newest = newest_checkpoint(&self.run(member))?;
        Some(Path::new("runs").join(self.name_of(member)).join(newest))
    }

    /// Takes the lock of a run and makes its folder; `None` if the run is active elsewhere.
    ///
    /// # Errors
    /// If the folder cannot be written.
    pub(crate) fn lock_run(&self, member: &Member) -> Result<Option<File>, String> {
        let folder = self.run(member);
        make_folder(&folder)?;
        try_lock(&folder.join(RUN_LOCK), Sharing::Exclusive)
    }

    /// Whether a run is active at present, here or in another process.
    pub(crate) fn is_running(&self, member: &Member) -> bool {
        let lock = self.run(member).join(RUN_LOCK);
        lock.exists() && matches!(try_lock(&lock, Sharing::Exclusive), Ok(None))
    }

    /// Records that a run failed.
    ///
    /// # Errors
    /// If this cannot be written.
    pub(crate) fn note_failure(&self, member: &Member, reason: &str) -> Result<(), String> {
        write_whole(&self.run(member).join(FAILED), reason)
    }

    /// Removes the record of a failure, so that the run is tried again.
    ///
    /// # Errors
    /// If the record cannot be removed.
    pub(crate) fn forget_failure(&self, member: &Member) -> Result<(), String> {
        let path = self.run(member).join(FAILED);
        match std::fs::remove_file(&path) {
            Err(error) if path.exists() => {
                Err(format!("{} cannot be removed: {error}", path.display()))
            }
            _ => Ok(()),
        }
    }

    /// State of a run, from its folder.
    pub(crate) fn state(&self, member: &Member) -> RunState {
        if let Some(digest) = self.complete.borrow().get(&member.identity) {
            return RunState::Done(digest.clone());
        }
        let mut state = read_state(&self.run(member), member);
        if let (RunState::Waiting | RunState::Begun, Some(known)) = (&state, self.known(member)) {
            state = RunState::Done(known.digest.clone());
        }
        if let RunState::Done(digest) = &state {
            self.complete.borrow_mut().insert(member.identity.clone(), digest.clone());
        }
        state
    }

    /// The time of the last row of a run's series.
    pub(crate) fn time_reached(&self, member: &Member) -> Option<f64> {
        // The last line may be only half written.
        let text = output::read_text(&self.run(member).join("series.csv")).ok()?;
        let whole = text.rsplit_once('\n')?.0;
        whole.rsplit('\n').next()?.split(',').next()?.parse().ok()
    }

    /// Rejects the results of a complete run whose series lacks its last rows, which must have been lost since.
    ///
    /// # Errors
    /// Gives the last time, and the required one.
    pub(crate) fn require_last_row(&self, member: &Member) -> Result<(), String> {
        let case = output::read_text(&self.run(member).join("case.toml"));
        let case = case.ok().and_then(|text| EffectiveCase::parse(&text).ok());
        let Some(due) = case.and_then(|case| case.last_row()) else { return Ok(()) };
        match self.time_reached(member) {
            Some(time) if time >= due => Ok(()),
            reached => Err(format!(
                "{} was cut short: its last row is at {}, and the run is complete up to {}",
                self.run(member).join("series.csv").display(),
                reached.map_or("no time".to_owned(), |time| format!("time {}", shortest(time))),
                member
                    .end_time
                    .map_or("its end".to_owned(), |end| format!("time {}", shortest(end)))
            )),
        }
    }

    /// Data in a table from elsewhere on a run that is not complete here.
    pub(crate) fn known(&self, member: &Member) -> Option<&KnownRun> {
        let known = self.known.run(&member.identity)?;
        (!self.run(member).join(COMPLETE).exists()).then_some(known)
    }

    /// A line of provenance of a run, for example `commit`; several lines if it is known from a table with runs of
    /// several.
    pub(crate) fn provenance(&self, member: &Member, name: &str) -> Vec<String> {
        if let Some(known) = self.known(member) {
            return known.provenance(name);
        }
        let series = SeriesTable::read(&self.run(member).join("series.csv")).ok();
        series.and_then(|series| series.entry(name).map(str::to_owned)).into_iter().collect()
    }
}

fn read_state(folder: &Path, member: &Member) -> RunState {
    let case = match output::read_text(&folder.join("case.toml")) {
        Ok(case) => case,
        Err(_) => return failure(folder).map_or(RunState::Waiting, RunState::Failed),
    };
    let identity = EffectiveCase::parse(&case).map(|case| case.identity(member.origin_identity()));
    if identity.as_ref() != Ok(&member.identity) {
        return RunState::Failed(format!(
            "{} holds the results of another case: has the case been changed while the study ran? \
             Remove the folder to run it again",
            folder.display()
        ));
    }
    let complete = output::read_text(&folder.join(COMPLETE));
    if let Some(digest) = complete.ok().and_then(|text| digest_of(&text)) {
        return RunState::Done(digest);
    }
    failure(folder).map_or(RunState::Begun, RunState::Failed)
}

/// The reason why the run of a folder failed; if it cannot be read, that is the reason: the run would otherwise be started
/// again and again.
fn failure(folder: &Path) -> Option<String> {
    let path = folder.join(FAILED);
    match output::read_text(&path) {
        Ok(reason) => Some(reason),
        Err(error) if error.kind() == ErrorKind::NotFound => None,
        Err(error) => Some(format!("{} cannot be read: {error}", path.display())),
    }
}

/// The digest in a file `complete`, which contains `digest HEX`; `None` if it was cut short or damaged.
pub(crate) fn digest_of(text: &str) -> Option<String> {
    let digest = text.lines().find_map(|line| line.strip_prefix("digest "))?.trim();
    let is_whole = digest.len() == DIGITS && digest.bytes().all(|byte| byte.is_ascii_hexdigit());
    is_whole.then(|| digest.to_owned())
}

/// The name of the newest checkpoint in a folder: names end with the number of the step, with leading zeros.
pub(crate) fn newest_checkpoint(folder: &Path) -> Option<String> {
    let entries = std::fs::read_dir(folder).ok()?.flatten();
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    names.filter(|name| name.starts_with("checkpoint-") && name.ends_with(".h5")).max()
}

/// Makes a folder and all its parents.
pub(crate) fn make_folder(path: &Path) -> Result<(), String> {
    std::fs::create_dir_all(path)
        .map_err(|error| format!("{} cannot be made: {error}", path.display()))
}

/// Writes a file that exists either completely or not at all.
pub(crate) fn write_whole(path: &Path, text: &str) -> Result<(), String> {
    output::write_whole(path, text.as_bytes())
        .map_err(|error| format!("{} cannot be written: {error}", path.display()))
}

/// Data on the runs of a study, from its folder.
#[derive(Debug)]
pub(crate) struct Results<'a> {
    /// The folder.
    pub(crate) folder: &'a StudyFolder,
    /// The quantities of the study.
    pub(crate) quantities: &'a [NamedQuantity],
}

impl Records for Results<'_> {
    fn state(&self, member: &Member) -> RunState {
        self.folder.state(member)
    }

    fn measure(&self, member: &Member, name: &str) -> Result<Measured, String> {
        let quantity = self.quantities.iter().find(|quantity| quantity.name == name);
        let quantity = quantity.ok_or_else(|| format!("there is no quantity {name}"))?;
        if let Some(known) = self.folder.known(member) {
            return known.measure(name);
        }
        self.folder.require_last_row(member).map_err(|error| format!("{name}: {error}"))?;
        let measured = quantity.quantity.value(&self.folder.run(member));
        measured.map_err(|error| format!("{name}: {error}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failure_whose_reason_cannot_be_read_is_one() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(failure(folder.path()), None);
        std::fs::write(folder.path().join(FAILED), "too fast").unwrap();
        assert_eq!(failure(folder.path()).unwrap(), "too fast");
        std::fs::write(folder.path().join(FAILED), b"\xff").unwrap();
        assert!(failure(folder.path()).unwrap().contains("failed cannot be read: "));
    }

    #[test]
    fn a_digest_that_was_cut_short_is_none() {
        let digest = "0123456789abcdef0123456789abcdef";
        let line = format!("digest {digest}\n");
        assert_eq!(digest_of(&line).as_deref(), Some(digest));
        for length in 0..line.len() - 1 {
            assert_eq!(digest_of(&line[..length]), None, "{length}");
        }
        assert_eq!(digest_of(&line.replace('a', "x")), None);
    }
}
