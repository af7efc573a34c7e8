//! `talcum study`: its options and its actions.

use crate::study::checker::CaseReader;
use crate::study::definition::{Launcher, Study};
use crate::study::file;
use crate::study::folder::{StudyFolder, make_folder};
use crate::study::job::TalcumRunner;
use crate::study::known::KnownRuns;
use crate::study::scheduler::{Outcome, PAUSE, Scheduler};
use crate::study::session::{Session, count_of};
use crate::study::signals::StopSignals;
use crate::study::starting_states::starting_states;
use crate::study::table::{collect, csv};
use crate::study::task::{Progress, Task};
use crate::study::{status, templates};
use anyhow::{Context, anyhow, bail};
use clap::Args;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use talcum_results::output::lock::{Sharing, holder, sign, try_lock, wait_for_lock};
use talcum_results::output::{ResultTable, print};

/// Options of `talcum study`.
#[derive(Clone, Debug, Args)]
pub struct StudyOptions {
    /// The study file.
    pub(crate) study: PathBuf,
    /// Write the results to this folder (default: results/NAME for a study NAME.toml).
    #[arg(long, value_name = "FOLDER")]
    pub(crate) output: Option<PathBuf>,
    /// Make each run on so many ranks, instead of as the study says.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) ranks_per_run: Option<u64>,
    /// Make so many runs at the same time, instead of as the study says.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) at_a_time: Option<u64>,
    /// Start each run with this command, for example "srun -n {ranks}"; or, with "threads", on threads.
    #[arg(long, value_name = "COMMAND")]
    pub(crate) launcher: Option<String>,
    /// Work only on the task with this number or name (see --only-list).
    #[arg(long, value_name = "TASK")]
    pub(crate) run: Option<String>,
    /// Take the complete runs from this table, a runs.csv of the same study, instead of making them again; may be
    /// repeated.
    #[arg(long, value_name = "RUNS_CSV")]
    pub(crate) known: Vec<PathBuf>,
    /// Try failed runs again.
    #[arg(long)]
    pub(crate) retry: bool,
    /// Only list the tasks with their numbers.
    #[arg(long, group = "only")]
    pub(crate) only_list: bool,
    /// Only print which runs are done, running, waiting or failed, and why.
    #[arg(long, group = "only")]
    pub(crate) status: bool,
    /// Only write the tables of the complete runs.
    #[arg(long, group = "only")]
    pub(crate) table: bool,
    /// Only write a Slurm array job into the folder of the study.
    #[arg(long, group = "only")]
    pub(crate) write_slurm: bool,
    /// Only write a workflow for row into the folder of the study.
    #[arg(long, group = "only")]
    pub(crate) write_row: bool,
}

/// Exit code of a study that was stopped and can be resumed: "try again" in sysexits.h.
pub(crate) const STOPPED: u8 = 75;

/// Executes `talcum study` with these options; `program` runs the cases. The exit code is 0 if all is complete, 1 if
/// something failed, 75 if the study was stopped and can be resumed.
///
/// # Errors
/// If the study is rejected, or its folder cannot be written.
pub fn run(options: &StudyOptions, program: PathBuf) -> anyhow::Result<ExitCode> {
    StudyCommand { program }.run(options)
}

/// A study with its options and the program for its runs.
struct StudyCommand {
    /// The program that runs cases.
    program: PathBuf,
}

