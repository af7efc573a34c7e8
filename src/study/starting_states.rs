//! Looks up the states with which the runs of a study begin, among the runs of another study.

use crate::input::{InputErrors, Problems};
use crate::study::checker::CaseChecker;
use crate::study::definition::Study;
use crate::study::folder::StudyFolder;
use crate::study::member::Member;
use crate::study::problem::{error_at, result};
use crate::study::session::Session;
use crate::study::setting::{SEED, Setting};
use crate::study::start::{Start, StartState};
use crate::study::task::RunState;
use std::sync::Arc;

/// The states with which the runs of a study may begin: none if it has no `[start]`.
///
/// # Errors
/// If the other study is refused, is more than replicates of one run, or lacks a seed of this one.
pub(crate) fn starting_states(
    study: &Study,
    checker: &dyn CaseChecker,
) -> Result<Vec<StartState>, InputErrors> {
    let Some(start) = &study.start else { return Ok(Vec::new()) };
    let problems = Problems::default();
    let refuse = |key: &str, message: String| {
        problems.add(error_at(start.line, key, message));
    };
    let states = states_of(start, checker).unwrap_or_else(|message| {
        refuse("start.study", message);
        Vec::new()
    });
    for replicate in 0..study.replicate_count() {
        let settings = study.replicates.iter().flat_map(|axis| axis.settings(replicate));
        let settings: Vec<Setting> = settings.collect();
        if !states.is_empty() && !states.iter().any(|state| state.belongs_to(&settings)) {
            let seed = settings.iter().find(|setting| setting.key == SEED);
            let seed = seed.map(|setting| setting.value.plain()).unwrap_or_default();
            refuse("start.study", format!("{} has no seed {seed}", start.study.display()));
        }
    }
    result(problems, &study.file, Some(states))
}

fn states_of(start: &Start, checker: &dyn CaseChecker) -> Result<Vec<StartState>, String> {
    let name = start.study.display();
    let other = crate::study::file::read(&start.study);
    let other = other.map_err(|refusal| format!("is refused: {refusal}"))?;
    if !other.axes.is_empty() || other.bisection.is_some() || other.start.is_some() {
        return Err(format!("{name} must have one run for each seed: no axis, bisection or start"));
    }
    let folder = StudyFolder::at(&start.results);
    let session = Session::new(&other, &folder, Vec::new(), checker);
    let session = session.map_err(|refusal| format!("is refused: {refusal}"))?;
    let members = session.plan.tasks.iter().flat_map(|task| task.planned());
    let state = |member: &Arc<Member>| StartState {
        name: folder.name_of(member).to_owned(),
        identity: member.identity.clone(),
        seed: member.setting(SEED).map(|setting| setting.value.clone()),
        folder: folder.run(member),
        end: match folder.state(member) {
            RunState::Done(digest) => {
                folder.last_checkpoint(member).map(|path| (folder.root().join(path), digest))
            }
            _ => None,
        },
    };
    Ok(members.map(state).collect())
}
