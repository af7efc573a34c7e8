//! Starts the runs of a study, a limited number at a time, until nothing is left or a stop is requested.

use crate::study::bisection::Bisection;
use crate::study::folder::{Results, StudyFolder, newest_checkpoint};
use crate::study::job::{Exit, Job, Runner, Running};
use crate::study::member::{Member, MemberFactory};
use crate::study::session::count_of;
use crate::study::start::StartState;
use crate::study::task::{Progress, RunState, Task};
use std::sync::Arc;
use std::time::Duration;

/// Urgency of a requested stop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum StopRequest {
    /// No stop is requested.
    #[default]
    None,
    /// Runs are to write a checkpoint and end.
    Gentle,
    /// Runs are to end at once.
    AtOnce,
}

/// Outcome of the work on a study.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Outcome {
    /// Whether it was stopped before its end.
    pub(crate) stopped: bool,
    /// Failures and their reasons, one text for each task.
    pub(crate) failures: Vec<String>,
}

/// The default time between polls of the runs.
pub(crate) const PAUSE: Duration = Duration::from_millis(50);
/// Factor for the time between polls of runs that another process holds.
const LONG: u32 = 20;

/// Data for the work on a study.
pub(crate) struct Scheduler<'a> {
    /// Makes its members.
    pub(crate) factory: &'a MemberFactory<'a>,
    /// Its search, if it has one.
    pub(crate) search: Option<&'a Bisection>,
    /// Data on its runs.
    pub(crate) results: Results<'a>,
    /// Starts runs.
    pub(crate) runner: &'a dyn Runner,
    /// Number of runs that work at the same time.
    pub(crate) at_a_time: usize,
    /// Returns the present request to stop.
    pub(crate) stop: &'a dyn Fn() -> StopRequest,
    /// Time between polls of the runs.
    pub(crate) pause: Duration,
}

/// A run in progress.
struct ActiveRun {
    member: Arc<Member>,
    running: Box<dyn Running>,
    /// The newest checkpoint when it was started.
    checkpoint: Option<String>,
}

/// The present state of the work.
struct Work<'t> {
    open: Vec<&'t Task>,
    active: Vec<ActiveRun>,
    outcome: Outcome,
    asked: StopRequest,
}

