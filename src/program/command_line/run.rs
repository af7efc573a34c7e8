//! `talcum run` and `talcum restart`.

use super::memory;
use super::naming::{adopt_title, name_differences};
use super::progress::ProgressReport;
use super::reading::read_case;
use super::{RunArguments, report, signals};
use anyhow::{Context, anyhow, bail};
use std::path::{Path, PathBuf};
use talcum_engine::parallel::{Communicator, agree};
use talcum_results::output::checkpoint::{self, Checkpoint};
use talcum_results::output::print;
use talcum_runs::case::{BedStart, Case, changes};
use talcum_runs::simulation::{
    self, InitialState, Outcome, OutputFolder, RunError, RunOptions, start_from_case,
    start_from_checkpoint,
};

/// Treatment of the results of an earlier run in the output folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Earlier {
    /// They are kept: the run does not start.
    Keep,
    /// They are removed.
    Remove,
    /// They are continued from the newest good checkpoint.
    Continue,
}

impl Earlier {
    pub(super) fn from_flags(force: bool, resume: bool) -> Self {
        match (force, resume) {
            (true, _) => Self::Remove,
            (_, true) => Self::Continue,
            _ => Self::Keep,
        }
    }
}

/// Runs a case from its start, or from the newest good checkpoint in its output folder.
pub(super) fn run(
    path: &Path,
    options: &RunArguments,
    earlier: Earlier,
    ranks: &dyn Communicator,
) -> anyhow::Result<()> {
    let mut case = read_case(path, &options.changes.set, ranks)?;
    memory::require(&case, options.changes.any_memory, ranks)?;
    let name = path.file_stem().unwrap_or_default();
    let folder = OutputFolder {
        path: options.output.clone().unwrap_or_else(|| Path::new("results").join(name)),
        case_folder: path.parent().map(absolute).unwrap_or_default(),
    };
    let _lock = folder.lock(ranks)?;
    prepare_folder(&folder, earlier, ranks)?;
    let initial = match earlier {
        Earlier::Continue => resume(&mut case, &folder, options, ranks)?,
        _ => begin(&mut case, options, ranks)?,
    };
    let [shown, output] = [path, &folder.path].map(|path| in_shell(&path.display().to_string()));
    let resume = |_: &Path| {
        let changes = options.changes.set.iter();
        let changes: String =
            changes.map(|change| format!(" --set {}", in_shell(change))).collect();
        format!("talcum run {shown} --resume --output {output}{changes}")
    };
    run_to_end(&case, initial, folder, options, &resume, ranks)
}

/// Continues from a checkpoint with the case that it contains.
pub(super) fn restart(
    path: &Path,
    options: &RunArguments,
    earlier: Earlier,
    ranks: &dyn Communicator,
) -> anyhow::Result<()> {
    let (checkpoint, _, digest) = checkpoint::read(path, ranks)?;
    say(ranks, &format!("{}: state {digest} at time {}", path.display(), checkpoint.clock.time()))?;
    let name = format!("the case in {}", path.display());
    let case_folder = PathBuf::from(&checkpoint.case_folder);
    let text = &checkpoint.case_text;
    let mut case =
        agree(Case::of_earlier_run(text, &name, &case_folder, &options.changes.set), ranks)?;
    say_changes(&checkpoint.case_text, &case, ranks)?;
    let own_folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let output = options.output.clone().unwrap_or_else(|| own_folder.clone());
    let folder = OutputFolder { path: output, case_folder };
    // Results are continued if the checkpoint lies among them; otherwise new ones begin.
    let continues = same_folder(&folder.path, &own_folder);
    if continues && earlier == Earlier::Remove {
        bail!(
            "{}: --force would remove the checkpoint itself: name another folder with --output",
            folder.path.display()
        );
    }
    let _lock = folder.lock(ranks)?;
    if !continues {
        prepare_folder(&folder, earlier, ranks)?;
    }
    let begins_with = (!continues).then_some(&digest);
    name_differences(&mut case, &options.changes.set, begins_with)?;
    let grid = options.changes.ranks;
    let initial = start_from_checkpoint(&case, checkpoint, grid, continues, ranks)?;
    let resume = |checkpoint: &Path| {
        format!("talcum restart {}", in_shell(&checkpoint.display().to_string()))
    };
    run_to_end(&case, initial, folder, options, &resume, ranks)
}

