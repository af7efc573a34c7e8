//! The command line: what the user enters, and the actions of the program.

mod analyse;
mod check;
mod contact;
mod info;
mod keys;
mod launchers;
mod log;
mod memory;
mod naming;
mod new;
mod progress;
mod ranks;
mod reading;
mod report;
mod run;
mod shell;
mod signals;
mod watch;

use self::launchers::require_one_run;
use self::log::start_log;
pub use self::new::Gallery;
use self::ranks::on_ranks;
use self::signals::catch_limit_of_files;
use crate::study::{self, StudyOptions, SummaryOptions};
use clap::{Args, CommandFactory, Parser, Subcommand, value_parser};
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use talcum_engine::domain::RankGrid;
use talcum_engine::numbers::check_instruction_set;
use talcum_engine::parallel::{Communicator, agree};
use talcum_results::output::{set_commit, unless_closed};

/// Simulate fluidised beds of fine, cohesive powders by CFD-DEM, with the same bits on any number of ranks.
///
/// A case runs on one rank, on N threads with `--threads N`, or on N MPI ranks with `mpirun -n N talcum ...`.
#[derive(Debug, Parser)]
#[command(name = "talcum", version, max_term_width = 100)]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    #[command(flatten)]
    OnRanks(RankCommand),
    /// Analyse the results of a run: waves, bed height, minimum fluidisation, spectra, mixing, agglomerates ...
    Analyse(analyse::AnalyseOptions),
    /// Show the curves, progress and warnings of a run, in the terminal or in a browser.
    Watch(watch::WatchOptions),
    /// Write a commented case from the gallery, to start with.
    New(new::NewOptions),
    /// Run all cases of a study, or report their progress. Do not start it under mpirun.
    Study(StudyOptions),
    /// Print a table of statistics of several runs.
    Summary(SummaryOptions),
    /// Print tab completions for a shell.
    Completions(shell::CompletionsOptions),
    /// Write the manual pages: talcum.1, and one for each command.
    Manual(shell::ManualOptions),
}

/// What all ranks do together.
#[derive(Debug, Subcommand)]
enum RankCommand {
    /// Check a case, and describe what would run.
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
        /// First remove the results of an earlier run from the output folder.
        #[arg(long, conflicts_with = "resume")]
        force: bool,
        /// Continue from the newest good checkpoint in the output folder; without one, start from the beginning.
        #[arg(long)]
        resume: bool,
    },
    /// Continue from a checkpoint, on any number of ranks.
    Restart {
        /// The checkpoint.
        checkpoint: PathBuf,
        #[command(flatten)]
        options: RunArguments,
        /// First remove the results of an earlier run from the output folder, which must not be that of the checkpoint.
        #[arg(long)]
        force: bool,
    },
    /// Print the normal force of a contact against its overlap, through loading and unloading, as CSV.
    Contact(contact::ContactOptions),
    /// Print the keys of the case file or the study file, with unit, range, default and meaning.
    Keys(keys::KeysOptions),
    /// Describe a checkpoint, or how this program was built.
    Info {
        /// The checkpoint; without it, the program is described.
        file: Option<PathBuf>,
    },
}

#[derive(Debug, Args)]
struct Changes {
    /// Set a key of the case to this value; may be repeated.
    #[arg(long = "set", value_name = "KEY.PATH=VALUE")]
    set: Vec<String>,
    /// Divide the box among so many ranks along x, y and z, instead of the ranks in the case.
    #[arg(long, value_name = "PX,PY,PZ", value_parser = rank_grid)]
    ranks: Option<RankGrid>,
    /// Run on N threads of this process, without MPI.
    #[arg(long, value_name = "N", value_parser = value_parser!(u64).range(1..=MOST_THREADS))]
    threads: Option<u64>,
    /// Run even if the case seems to need more memory than is free.
    #[arg(long)]
    any_memory: bool,
}