impl Scheduler<'_> {
    /// Works on tasks until nothing is left.
    ///
    /// # Errors
    /// If a run cannot be started or its state cannot be written.
    pub(crate) fn run(&self, tasks: &[Task]) -> Result<Outcome, String> {
        let open = tasks.iter().collect();
        let (active, outcome) = (Vec::new(), Outcome::default());
        let mut work = Work { open, active, outcome, asked: StopRequest::None };
        let result = self.work(&mut work);
        if result.is_err() {
            self.stop_all(&mut work);
        }
        result.map(|()| work.outcome)
    }

    fn work(&self, work: &mut Work<'_>) -> Result<(), String> {
        let mut look = true;
        loop {
            self.pass_on_stop(work);
            look |= self.collect(work)?;
            let stopping = work.asked > StopRequest::None;
            if stopping && work.active.is_empty() {
                work.outcome.stopped = self.is_anything_left(&work.open)?;
                return Ok(());
            }
            let mut held_elsewhere = false;
            if look && !stopping {
                held_elsewhere = self.start_what_can_run(work)?;
                if work.open.is_empty() && work.active.is_empty() {
                    return Ok(());
                }
            }
            let elsewhere_only = held_elsewhere && work.active.is_empty();
            std::thread::sleep(if elsewhere_only { LONG * self.pause } else { self.pause });
            look = held_elsewhere;
        }
    }

    /// Whether a task could be resumed.
    fn is_anything_left(&self, tasks: &[&Task]) -> Result<bool, String> {
        for task in tasks {
            let progress = task.progress(self.search, self.factory, &self.results)?;
            if matches!(progress, Progress::Run(_)) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Forwards a request to stop to all runs.
    fn pass_on_stop(&self, work: &mut Work<'_>) {
        let request = (self.stop)();
        if request <= work.asked {
            return;
        }
        work.asked = request;
        if !work.active.is_empty() {
            log::info!("stopping {} after a checkpoint", count_of(work.active.len(), "run"));
        }
        for active in &mut work.active {
            match request {
                StopRequest::AtOnce => active.running.kill(),
                _ => active.running.ask_to_stop(),
            }
        }
    }

    /// Checks which runs have ended; returns whether any has.
    fn collect(&self, work: &mut Work<'_>) -> Result<bool, String> {
        let mut ended = Vec::new();
        work.active.retain_mut(|active| match active.running.poll() {
            Some(exit) => {
                ended.push((Arc::clone(&active.member), active.checkpoint.clone(), exit));
                false
            }
            None => true,
        });
        let any = !ended.is_empty();
        for (member, checkpoint, exit) in ended {
            self.settle(&member, checkpoint, exit, work.asked > StopRequest::None)?;
        }
        Ok(any)
    }

    /// Reports how a run ended, and records a failure in its folder.
    fn settle(
        &self,
        member: &Member,
        before: Option<String>,
        exit: Exit,
        stopping: bool,
    ) -> Result<(), String> {
        let folder = self.folder();
        let name = folder.name_of(member);
        if let RunState::Done(digest) = folder.state(member) {
            log::info!("{name}: complete, digest {digest}");
            return Ok(());
        }
        if stopping {
            log::info!("{name}: stopped, can be resumed");
            return Ok(());
        }
        let has_advanced = newest_checkpoint(&folder.run(member)) > before;
        if exit.success && has_advanced {
            return Ok(()); // it ended itself with a checkpoint, and is started again
        }
        let reason = if exit.success {
            "ended without a newer checkpoint".to_owned()
        } else {
            exit.description
        };
        log::error!("{name}: {reason}");
        folder.note_failure(member, &reason)
    }

    /// Starts runs while there is room; returns whether some that could run are held by another process.
    fn start_what_can_run(&self, work: &mut Work<'_>) -> Result<bool, String> {
        let mut held_elsewhere = false;
        let mut still_open = Vec::new();
        for task in std::mem::take(&mut work.open) {
            match task.progress(self.search, self.factory, &self.results)? {
                Progress::Finished => {}
                Progress::Failed(reason) => {
                    log::error!("{}: {reason}", task.name);
                    work.outcome.failures.push(format!("{}: {reason}", task.name));
                }
                Progress::Run(members) => {
                    for member in members {
                        held_elsewhere |= self.start(member, &mut work.active)?;
                    }
                    still_open.push(task);
                }
            }
        }
        work.open = still_open;
        Ok(held_elsewhere)
    }

    /// Starts a run if there is room; returns whether another process holds it.
    fn start(&self, member: Arc<Member>, active: &mut Vec<ActiveRun>) -> Result<bool, String> {
        let is_active = active.iter().any(|run| run.member.identity == member.identity);
        if is_active || active.len() >= self.at_a_time {
            return Ok(false);
        }
        let folder = self.folder();
        let Some(lock) = folder.lock_run(&member)? else { return Ok(true) };
        // It may have ended elsewhere before the lock was taken.
        if let RunState::Done(_) | RunState::Failed(_) = folder.state(&member) {
            return Ok(true);
        }
        let before = member.predecessor.as_deref();
        let start = match (before, &member.start) {
            (Some(before), _) => Some(folder.last_checkpoint(before).ok_or_else(|| {
                format!("{}: it has no checkpoint to continue from", before.name)
            })?),
            (None, Some(start)) => Some(start.checkpoint()?),
            (None, None) => None,
        };
        let mut request = self.factory.request(&member.settings, before, start.as_deref());
        request.settings.extend(self.factory.title(&member, self.origin(&member)));
        let (run, name) = (folder.run(&member), folder.name_of(&member));
        let checkpoint = newest_checkpoint(&run);
        let verb = if checkpoint.is_some() { "going on" } else { "beginning" };
        log::info!("{name}: {verb}");
        let running = self.runner.start(Job { request, folder: run, lock })?;
        active.push(ActiveRun { member, running, checkpoint });
        Ok(false)
    }

    /// The run with which another begins, and its digest.
    fn origin(&self, member: &Member) -> Option<String> {
        let Some(before) = member.predecessor.as_deref() else {
            return member.start.as_deref().map(StartState::describe);
        };
        let (name, state) = (self.folder().name_of(before), self.folder().state(before));
        match state {
            RunState::Done(digest) => {
                Some(format!("begins with the end of {name}, digest {digest}"))
            }
            _ => None,
        }
    }

    /// After an error: asks all runs to stop, and waits for them.
    fn stop_all(&self, work: &mut Work<'_>) {
        for active in &mut work.active {
            active.running.ask_to_stop();
        }
        while work.active.iter_mut().any(|active| active.running.poll().is_none()) {
            if (self.stop)() == StopRequest::AtOnce {
                work.active.iter_mut().for_each(|active| active.running.kill());
            }
            std::thread::sleep(self.pause);
        }
    }

    fn folder(&self) -> &StudyFolder {
        self.results.folder
    }
}
