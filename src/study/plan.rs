//! From the axes of a study to its points and tasks.

use crate::input::{InputErrors, Problems, SourcePlace};
use crate::study::checker::CaseChecker;
use crate::study::definition::Study;
use crate::study::member::{Member, MemberFactory};
use crate::study::problem::{CaseProblem, error_at, result};
use crate::study::setting::{SEED, Setting};
use crate::study::task::{Task, TaskKind};
use std::collections::HashMap;
use std::sync::Arc;

/// A combination of values of all axes but the replicates.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Point {
    /// Its position on each axis.
    pub(crate) positions: Vec<usize>,
    /// What it sets.
    pub(crate) settings: Vec<Setting>,
}

/// All points of a study, and the tasks that measure them.
#[derive(Debug)]
pub(crate) struct Plan {
    /// The points; the last axis varies fastest.
    pub(crate) points: Vec<Point>,
    /// The tasks, which do not depend on each other.
    pub(crate) tasks: Vec<Task>,
}

/// All combinations of positions on axes of these lengths; the last one varies fastest.
fn combinations(lengths: &[usize]) -> Vec<Vec<usize>> {
    lengths.iter().fold(vec![Vec::new()], |shorter, &length| {
        let longer = |start: &Vec<usize>| {
            let start = start.clone();
            (0..length).map(move |position| {
                start.iter().copied().chain([position]).collect::<Vec<usize>>()
            })
        };
        shorter.iter().flat_map(longer).collect()
    })
}

fn points(study: &Study) -> Vec<Point> {
    let lengths: Vec<usize> = study.axes.iter().map(|axis| axis.values.len()).collect();
    let point = |positions: Vec<usize>| {
        let axes = study.axes.iter().zip(&positions);
        let settings = axes.flat_map(|(axis, &position)| axis.settings(position)).collect();
        Point { positions, settings }
    };
    combinations(&lengths).into_iter().map(point).collect()
}

/// No study has more runs than this.
const MOST_RUNS: usize = 1_000_000;

impl Plan {
    /// Expands a study.
    ///
    /// # Errors
    /// If the case cannot be read, or if two runs are the same.
    pub(crate) fn new(
        study: &Study,
        factory: &MemberFactory<'_>,
        checker: &dyn CaseChecker,
    ) -> Result<Self, InputErrors> {
        let problems = Problems::default();
        let lengths = study.axes.iter().map(|axis| axis.values.len());
        let runs = lengths.fold(study.replicate_count(), usize::saturating_mul);
        if runs > MOST_RUNS {
            let message = format!("the axes give {runs} runs; at most {MOST_RUNS} are allowed");
            problems.add_at(SourcePlace::File, message);
            return result(problems, &study.file, None);
        }
        let points = points(study);
        check_seeds(study, &points, factory, checker, &problems);
        let tasks = tasks(study, &points, factory);
        let tasks = tasks.map_err(|problem| problems.add(problem.place(&study.all_settings())));
        let plan = tasks.ok().map(|tasks| Self { points, tasks });
        if let Some(plan) = &plan {
            plan.refuse_duplicates(study, &problems);
        }
        result(problems, &study.file, plan)
    }

    /// Refuses two runs that are the same but for their names.
    fn refuse_duplicates(&self, study: &Study, problems: &Problems) {
        let mut seen: HashMap<&str, &Member> = HashMap::new();
        for member in self.tasks.iter().flat_map(Task::planned) {
            if let Some(first) = seen.insert(&member.identity, member) {
                let (one, two) = (&first.name, &member.name);
                let message = format!("the runs {one} and {two} are the same run");
                let line = study.axes.first().or(study.replicates.as_ref()).map(|axis| axis.line);
                problems.add(error_at(line.unwrap_or(0), "", message));
            }
        }
    }
}

