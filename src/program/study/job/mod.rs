//! Starting runs and waiting for their end.

mod process;

pub(crate) use process::TalcumRunner;

use crate::study::checker::CaseRequest;
use std::fs::File;
use std::path::PathBuf;

/// A run that is to be started.
#[derive(Debug)]
pub(crate) struct Job {
    /// Its case and all settings in it.
    pub(crate) request: CaseRequest,
    /// The folder of its results.
    pub(crate) folder: PathBuf,
    /// The lock of the folder, which the run holds until its end.
    pub(crate) lock: File,
}

/// End of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Exit {
    /// Whether it ended without an error.
    pub(crate) success: bool,
    /// The exit code or signal, and the last lines of the error output.
    pub(crate) description: String,
}

/// Starts runs.
pub(crate) trait Runner {
    /// Starts a run, or resumes it.
    ///
    /// # Errors
    /// If it cannot be started.
    fn start(&self, job: Job) -> Result<Box<dyn Running>, String>;
}

/// A run in progress.
pub(crate) trait Running {
    /// Its end, if it has ended.
    fn poll(&mut self) -> Option<Exit>;

    /// Asks it to write a checkpoint and to end.
    fn ask_to_stop(&mut self);

    /// Ends it at once.
    fn kill(&mut self);
}