impl StudyCommand {
    fn run(&self, options: &StudyOptions) -> anyhow::Result<ExitCode> {
        let mut study = file::read(&options.study)?;
        options.apply(&mut study);
        let folder = StudyFolder::at(&options.folder()).with_known(options.known_runs(&study)?);
        let starts = starting_states(&study, &CaseReader)?;
        let session = Session::new(&study, &folder, starts, &CaseReader)?;
        if options.only_list {
            print(status::list(&session).map_err(anyhow::Error::msg)?.trim_end())?;
        } else if options.status {
            print(&status::status(&session).map_err(anyhow::Error::msg)?)?;
        } else if options.write_slurm {
            let path = templates::write_slurm(&session, &self.program);
            print(&format!("wrote {}", path.map_err(anyhow::Error::msg)?.display()))?;
        } else if options.write_row {
            let path = templates::write_row(&session, &self.program);
            print(&format!("wrote {}", path.map_err(anyhow::Error::msg)?.display()))?;
        } else if options.table {
            return self.write_tables(&session).map(|ok| exit_code(ok, false));
        } else {
            return self.work(&session, options);
        }
        Ok(ExitCode::SUCCESS)
    }

    fn work(&self, session: &Session<'_>, options: &StudyOptions) -> anyhow::Result<ExitCode> {
        let root = session.folder.root();
        make_folder(root).map_err(anyhow::Error::msg)?;
        let tasks = options.tasks(session)?;
        let _locks = lock(root, options, tasks)?;
        session.check(tasks)?;
        if options.retry {
            forget_failures(session, tasks).map_err(anyhow::Error::msg)?;
        }
        let signals = StopSignals::catch().context("signals cannot be caught")?;
        let resources = session.study.resources.clone();
        let runner = TalcumRunner { program: self.program.clone(), resources };
        let scheduler = Scheduler {
            factory: &session.factory,
            search: session.study.bisection.as_ref(),
            results: session.results(),
            runner: &runner,
            at_a_time: usize::try_from(session.study.resources.at_a_time).unwrap_or(usize::MAX),
            stop: &|| signals.request(),
            pause: PAUSE,
        };
        let outcome = scheduler.run(tasks).map_err(anyhow::Error::msg)?;
        let measured = self.write_tables(session)?;
        tell_row(session, tasks)?;
        self.report(session, &outcome)?;
        Ok(exit_code(measured && outcome.failures.is_empty(), outcome.stopped))
    }

    fn report(&self, session: &Session<'_>, outcome: &Outcome) -> anyhow::Result<()> {
        let tasks = &session.plan.tasks;
        let mut done = 0;
        for task in tasks {
            let finished = progress(session, task)? == Progress::Finished;
            done += usize::from(finished);
        }
        print(&format!("{done} of {} done", count_of(tasks.len(), "task")))?;
        for failure in &outcome.failures {
            print(&format!("failed: {failure}"))?;
        }
        if outcome.stopped {
            print("stopped; run the same command again to resume")?;
        }
        Ok(())
    }

    /// Writes all tables; returns whether every complete run could be read.
    fn write_tables(&self, session: &Session<'_>) -> anyhow::Result<bool> {
        let root = session.folder.root();
        make_folder(root).map_err(anyhow::Error::msg)?;
        // The process that writes last has also read last, so that tables of several processes do not overtake each
        // other.
        let _lock = wait_for_lock(&root.join("tables.lock")).map_err(anyhow::Error::msg)?;
        let collected = collect(session).map_err(anyhow::Error::msg)?;
        let mut written = csv::write(&collected.tables, root).map_err(anyhow::Error::msg)?;
        written.push(write_hdf5(&collected.tables, root)?);
        for path in written {
            log::info!("wrote {}", path.display());
        }
        for failure in &collected.failures {
            log::error!("no value: {failure}");
        }
        Ok(collected.failures.is_empty())
    }
}

/// Writes all tables into one file, `study.h5`; its root has their provenance, and the hash of their contents.
fn write_hdf5(tables: &[ResultTable], root: &Path) -> anyhow::Result<PathBuf> {
    let path = root.join("study.h5");
    let mut provenance = tables.first().map(|table| table.provenance.clone()).unwrap_or_default();
    provenance.push(("tables_blake3".to_owned(), ResultTable::digest_of(tables)));
    ResultTable::write_all(&path, &provenance, tables)?;
    Ok(path)
}