/// Refuses seeds where no random numbers are drawn.
fn check_seeds(
    study: &Study,
    points: &[Point],
    factory: &MemberFactory<'_>,
    checker: &dyn CaseChecker,
    problems: &Problems,
) {
    // The ends of another study differ from seed to seed.
    let Some(axis) = study.replicates.as_ref().filter(|_| study.start.is_none()) else { return };
    let (Some(point), [SEED], true) = (
        points.first(),
        axis.keys.iter().map(String::as_str).collect::<Vec<_>>().as_slice(),
        axis.values.len() > 1,
    ) else {
        return;
    };
    let request = factory.request(&point.settings, None, None);
    let case = checker.effective(&request.case, &request.settings);
    if case.is_ok_and(|case| case.start_kind() == Some("run")) {
        let message = "the seed changes nothing: a bed that begins with the end of another run draws no random \
                       numbers. Let the start vary: an [[axis]] with replicate = true and keys = \
                       [\"particles.seed\", \"particles.start.path\"]";
        problems.add(error_at(axis.line, SEED, message.to_owned()));
    }
}

fn tasks(
    study: &Study,
    points: &[Point],
    factory: &MemberFactory<'_>,
) -> Result<Vec<Task>, CaseProblem> {
    let mut tasks = Vec::new();
    let along = study.continuation.as_ref().map(|continuation| continuation.axis);
    for (index, point) in points.iter().enumerate() {
        // A chain is one task, that of its first point.
        if along.is_some_and(|axis| point.positions[axis] > 0) {
            continue;
        }
        for replicate in 0..study.replicate_count() {
            let kind = match (&study.bisection, along) {
                (Some(search), _) => TaskKind::Search {
                    settings: with_replicate(study, point, replicate),
                    bracket: search.brackets.at(&point.positions),
                },
                (None, Some(axis)) => {
                    TaskKind::Runs(chain(study, points, index, axis, replicate, factory)?)
                }
                (None, None) => {
                    let settings = with_replicate(study, point, replicate);
                    let member = factory.member(index, replicate, settings, None)?;
                    TaskKind::Runs(vec![Arc::new(member)])
                }
            };
            let name = match &kind {
                TaskKind::Runs(members) => members.first().map(|member| member.name.clone()),
                TaskKind::Search { settings, .. } => Some(factory.search_name(settings)),
            };
            let name = name.unwrap_or_default();
            tasks.push(Task { name, point: index, replicate, kind });
        }
    }
    Ok(tasks)
}

fn with_replicate(study: &Study, point: &Point, replicate: usize) -> Vec<Setting> {
    let of_replicate = study.replicates.iter().flat_map(|axis| axis.settings(replicate));
    point.settings.iter().cloned().chain(of_replicate).collect()
}

/// The runs along an axis, each of which begins with the end of the one before.
fn chain(
    study: &Study,
    points: &[Point],
    first: usize,
    axis: usize,
    replicate: usize,
    factory: &MemberFactory<'_>,
) -> Result<Vec<Arc<Member>>, CaseProblem> {
    let mut members: Vec<Arc<Member>> = Vec::new();
    let same_elsewhere = |point: &Point| {
        let pairs = point.positions.iter().zip(&points[first].positions).enumerate();
        pairs.into_iter().all(|(number, (one, other))| number == axis || one == other)
    };
    for (index, point) in points.iter().enumerate().filter(|(_, point)| same_elsewhere(point)) {
        let settings = with_replicate(study, point, replicate);
        let member = factory.member(index, replicate, settings, members.last().cloned())?;
        members.push(Arc::new(member));
    }
    Ok(members)
}

#[cfg(test)]
mod tests {
    use super::combinations;

    #[test]
    fn the_last_axis_varies_fastest() {
        let expected: [[usize; 2]; 6] = [[0, 0], [0, 1], [0, 2], [1, 0], [1, 1], [1, 2]];
        assert_eq!(combinations(&[2, 3]), expected);
        assert_eq!(combinations(&[]), [Vec::<usize>::new()]);
        assert!(combinations(&[2, 0]).is_empty());
    }
}