/// Prints the differences from the case with which a checkpoint was written.
fn say_changes(before: &str, case: &Case, ranks: &dyn Communicator) -> anyhow::Result<()> {
    let mut changes = changes(before, &case.text).into_iter();
    changes.try_for_each(|change| say(ranks, &format!("changed since the checkpoint: {change}")))
}

/// The start of the case, whose title then gives the differences from its file.
fn begin(
    case: &mut Case,
    options: &RunArguments,
    ranks: &dyn Communicator,
) -> anyhow::Result<InitialState> {
    let initial = start_from_case(case, options.changes.ranks, ranks)?;
    if let (Some(digest), BedStart::Run { path }) = (&initial.begins_with, &case.particles.start) {
        say(ranks, &format!("begins with {}, state {digest}", path.display()))?;
    }
    name_differences(case, &options.changes.set, initial.begins_with.as_ref())?;
    Ok(initial)
}

/// The newest good checkpoint of the folder, or the start of the case if there is none.
fn resume(
    case: &mut Case,
    folder: &OutputFolder,
    options: &RunArguments,
    ranks: &dyn Communicator,
) -> anyhow::Result<InitialState> {
    let grid = options.changes.ranks;
    let search = checkpoint::newest_good(&folder.path, ranks)?;
    for refused in &search.refused {
        log::warn!("passed over: {refused}");
    }
    match search.found {
        Some((path, checkpoint, _, digest)) => {
            let time = checkpoint.clock.time();
            say(
                ranks,
                &format!("resuming from {} at time {time}, state {digest}", path.display()),
            )?;
            if let Some(ended) = case_of_complete_run(case, folder, &checkpoint, options, ranks)? {
                say(ranks, "the run is complete: what has changed in the case has no effect")?;
                *case = ended;
            } else {
                if !adopt_title(case, &options.changes.set, &checkpoint.case_text) {
                    name_differences(case, &options.changes.set, None)?;
                }
                say_changes(&checkpoint.case_text, case, ranks)?;
            }
            Ok(start_from_checkpoint(case, checkpoint, grid, true, ranks)?)
        }
        None if search.refused.is_empty() => {
            say(ranks, "no checkpoint to resume from: starting from the beginning")?;
            begin(case, options, ranks)
        }
        None => {
            let refused: String =
                search.refused.iter().map(|error| format!("\n  {error}")).collect();
            bail!(
                "{}: no checkpoint can be used:{refused}\nstart again in another folder with --output, or here with \
                 --force, which removes them",
                folder.path.display()
            )
        }
    }
}

/// The case with which a complete run was computed, if the present one differs from it in more than the title and the
/// division of the box. The run then keeps that case, so that neither its end nor results that are repaired are those
/// of another case. Collective.
fn case_of_complete_run(
    case: &Case,
    folder: &OutputFolder,
    end: &Checkpoint,
    options: &RunArguments,
    ranks: &dyn Communicator,
) -> anyhow::Result<Option<Case>> {
    let is_complete = ranks.any(ranks.is_root() && folder.is_complete());
    // The title of a run names its own changes.
    let counts = |key: &str| key != "title" && !key.starts_with("parallel.");
    if !is_complete || !changes(&end.case_text, &case.text).iter().any(|it| counts(&it.key)) {
        return Ok(None);
    }
    let name = "the case of the run's end";
    let ended = agree(Case::of_earlier_run(&end.case_text, name, &folder.case_folder, &[]), ranks)?;
    // Times are multiples of the step, but ends need not be.
    let is_reached = |time: f64| time - end.clock.time() <= 1.0e-9 * time.abs();
    let until = |case: &Case| options.until.unwrap_or(case.end_time());
    Ok(Some(ended).filter(|ended| is_reached(until(ended)) && is_reached(until(case))))
}

/// Refuses or removes the results of an earlier run.
fn prepare_folder(
    folder: &OutputFolder,
    earlier: Earlier,
    ranks: &dyn Communicator,
) -> anyhow::Result<()> {
    let holds_results = ranks.any(ranks.is_root() && folder.holds_results());
    match earlier {
        Earlier::Keep if holds_results => bail!(
            "{} holds the results of an earlier run: continue with --resume, replace them with --force, or name \
             another folder with --output",
            folder.path.display()
        ),
        Earlier::Remove => {
            let cleared = if ranks.is_root() { folder.clear() } else { Ok(()) };
            Ok(agree(cleared, ranks)?)
        }
        _ => Ok(()),
    }
}

