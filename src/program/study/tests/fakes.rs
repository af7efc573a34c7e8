//! Runs without a program: their results are computed from their cases.

use crate::study::checker::{CaseChecker, CaseRequest};
use crate::study::definition::Study;
use crate::study::folder::StudyFolder;
use crate::study::job::{Exit, Job, Runner, Running};
use crate::study::known::KnownRuns;
use crate::study::problem::CaseProblem;
use crate::study::run_outline::RunOutline;
use crate::study::scheduler::{Outcome, Scheduler, StopRequest};
use crate::study::session::Session;
use crate::study::starting_states::starting_states;
use crate::study::table::{collect, csv};
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::time::Duration;
use talcum_runs::input::InputErrors;

pub(super) const CASE: &str = "title = \"bed\"\n[particles]\ncount = 10\nseed = 1\n[particles.start]\nkind = \"lattice\"\n[cohesion]\nbond_number = 1.0\n[gas]\nsuperficial_velocity = 0.1\n[time]\nend = 4.0\n";

/// Rejects negative numbers, and keys that the case does not have.
pub(super) struct FakeChecker;

impl CaseChecker for FakeChecker {
    fn check(&self, request: &CaseRequest) -> Result<RunOutline, Vec<CaseProblem>> {
        let plain = self.effective(&request.case, &[]).unwrap().flat();
        let settings = request.settings.iter();
        let problems = settings.filter_map(|setting| {
            let reason = match setting.value.number() {
                _ if !plain.contains_key(&setting.key) => "unknown key",
                Some(number) if number < 0.0 => "must be at least 0",
                _ => return None,
            };
            let message = format!("{} = {}: {reason}", setting.key, setting.value);
            Some(CaseProblem { setting: Some(setting.argument()), message })
        });
        let problems: Vec<CaseProblem> = problems.collect();
        if !problems.is_empty() {
            return Err(problems);
        }
        let end_time = self.effective(&request.case, &request.settings).unwrap().end_time();
        let scalars = ["contacts", "mean_age"].map(str::to_owned).to_vec();
        let instruments = [("network".to_owned(), scalars)].into();
        let impossible = [("bubbles", "there is no gas.vtkhdf".to_owned())].into();
        Ok(RunOutline { end_time: end_time.unwrap(), instruments, impossible })
    }
}

/// Result of a simulated run: a number, or an error.
pub(super) type Physics = fn(&BTreeMap<String, String>) -> Result<f64, String>;

/// Simulates runs; each lasts some polls and can be stopped.
pub(super) struct FakeRunner {
    pub(super) physics: Physics,
    pub(super) polls: usize,
    /// Folders of runs in the order in which they were started; runs restarted after a stop occur again.
    pub(super) started: RefCell<Vec<String>>,
    pub(super) most_active: Cell<usize>,
    active: Rc<Cell<usize>>,
}

impl FakeRunner {
    pub(super) fn new(physics: Physics) -> Self {
        Self {
            physics,
            polls: 2,
            started: RefCell::default(),
            most_active: Cell::new(0),
            active: Rc::default(),
        }
    }
}

struct FakeRun {
    folder: PathBuf,
    result: Result<f64, String>,
    polls_left: usize,
    stopped: bool,
    active: Rc<Cell<usize>>,
    _lock: File,
}

impl Runner for FakeRunner {
    fn start(&self, job: Job) -> Result<Box<dyn Running>, String> {
        let case = FakeChecker.effective(&job.request.case, &job.request.settings)?;
        std::fs::write(job.folder.join("case.toml"), case.text()).unwrap();
        let name = job.folder.file_name().unwrap().to_string_lossy().into_owned();
        self.started.borrow_mut().push(name);
        self.active.set(self.active.get() + 1);
        self.most_active.set(self.most_active.get().max(self.active.get()));
        Ok(Box::new(FakeRun {
            result: (self.physics)(&case.flat()),
            folder: job.folder,
            polls_left: self.polls,
            stopped: false,
            active: Rc::clone(&self.active),
            _lock: job.lock,
        }))
    }
}

impl FakeRun {
    fn finish(&self) -> Exit {
        std::fs::write(self.folder.join("checkpoint-000000000001.h5"), "").unwrap();
        if self.stopped {
            return Exit { success: true, description: String::new() };
        }
        match &self.result {
            Ok(value) => {
                let rows = format!("time [s],bed_top [d]\n0,0\n4,{value}\n");
                let text = format!("# talcum_version: 9\n# commit: abc\n{rows}");
                std::fs::write(self.folder.join("series.csv"), text).unwrap();
                let digest = "0123".repeat(8);
                std::fs::write(self.folder.join("complete"), format!("digest {digest}\n")).unwrap();
                Exit { success: true, description: String::new() }
            }
            Err(reason) => Exit { success: false, description: reason.clone() },
        }
    }
}

