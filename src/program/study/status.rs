//! Status of a study: runs that are done, running, waiting, or failed, with the reasons.

use crate::study::member::Member;
use crate::study::session::{Session, count_of};
use crate::study::setting::shortest;
use crate::study::task::{Progress, Records, RunState, Task};
use std::fmt::Write;

/// The tasks by number and name, one line each.
///
/// # Errors
/// If the case cannot be read.
pub(crate) fn list(session: &Session<'_>) -> Result<String, String> {
    let mut text = String::new();
    for (index, task) in session.plan.tasks.iter().enumerate() {
        let state = match progress(session, task)? {
            Progress::Finished => "done",
            Progress::Failed(_) => "failed",
            Progress::Run(_) => "not complete",
        };
        let _ = writeln!(text, "{:>4}  {state:<12}  {}", index + 1, task.name);
    }
    Ok(text)
}

/// The state of every run that is already known, and of every task that failed.
///
/// # Errors
/// If the case cannot be read.
pub(crate) fn status(session: &Session<'_>) -> Result<String, String> {
    let (mut text, mut counts) = (String::new(), [0; 4]);
    let search = session.study.bisection.as_ref();
    let mut failed_searches = 0;
    for task in &session.plan.tasks {
        for member in task.members(search, &session.factory, &session.results())? {
            let (kind, line) = describe(session, &member);
            counts[kind] += 1;
            let _ = writeln!(text, "{line}");
        }
        if let (Progress::Failed(reason), true) = (progress(session, task)?, search.is_some()) {
            failed_searches += 1;
            let _ = writeln!(text, "search {}: {}", task.name, indented(&reason));
        }
    }
    let [done, running, waiting, failed] = counts;
    let known = count_of(done + running + waiting + failed, "run");
    let so_far = if search.is_some() { " so far" } else { "" };
    let _ = write!(
        text,
        "{known}{so_far}: {done} done, {running} running, {waiting} waiting, {failed} failed"
    );
    if failed_searches > 0 {
        let _ = write!(text, "; {failed_searches} of the searches without a result");
    }
    Ok(text)
}

/// The index of a run's state among the counts, and its line.
fn describe(session: &Session<'_>, member: &Member) -> (usize, String) {
    let folder = session.folder;
    let name = folder.name_of(member);
    let time = || {
        let end = member.end_time.map(|end| format!(" of {}", shortest(end))).unwrap_or_default();
        folder.time_reached(member).map(|time| format!(", at time {}{end}", shortest(time)))
    };
    match session.results().state(member) {
        RunState::Done(digest) => (0, format!("done      {name}, digest {digest}")),
        RunState::Failed(reason) => (3, format!("failed    {name}: {}", indented(&reason))),
        _ if folder.is_running(member) => {
            (1, format!("running   {name}{}", time().unwrap_or_default()))
        }
        RunState::Begun => (2, format!("waiting   {name}{}", time().unwrap_or_default())),
        RunState::Waiting => (2, format!("waiting   {name}")),
    }
}

fn progress(session: &Session<'_>, task: &Task) -> Result<Progress, String> {
    task.progress(session.study.bisection.as_ref(), &session.factory, &session.results())
}

/// Indents the further lines of a reason below its first.
fn indented(reason: &str) -> String {
    reason.trim_end().replace('\n', "\n          ")
}