impl StudyOptions {
    fn apply(&self, study: &mut Study) {
        let resources = &mut study.resources;
        resources.ranks = self.ranks_per_run.unwrap_or(resources.ranks);
        resources.at_a_time = self.at_a_time.unwrap_or(resources.at_a_time);
        if let Some(text) = &self.launcher {
            resources.launcher = Launcher::from_text(text);
        }
    }

    fn folder(&self) -> PathBuf {
        self.output.clone().unwrap_or_else(|| StudyFolder::default_of(&self.study))
    }

    /// The runs that need not be made. Runs of a chain begin with each other's ends, which tables do not contain.
    fn known_runs(&self, study: &Study) -> anyhow::Result<KnownRuns> {
        if !self.known.is_empty() && study.continuation.is_some() {
            bail!(
                "--known: {} has a continuation, whose runs begin with the checkpoints of others",
                study.file.display()
            );
        }
        KnownRuns::read(&self.known, &study.quantities)
            .map_err(|message| anyhow!("--known {message}"))
    }

    /// The tasks to work on.
    fn tasks<'s>(&self, session: &'s Session<'_>) -> anyhow::Result<&'s [Task]> {
        let tasks = session.plan.tasks.as_slice();
        let Some(wanted) = &self.run else { return Ok(tasks) };
        let by_number = wanted.parse::<usize>().ok().and_then(|number| number.checked_sub(1));
        let index = by_number.or_else(|| tasks.iter().position(|task| task.name == *wanted));
        let task = index.and_then(|index| tasks.get(index..=index));
        task.ok_or_else(|| {
            anyhow!(
                "--run {wanted}: must be a number from 1 to {} or a name; see --only-list",
                tasks.len()
            )
        })
    }
}

/// Locks the work against other processes: the whole study, or one task of it.
fn lock(root: &Path, options: &StudyOptions, tasks: &[Task]) -> anyhow::Result<Vec<File>> {
    let sharing = if options.run.is_some() { Sharing::Shared } else { Sharing::Exclusive };
    let mut locks = vec![take(&root.join("study.lock"), sharing)?];
    if let (Some(_), Some(task)) = (&options.run, tasks.first()) {
        let folder = root.join("locks");
        make_folder(&folder).map_err(anyhow::Error::msg)?;
        locks.push(take(&folder.join(format!("{}.lock", task.name)), Sharing::Exclusive)?);
    }
    Ok(locks)
}

fn take(path: &Path, sharing: Sharing) -> anyhow::Result<File> {
    match try_lock(path, sharing).map_err(anyhow::Error::msg)? {
        Some(file) => {
            sign(&file);
            Ok(file)
        }
        None => {
            bail!("{} is held by {}: the study is already running", path.display(), holder(path))
        }
    }
}

fn progress(session: &Session<'_>, task: &Task) -> anyhow::Result<Progress> {
    let search = session.study.bisection.as_ref();
    let progress = task.progress(search, &session.factory, &session.results());
    progress.map_err(anyhow::Error::msg)
}

fn forget_failures(session: &Session<'_>, tasks: &[Task]) -> Result<(), String> {
    let search = session.study.bisection.as_ref();
    for task in tasks {
        for member in task.members(search, &session.factory, &session.results())? {
            session.folder.forget_failure(&member)?;
        }
    }
    Ok(())
}

fn tell_row(session: &Session<'_>, tasks: &[Task]) -> anyhow::Result<()> {
    for task in tasks {
        // A search without a crossing will not find one later either.
        if !matches!(progress(session, task)?, Progress::Run(_)) {
            templates::tell_row(session.folder.root(), task).map_err(anyhow::Error::msg)?;
        }
    }
    Ok(())
}

fn exit_code(success: bool, stopped: bool) -> ExitCode {
    match (stopped, success) {
        (true, _) => ExitCode::from(STOPPED),
        (false, true) => ExitCode::SUCCESS,
        (false, false) => ExitCode::FAILURE,
    }
}
