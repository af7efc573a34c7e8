//! Start of the ranks of a command: as processes of MPI, or as threads of this process.

use super::launchers::require_one_process;
use super::signals::catch_limit_of_files;
use super::{complain, start_log};
use anyhow::Context;
use std::process::ExitCode;
use std::time::Duration;
use talcum_engine::parallel::{Communicator, end_at_once, start_on_threads};
use talcum_results::output::write_failed;

/// Exit code after any error of a command that was understood.
const FAILURE: i32 = 1;
/// Time for which refused processes wait for the message of the first: launchers end all once one has ended.
const PAUSE: Duration = Duration::from_secs(1);
/// Default number of ranks in a program without MPI.
#[cfg(not(feature = "mpi"))]
const THREADS: usize = 1;

/// Work that ranks do together, with the same result on all.
pub(super) trait Work: Fn(&dyn Communicator) -> anyhow::Result<()> + Sync {}
impl<F: Fn(&dyn Communicator) -> anyhow::Result<()> + Sync> Work for F {}

/// Runs work on a number of threads; without a number on the ranks of MPI, or on one thread in a program without it.
pub(super) fn on_ranks(threads: Option<usize>, work: impl Work) -> ExitCode {
    match threads {
        Some(threads) => on_threads(threads, work),
        None => by_default(work),
    }
}

#[cfg(feature = "mpi")]
fn by_default(work: impl Work) -> ExitCode {
    let ranks = match talcum_engine::parallel::MpiRanks::start() {
        Ok(ranks) => ranks,
        Err(error) => {
            complain(&error.into());
            return ExitCode::FAILURE;
        }
    };
    // The other ranks write to the log only if RUST_LOG requests it.
    start_log(if ranks.is_root() { "info" } else { "off" });
    catch_limit_of_files();
    let result = work(&ranks);
    if let Err(error) = &result {
        if ranks.is_root() {
            complain(error);
        }
        if write_failed() {
            ranks.abort(FAILURE);
        }
    }
    exit_code(&result)
}

#[cfg(not(feature = "mpi"))]
fn by_default(work: impl Work) -> ExitCode {
    on_threads(THREADS, work)
}

fn on_threads(threads: usize, work: impl Work) -> ExitCode {
    start_log("info");
    catch_limit_of_files();
    if let Err(error) = require_one_process(|name| std::env::var(name).ok()) {
        if error.speaks {
            complain(&error.into());
        } else {
            std::thread::sleep(PAUSE);
        }
        return ExitCode::FAILURE;
    }
    let results = start_on_threads(threads, work)
        .with_context(|| format!("the system refuses {threads} threads: use fewer"));
    // The result is equal on all ranks.
    let result = results.and_then(|results| results.into_iter().collect());
    if let Err(error) = &result {
        complain(error);
        if write_failed() {
            end_at_once(FAILURE);
        }
    }
    exit_code(&result)
}

fn exit_code(result: &anyhow::Result<()>) -> ExitCode {
    if result.is_ok() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
