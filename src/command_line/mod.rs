//! What the user types, and what the program answers.

mod analyse;
mod check;
mod contact;
mod info;
mod keys;
mod lone_ranks;
mod memory;
mod naming;
mod progress;
mod reading;
mod report;
mod run;
mod signals;

use crate::domain::RankGrid;
use crate::output::write_failed;
use crate::parallel::{Communicator, MpiRanks};
use crate::study::{self, StudyOptions, SummaryOptions};
use clap::{Args, Parser, Subcommand};
use lone_ranks::require_one_run;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

/// CFD-DEM of fluidised beds of fine, cohesive powders: the same bits on any number of ranks.
///
/// Start it alone, or on N ranks with `mpirun -n N talcum ...`.
#[derive(Debug, Parser)]
#[command(version, max_term_width = 100)]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    #[command(flatten)]
    OnRanks(RankCommand),
    /// Measure on the results of a run: waves, bed height, minimum fluidisation, spectra, mixing, agglomerates ...
    Analyse(analyse::AnalyseOptions),
    /// Run many cases that a study file describes, or say how far they are; not under mpirun.
    Study(StudyOptions),
    /// Print a table of means of runs.
    Summary(SummaryOptions),
}

/// What all ranks of MPI do together.
#[derive(Debug, Subcommand)]
enum RankCommand {
    /// Read and validate a case, and describe what would run.
    Check {
        /// The case file.
        case: PathBuf,
        #[command(flatten)]
        changes: Changes,
    },
    /// Run a case to its end.
    Run {
        /// The case file.
        case: PathBuf,
        #[command(flatten)]
        options: RunArguments,
        /// Remove the results of an earlier run in the output folder first.
        #[arg(long, conflicts_with = "resume")]
        force: bool,
        /// Go on from the newest good checkpoint in the output folder; start anew if there is none.
        #[arg(long)]
        resume: bool,
    },
    /// Go on from a checkpoint, on any number of ranks.
    Restart {
        /// The checkpoint.
        checkpoint: PathBuf,
        #[command(flatten)]
        options: RunArguments,
    },
    /// Print the normal force over the overlap, of two bodies slowly pressed together and pulled apart, as CSV.
    Contact(contact::ContactOptions),
    /// Print the keys of the case file, or of one section, with unit, range, default and meaning.
    Keys(keys::KeysOptions),
    /// Describe what is in a checkpoint.
    Info {
        /// The checkpoint.
        file: PathBuf,
    },
}

#[derive(Debug, Args)]
struct Changes {
    /// Use another value for a key of the case; may be given several times.
    #[arg(long = "set", value_name = "KEY.PATH=VALUE")]
    set: Vec<String>,
    /// Ranks along x, y and z, instead of what the case says.
    #[arg(long, value_name = "PX,PY,PZ", value_parser = rank_grid)]
    ranks: Option<RankGrid>,
    /// Go on although the case seems to need more memory than is free.
    #[arg(long)]
    any_memory: bool,
}

#[derive(Debug, Args)]
struct RunArguments {
    #[command(flatten)]
    changes: Changes,
    /// The folder of results (default: results/NAME of the case; in a restart, the checkpoint's folder).
    #[arg(long)]
    output: Option<PathBuf>,
    /// End at this time instead of the case's end.
    #[arg(long, value_name = "TIME")]
    until: Option<f64>,
}

fn rank_grid(text: &str) -> Result<RankGrid, String> {
    let counts: Result<Vec<usize>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    match counts.as_deref() {
        Ok(&[x, y, z]) if x > 0 && y > 0 && z > 0 => Ok(RankGrid([x, y, z])),
        _ => Err("must be three positive numbers, for example 1,1,4".to_owned()),
    }
}

/// Exit code after any other error.
const FAILURE: i32 = 1;
/// Exit code for a command line that cannot be understood.
const USAGE: u8 = 2;

/// Runs the program on this rank. Every error is one message on standard error, from rank 0, and a
/// non-zero exit code on all ranks.
pub fn main() -> ExitCode {
    match CommandLine::try_parse().map(|line| line.command) {
        // A study starts runs as processes of their own, which a process of MPI may not do.
        Ok(Command::Study(options)) => alone(|| study::run(&options, std::env::current_exe()?)),
        Ok(Command::Analyse(options)) => alone(|| analyse::analyse(&options)),
        Ok(Command::Summary(options)) => {
            alone(|| study::summary(&options).map(|()| ExitCode::SUCCESS))
        }
        Ok(Command::OnRanks(command)) => on_ranks(Ok(command)),
        Err(usage) => on_ranks(Err(usage)),
    }
}

/// Does what needs no ranks.
fn alone(work: impl FnOnce() -> anyhow::Result<ExitCode>) -> ExitCode {
    start_log("info");
    work().unwrap_or_else(|error| {
        complain(&error);
        ExitCode::FAILURE
    })
}

/// Does a command on the ranks of MPI, or prints how commands are written.
fn on_ranks(parsed: Result<RankCommand, clap::Error>) -> ExitCode {
    let ranks = match MpiRanks::start() {
        Ok(ranks) => ranks,
        Err(error) => {
            complain(&error.into());
            return ExitCode::FAILURE;
        }
    };
    // The other ranks speak only where RUST_LOG asks for it.
    start_log(if ranks.is_root() { "info" } else { "off" });
    let command = match parsed {
        Ok(command) => command,
        Err(usage) => {
            if ranks.is_root() {
                // Nothing is left to say if standard output is closed.
                let _ = usage.print();
            }
            let code = if usage.use_stderr() { USAGE } else { 0 };
            return ExitCode::from(code);
        }
    };
    match dispatch(command, &ranks) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            if ranks.is_root() {
                complain(&error);
            }
            if write_failed() {
                ranks.abort(FAILURE);
            }
            ExitCode::FAILURE
        }
    }
}

/// Prints an error; nothing is left to do if standard error is closed.
fn complain(error: &anyhow::Error) {
    let _ = writeln!(std::io::stderr(), "error: {error:#}");
}

/// The log of this process, down to a level if RUST_LOG does not say which.
fn start_log(level: &str) {
    let environment = env_logger::Env::default().default_filter_or(level);
    env_logger::Builder::from_env(environment).format_timestamp(None).format_target(false).init();
}

fn dispatch(command: RankCommand, ranks: &dyn Communicator) -> anyhow::Result<()> {
    if matches!(command, RankCommand::Run { .. } | RankCommand::Restart { .. }) {
        require_one_run(ranks.size(), |name| std::env::var(name).ok())?;
    }
    match command {
        RankCommand::Check { case, changes } => check::check(&case, &changes, ranks),
        RankCommand::Run { case, options, force, resume } => {
            run::run(&case, &options, run::Earlier::from_flags(force, resume), ranks)
        }
        RankCommand::Restart { checkpoint, options } => run::restart(&checkpoint, &options, ranks),
        RankCommand::Contact(options) => contact::contact(&options, ranks),
        RankCommand::Keys(options) => keys::keys(&options, ranks),
        RankCommand::Info { file } => info::info(&file, ranks),
    }
}