fn run_to_end(
    case: &Case,
    initial: InitialState,
    folder: OutputFolder,
    options: &RunArguments,
    resume: &dyn Fn(&Path) -> String,
    ranks: &dyn Communicator,
) -> anyhow::Result<()> {
    let end_time = options.until.unwrap_or(case.end_time());
    let now = initial.state.clock.time();
    if !(end_time.is_finite() && end_time >= now) {
        bail!(
            "--until {end_time}: must be at least {now}, the time of the state that the run starts from"
        );
    }
    let particles = ranks.total(initial.state.particles.owned_count());
    say(ranks, report::head(case, particles, ranks.size()).trim_end())?;
    let stop = agree(signals::stop_flag(), ranks).context("signals cannot be caught")?;
    let mut progress = ProgressReport::new(ranks.is_root());
    let results = folder.path.clone();
    let run_options =
        RunOptions { end_time, folder, stop: &stop, watch: &mut |now| progress.show(now) };
    let outcome = simulation::run(case, initial, run_options, ranks)
        .map_err(|error| with_newest_checkpoint(error, &results, resume))?;
    progress.finish();
    let until = options.until.map(|time| format!(" --until {time}")).unwrap_or_default();
    let resume = resume(&outcome.checkpoint) + &until;
    say(ranks, &summary(&outcome, &resume, ranks.size()))
}

/// The error of a failed step, with the checkpoint from which to resume: the state after such a step is meaningless and
/// is not written.
fn with_newest_checkpoint(
    error: RunError,
    folder: &Path,
    resume: &dyn Fn(&Path) -> String,
) -> anyhow::Error {
    if !matches!(error, RunError::Step(_)) {
        return error.into();
    }
    let newest = checkpoint::files_in(folder).ok().and_then(|files| files.into_iter().next_back());
    let advice = match newest {
        Some(path) => format!(
            "the state of this step is not written; the newest checkpoint is {}: continue from it with another time.step, or \
             what else is to change, by: {} --set time.step=...",
            path.display(),
            resume(&path)
        ),
        None => "the state of this step is not written, and there is no checkpoint from before"
            .to_owned(),
    };
    anyhow!("{error}\n{advice}")
}

fn summary(outcome: &Outcome, resume: &str, ranks: usize) -> String {
    let table = report::table(outcome, ranks);
    let checkpoint = outcome.checkpoint.display();
    let end = if outcome.complete {
        format!("complete at time {}; the end state is in {checkpoint}", outcome.time)
    } else {
        format!("stopped at time {} with {checkpoint}; resume with: {resume}", outcome.time)
    };
    format!("{table}{end}\ndigest {}", outcome.digest)
}

/// Prints a message on standard output, from rank 0. Collective.
///
/// # Errors
/// If it cannot be written.
pub(super) fn say(ranks: &dyn Communicator, message: &str) -> anyhow::Result<()> {
    Ok(agree(if ranks.is_root() { print(message) } else { Ok(()) }, ranks)?)
}

/// A text as one word of a command for a shell.
fn in_shell(text: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "/._-+,:@%".contains(c);
    if !text.is_empty() && text.chars().all(is_plain) {
        text.to_owned()
    } else {
        format!("'{}'", text.replace('\'', "'\\''"))
    }
}

fn absolute(path: &Path) -> PathBuf {
    let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}

fn same_folder(first: &Path, second: &Path) -> bool {
    let whole =
        |path: &Path| std::fs::canonicalize(absolute(path)).unwrap_or_else(|_| absolute(path));
    whole(first) == whole(second)
}

#[cfg(test)]
mod tests {
    use super::in_shell;

    #[test]
    fn a_word_that_a_shell_would_take_apart_is_quoted() {
        assert_eq!(in_shell("results/12:30"), "results/12:30");
        assert_eq!(in_shell("it's a bed"), r"'it'\''s a bed'");
        assert_eq!(in_shell("time.end={from=1}"), "'time.end={from=1}'");
        assert_eq!(in_shell(""), "''");
    }
}