#[derive(Debug, Args)]
struct RunArguments {
    #[command(flatten)]
    changes: Changes,
    /// Write the results to this folder (default: results/NAME for a case NAME.toml; for a restart, the checkpoint's folder).
    #[arg(long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// End at this time, instead of at the end of the case.
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

/// Largest number of threads: a larger one is a typing error.
const MOST_THREADS: u64 = 512;
/// Exit code for a command line that cannot be understood.
const USAGE: u8 = 2;

/// What the program knows that its libraries do not.
#[derive(Clone, Copy, Debug)]
pub struct Build {
    /// The commit that it was built from, or `unknown`.
    pub commit: &'static str,
    /// The cases that `talcum new` writes.
    pub gallery: &'static Gallery,
}

/// Runs the program on this rank. Every error is one message on standard error, from rank 0, and a
/// non-zero exit code on all ranks.
pub fn main(build: &Build) -> ExitCode {
    set_commit(build.commit);
    match CommandLine::try_parse().map(|line| line.command) {
        // A study starts runs as separate processes, which a process of MPI must not do.
        Ok(Command::Study(options)) => alone(|| study::run(&options, std::env::current_exe()?)),
        Ok(Command::Analyse(options)) => alone(|| analyse::analyse(&options)),
        Ok(Command::Watch(options)) => alone(|| watch::watch(&options)),
        Ok(Command::New(options)) => alone(|| new::new(&options, build.gallery)),
        Ok(Command::Summary(options)) => {
            alone(|| study::summary(&options).map(|()| ExitCode::SUCCESS))
        }
        Ok(Command::Completions(options)) => {
            alone(|| shell::completions(&options, CommandLine::command()))
        }
        Ok(Command::Manual(options)) => alone(|| shell::manual(&options, CommandLine::command())),
        Ok(Command::OnRanks(command)) => {
            on_ranks(command.threads(), |ranks| dispatch(&command, ranks))
        }
        Err(usage) => print_usage(&usage),
    }
}

/// Runs a command that needs no ranks.
fn alone(work: impl FnOnce() -> anyhow::Result<ExitCode>) -> ExitCode {
    start_log("info");
    catch_limit_of_files();
    work().unwrap_or_else(|error| {
        complain(&error);
        ExitCode::FAILURE
    })
}

/// Prints the usage, from one rank.
fn print_usage(usage: &clap::Error) -> ExitCode {
    let done = on_ranks(None, |ranks| {
        let printed = if ranks.is_root() { usage.print() } else { Ok(()) };
        // Nothing can be done if standard error is closed or full.
        let printed = if usage.use_stderr() { Ok(()) } else { unless_closed(printed) };
        Ok(agree(printed, ranks)?)
    });
    if usage.use_stderr() { ExitCode::from(USAGE) } else { done }
}

/// Prints an error; nothing can be done if standard error is closed.
fn complain(error: &anyhow::Error) {
    let _ = writeln!(std::io::stderr(), "error: {error:#}");
}

fn dispatch(command: &RankCommand, ranks: &dyn Communicator) -> anyhow::Result<()> {
    if matches!(command, RankCommand::Run { .. } | RankCommand::Restart { .. }) {
        require_one_run(ranks.size(), |name| std::env::var(name).ok())?;
        require_known_vectors(ranks)?;
    }
    match command {
        RankCommand::Check { case, changes } => check::check(case, changes, ranks),
        RankCommand::Run { case, options, force, resume } => {
            run::run(case, options, run::Earlier::from_flags(*force, *resume), ranks)
        }
        RankCommand::Restart { checkpoint, options, force } => {
            run::restart(checkpoint, options, run::Earlier::from_flags(*force, false), ranks)
        }
        RankCommand::Contact(options) => contact::contact(options, ranks),
        RankCommand::Keys(options) => keys::keys(options, ranks),
        RankCommand::Info { file: Some(file) } => info::of_checkpoint(file, ranks),
        RankCommand::Info { file: None } => info::of_program(ranks),
    }
}

/// Rejects an unknown name in `TALCUM_VECTORS` on any rank: the variable may be missing on some. Collective.
fn require_known_vectors(ranks: &dyn Communicator) -> anyhow::Result<()> {
    let checked = check_instruction_set();
    let mut wrong = [i64::from(checked.is_err())];
    ranks.sum_integers(&mut wrong);
    checked?;
    anyhow::ensure!(
        wrong[0] == 0,
        "the environment variable TALCUM_VECTORS is wrong on {} ranks",
        wrong[0]
    );
    Ok(())
}

impl RankCommand {
    /// The requested number of threads, if any.
    fn threads(&self) -> Option<usize> {
        let changes = match self {
            Self::Check { changes, .. } => changes,
            Self::Run { options, .. } | Self::Restart { options, .. } => &options.changes,
            Self::Contact(_) | Self::Keys(_) | Self::Info { .. } => return None,
        };
        changes.threads.map(|threads| threads as usize)
    }
}
