//! A study that has been read, expanded and checked.

use crate::study::case_text::continued;
use crate::study::checker::CaseChecker;
use crate::study::definition::Study;
use crate::study::folder::{Results, StudyFolder, make_folder, write_whole};
use crate::study::member::{Member, MemberFactory};
use crate::study::plan::Plan;
use crate::study::problem::{error_at, result};
use crate::study::run_outline::RunOutline;
use crate::study::setting::{Setting, Value};
use crate::study::start::StartState;
use crate::study::task::{Records, RunState, Task, TaskKind};
use talcum_runs::input::{InputErrors, Problems, SourcePlace};

/// A study with its folder and its runs.
pub(crate) struct Session<'a> {
    /// The definition in the file.
    pub(crate) study: &'a Study,
    /// Its folder.
    pub(crate) folder: &'a StudyFolder,
    /// Makes its runs.
    pub(crate) factory: MemberFactory<'a>,
    /// Its points and tasks.
    pub(crate) plan: Plan,
    checker: &'a dyn CaseChecker,
}

impl<'a> Session<'a> {
    /// Expands a study whose runs begin with these states of another one, if there are any. Only the case of continued
    /// runs is written.
    ///
    /// # Errors
    /// If the study is not valid, or the folder cannot be written.
    pub(crate) fn new(
        study: &'a Study,
        folder: &'a StudyFolder,
        starts: Vec<StartState>,
        checker: &'a dyn CaseChecker,
    ) -> Result<Self, InputErrors> {
        write_continued_case(study, folder)?;
        let factory = MemberFactory::new(study, checker, folder.continued_case(), starts);
        let plan = Plan::new(study, &factory, checker)?;
        Ok(Self { study, folder, factory, plan, checker })
    }

    /// Data on the runs.
    pub(crate) fn results(&self) -> Results<'a> {
        Results { folder: self.folder, quantities: &self.study.quantities }
    }

    /// Checks the case of every run of some tasks that has not begun, before anything runs.
    ///
    /// # Errors
    /// Everything that is wrong, with the lines of the study file.
    pub(crate) fn check(&self, tasks: &[Task]) -> Result<(), InputErrors> {
        let problems = Problems::default();
        let members = self.members_to_check(tasks);
        let members = members.map_err(|message| problems.add_at(SourcePlace::File, message));
        let members = members.unwrap_or_default();
        if !members.is_empty() {
            log::info!("checking {}", count_of(members.len(), "case"));
        }
        let check = |member| self.check_member(member, &problems);
        let runs: Vec<RunOutline> = members.iter().filter_map(check).collect();
        self.check_quantities(&runs, &problems);
        result(problems, &self.study.file, Some(()))
    }

    /// All runs that are already known and have not begun; for a search, the ends of its bracket and its middle.
    fn members_to_check(&self, tasks: &[Task]) -> Result<Vec<Member>, String> {
        let mut members = Vec::new();
        for task in tasks {
            members.extend(task.planned().iter().map(|member| (**member).clone()));
            let (Some(search), TaskKind::Search { settings, bracket: [lower, upper] }) =
                (&self.study.bisection, &task.kind)
            else {
                continue;
            };
            for number in [*lower, *upper, search.middle(*lower, *upper)] {
                let (key, value) = (search.key.clone(), Value::from_number(number));
                let setting = Setting { key, value, line: search.line };
                let settings = settings.iter().cloned().chain([setting]).collect();
                members.push(self.factory.member(task.point, task.replicate, settings, None)?);
            }
        }
        members.retain(|member| self.results().state(member) == RunState::Waiting);
        Ok(members)
    }

    /// Refuses quantities for which none of the runs has anything.
    fn check_quantities(&self, runs: &[RunOutline], problems: &Problems) {
        for quantity in &self.study.quantities {
            let reasons: Option<Vec<String>> =
                runs.iter().map(|run| quantity.quantity.impossible(run)).collect();
            if let Some(reason) = reasons.unwrap_or_default().first() {
                problems.add(quantity.error(format!("no run can give it: {reason}")));
            }
        }
    }

    /// Reports what is wrong with the case of a run and its quantities; returns the outline of a run whose case can be read.
    fn check_member(&self, member: &Member, problems: &Problems) -> Option<RunOutline> {
        let start = member.start.as_deref().map(StartState::checkpoint).transpose();
        let start = start.unwrap_or_else(|message| {
            let line = self.study.start.as_ref().map_or(0, |start| start.line);
            problems.add(error_at(line, "start.study", message));
            None
        });
        let before = member.predecessor.as_deref();
        let request = self.factory.request(&member.settings, before, start.as_deref());
        let run = match self.checker.check(&request) {
            Ok(run) => run,
            Err(wrong) => {
                wrong.into_iter().for_each(|it| problems.add(it.place(&request.settings)));
                return None;
            }
        };
        for quantity in &self.study.quantities {
            if let Err(message) = quantity.quantity.check(&run) {
                problems.add(quantity.error(message));
            }
        }
        Some(run)
    }
}

/// Writes the case of continued runs, if the study has any.
fn write_continued_case(study: &Study, folder: &StudyFolder) -> Result<(), InputErrors> {
    let Some(continuation) = &study.continuation else { return Ok(()) };
    let problems = Problems::default();
    let text = std::fs::read_to_string(&study.case).map_err(|error| error.to_string());
    let written = text.and_then(|text| continued(&text, continuation)).and_then(|text| {
        let path = folder.continued_case();
        // The file is left unchanged if it is already correct, since other processes may read it.
        if std::fs::read_to_string(&path).is_ok_and(|old| old == text) {
            return Ok(());
        }
        make_folder(folder.root())?;
        write_whole(&path, &text)
    });
    if let Err(message) = written {
        problems.add_at(SourcePlace::File, format!("{}: {message}", study.case.display()));
    }
    result(problems, &study.file, Some(()))
}

/// A count with its noun: `1 run`, `2 runs`.
pub(crate) fn count_of(count: usize, noun: &str) -> String {
    if count == 1 { format!("1 {noun}") } else { format!("{count} {noun}s") }
}