impl Running for FakeRun {
    fn poll(&mut self) -> Option<Exit> {
        if self.polls_left > 0 && !self.stopped {
            self.polls_left -= 1;
            return None;
        }
        self.active.set(self.active.get() - 1);
        Some(self.finish())
    }

    fn ask_to_stop(&mut self) {
        self.stopped = true;
    }

    fn kill(&mut self) {
        self.stopped = true;
    }
}

/// A folder that contains a case and a study.
pub(super) struct Desk {
    pub(super) folder: tempfile::TempDir,
    /// A table in it with runs that need not be made.
    pub(super) known: Option<String>,
}

impl Desk {
    pub(super) fn new(study: &str) -> Self {
        let desk = Self { folder: tempfile::tempdir().unwrap(), known: None };
        std::fs::write(desk.path("bed.toml"), CASE).unwrap();
        desk.write(study);
        desk
    }

    pub(super) fn write(&self, study: &str) {
        let head = "title = \"t\"\ncase = \"bed.toml\"\n";
        let measure = "\n[measure.top]\ncolumn = \"bed_top\"\nstatistic = \"last\"\n";
        std::fs::write(self.path("study.toml"), format!("{head}{study}{measure}")).unwrap();
    }

    pub(super) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(super) fn read(&self) -> Result<Study, InputErrors> {
        crate::study::file::read(&self.path("study.toml"))
    }

    /// The errors of the study, with its cases checked.
    pub(super) fn refusal(&self) -> String {
        let study = match self.read() {
            Ok(study) => study,
            Err(refusal) => return short(&refusal, self.folder.path()),
        };
        let folder = StudyFolder::at(&self.path("out"));
        let refused = starting_states(&study, &FakeChecker).and_then(|starts| {
            let session = Session::new(&study, &folder, starts, &FakeChecker)?;
            session.check(&session.plan.tasks)
        });
        refused.map_or_else(|refusal| short(&refusal, self.folder.path()), |()| String::new())
    }

    /// Works on the study; a gentle stop is requested at the given poll.
    pub(super) fn work(&self, runner: &FakeRunner, stop_at: Option<usize>) -> Outcome {
        self.with_session(|session| {
            session.check(&session.plan.tasks).unwrap();
            let looks = Cell::new(0);
            let stop = || {
                looks.set(looks.get() + 1);
                match stop_at {
                    Some(at) if looks.get() >= at => StopRequest::Gentle,
                    _ => StopRequest::None,
                }
            };
            run_to_the_end(session, runner, &stop)
        })
    }

    /// Works on another study of the desk to its end.
    pub(super) fn work_on(&self, study: &str, output: &str, runner: &FakeRunner) {
        let study = crate::study::file::read(&self.path(study)).unwrap();
        let folder = StudyFolder::at(&self.path(output));
        let session = Session::new(&study, &folder, Vec::new(), &FakeChecker).unwrap();
        run_to_the_end(&session, runner, &|| StopRequest::None);
    }

    /// All tables, one after another.
    pub(super) fn tables(&self) -> String {
        self.with_session(|session| {
            let collected = collect(session).unwrap();
            assert_eq!(collected.failures, Vec::<String>::new());
            collected.tables.iter().map(csv::text).collect()
        })
    }

    pub(super) fn with_session<T>(&self, function: impl FnOnce(&Session<'_>) -> T) -> T {
        let study = self.read().unwrap();
        let tables: Vec<PathBuf> = self.known.iter().map(|name| self.path(name)).collect();
        let known = KnownRuns::read(&tables, &study.quantities).unwrap();
        let folder = StudyFolder::at(&self.path("out")).with_known(known);
        let starts = starting_states(&study, &FakeChecker).unwrap();
        let session = Session::new(&study, &folder, starts, &FakeChecker).unwrap();
        function(&session)
    }
}

fn short(refusal: &InputErrors, folder: &Path) -> String {
    refusal.to_string().replace(&format!("{}/", folder.display()), "")
}

/// A number of a case.
pub(super) fn number(keys: &BTreeMap<String, String>, key: &str) -> f64 {
    keys[key].parse().unwrap()
}

/// Runs all tasks until nothing is left or a stop is requested.
fn run_to_the_end(
    session: &Session<'_>,
    runner: &FakeRunner,
    stop: &dyn Fn() -> StopRequest,
) -> Outcome {
    let scheduler = Scheduler {
        factory: &session.factory,
        search: session.study.bisection.as_ref(),
        results: session.results(),
        runner,
        at_a_time: usize::try_from(session.study.resources.at_a_time).unwrap(),
        stop,
        pause: Duration::from_micros(100),
    };
    scheduler.run(&session.plan.tasks).unwrap()
}
