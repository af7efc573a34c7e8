//! A part of a study that can run by itself: one run, a chain of runs, or a search.

use crate::study::bisection::{Bisection, Search};
use crate::study::member::{Member, MemberFactory};
use crate::study::quantity::Measured;
use crate::study::setting::{Setting, Value};
use std::cell::RefCell;
use std::sync::Arc;

/// How far a run has come.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum RunState {
    /// There is nothing yet.
    Waiting,
    /// It was begun and can be resumed.
    Begun,
    /// It is complete, with this digest.
    Done(String),
    /// It ended with an error.
    Failed(String),
}

/// What is known about the runs of a study.
pub(crate) trait Records {
    /// How far a run has come.
    fn state(&self, member: &Member) -> RunState;

    /// A quantity of a complete run.
    ///
    /// # Errors
    /// If the results do not hold it.
    fn measure(&self, member: &Member, name: &str) -> Result<Measured, String>;
}

/// A part of a study that depends on no other part.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Task {
    /// Its name, which does not change when others are added.
    pub(crate) name: String,
    /// The number of its first point, from 0.
    pub(crate) point: usize,
    /// Which replicate it is, from 0.
    pub(crate) replicate: usize,
    /// What it does.
    pub(crate) kind: TaskKind,
}

/// What a task does.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum TaskKind {
    /// Runs one after another; each but the first begins with the end of the one before.
    Runs(Vec<Arc<Member>>),
    /// A search for a critical value.
    Search {
        /// What all its runs set.
        settings: Vec<Setting>,
        /// Where the critical value is sought.
        bracket: [f64; 2],
    },
}

/// What a task needs next.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Progress {
    /// These runs, in any order.
    Run(Vec<Arc<Member>>),
    /// Nothing: it is done.
    Finished,
    /// Nothing helps, for this reason.
    Failed(String),
}

/// The result of a search, with the runs that it made, in the order of the key.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SearchRecord {
    /// How far it came.
    pub(crate) search: Search,
    /// Its runs, those that it needs next included.
    pub(crate) members: Vec<Arc<Member>>,
    /// Why it cannot continue.
    pub(crate) failure: Option<String>,
}

impl Task {
    /// The runs that are known from the start.
    pub(crate) fn planned(&self) -> &[Arc<Member>] {
        match &self.kind {
            TaskKind::Runs(members) => members,
            TaskKind::Search { .. } => &[],
        }
    }

    /// All runs that are known by now.
    ///
    /// # Errors
    /// If the case cannot be read.
    pub(crate) fn members(
        &self,
        search: Option<&Bisection>,
        factory: &MemberFactory<'_>,
        records: &dyn Records,
    ) -> Result<Vec<Arc<Member>>, String> {
        match search {
            Some(search) => Ok(self.search(search, factory, records)?.members),
            None => Ok(self.planned().to_vec()),
        }
    }

    /// What the task needs next.
    ///
    /// # Errors
    /// If the case cannot be read.
    pub(crate) fn progress(
        &self,
        search: Option<&Bisection>,
        factory: &MemberFactory<'_>,
        records: &dyn Records,
    ) -> Result<Progress, String> {
        let Some(bisection) = search else { return Ok(progress_of_runs(self.planned(), records)) };
        let record = self.search(bisection, factory, records)?;
        if let Some(failure) = record.failure {
            return Ok(Progress::Failed(failure));
        }
        Ok(match record.search {
            Search::Found(_) => Progress::Finished,
            Search::Unchanged { bracket, measured } => {
                Progress::Failed(bisection.explain(bracket, measured))
            }
            Search::Needs(_) => Progress::Run(
                record.members.into_iter().filter(|m| can_run(&records.state(m))).collect(),
            ),
        })
    }

    /// Follows the search as far as runs are complete.
    ///
    /// # Errors
    /// If the case cannot be read.
    pub(crate) fn search(
        &self,
        bisection: &Bisection,
        factory: &MemberFactory<'_>,
        records: &dyn Records,
    ) -> Result<SearchRecord, String> {
        let TaskKind::Search { settings, bracket } = &self.kind else {
            return Err(format!("{} is not a search", self.name));
        };
        let make = |number: f64| {
            let (key, line) = (bisection.key.clone(), bisection.line);
            let value = Value::from_number(number);
            let all = settings.iter().cloned().chain([Setting { key, value, line }]);
            let member = factory.member(self.point, self.replicate, all.collect(), None);
            member.map(Arc::new).map_err(String::from)
        };
        let members = RefCell::new(Vec::new());
        let failure = RefCell::new(None);
        let search = bisection.search(*bracket, &mut |number| {
            let measured = make(number).and_then(|member| {
                members.borrow_mut().push((number, Arc::clone(&member)));
                measured(&member, bisection, records)
            });
            measured.unwrap_or_else(|message| {
                failure.borrow_mut().get_or_insert(message);
                None
            })
        });
        let mut members = members.into_inner();
        members.sort_by(|(one, _), (other, _)| one.total_cmp(other));
        let members = members.into_iter().map(|(_, member)| member).collect();
        Ok(SearchRecord { search, members, failure: failure.into_inner() })
    }
}

/// The quantity that decides, if the run is complete.
fn measured(
    member: &Member,
    search: &Bisection,
    records: &dyn Records,
) -> Result<Option<f64>, String> {
    match records.state(member) {
        RunState::Done(_) => {
            let measured = records.measure(member, &search.quantity)?;
            let count = search.threshold.count(&measured.value);
            count.map(Some).map_err(|why| format!("{}: {}: {why}", member.name, search.quantity))
        }
        RunState::Failed(reason) => Err(format!("{}: {reason}", member.name)),
        _ => Ok(None),
    }
}

fn can_run(state: &RunState) -> bool {
    matches!(state, RunState::Waiting | RunState::Begun)
}

/// The first run that is not complete is next.
fn progress_of_runs(members: &[Arc<Member>], records: &dyn Records) -> Progress {
    for (index, member) in members.iter().enumerate() {
        match records.state(member) {
            RunState::Done(_) => {}
            RunState::Failed(reason) => {
                let waiting = members.len() - index - 1;
                let rest = match waiting {
                    0 => String::new(),
                    _ => format!("\n{waiting} more of its chain cannot start"),
                };
                return Progress::Failed(format!("{}: {reason}{rest}", member.name));
            }
            _ => return Progress::Run(vec![Arc::clone(member)]),
        }
    }
    Progress::Finished
}
