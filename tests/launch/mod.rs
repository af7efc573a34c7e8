//! Starts the program as users do: alone, or under `mpirun`. Output goes to files, no process waits without end, and
//! one `mpirun` runs at a time.

#![allow(dead_code, reason = "each test program uses a part of this module")]
#![allow(clippy::unwrap_used, reason = "in tests a panic is the report")]

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// What `.cargo/config.toml` sets, for test programs that are started by hand, and how ranks wait.
const ENVIRONMENT: [(&str, &str); 5] = [
    ("OMPI_ALLOW_RUN_AS_ROOT", "1"),
    ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"),
    ("OMPI_MCA_rmaps_base_oversubscribe", "1"),
    ("OMPI_MCA_btl_vader_single_copy_mechanism", "none"),
    // Ranks that wait leave their core to others: there may be more ranks than cores.
    ("OMPI_MCA_mpi_yield_when_idle", "1"),
];
/// The longest that one start may take: 30 times what the longest takes on two idle cores.
const PATIENCE: Duration = Duration::from_secs(300);
/// Between looks at what is waited for.
const PAUSE: Duration = Duration::from_millis(5);

static ONE_MPIRUN: Mutex<()> = Mutex::new(());

/// How the program ended.
#[derive(Debug)]
pub(crate) struct Ended {
    pub(crate) status: ExitStatus,
    pub(crate) output: String,
    pub(crate) errors: String,
}

impl Ended {
    /// The exit code; none if a signal ended it.
    pub(crate) fn code(&self) -> Option<i32> {
        self.status.code()
    }

    /// The last line of standard output, which must be a digest; fails if the program did.
    pub(crate) fn digest(&self) -> String {
        assert_eq!(self.code(), Some(0), "{}\n{}", self.output, self.errors);
        let last = self.output.lines().last().unwrap_or_default();
        let hex = last.strip_prefix("digest ").unwrap_or_else(|| panic!("no digest: {last}"));
        let is_hex = hex.len() == 32 && hex.chars().all(|message| message.is_ascii_hexdigit());
        assert!(is_hex, "{last}");
        hex.to_owned()
    }

    /// The words of the one error.
    pub(crate) fn error(&self) -> &str {
        let messages = self.errors.lines().filter(|line| line.starts_with("error:")).count();
        assert_eq!(messages, 1, "{}\n{}", self.output, self.errors);
        let begin = self.errors.find("error:").unwrap();
        &self.errors[begin..]
    }
}

/// A program that runs; it is ended if nobody waits for it.
pub(crate) struct Running {
    child: Child,
    ranks: usize,
    folder: tempfile::TempDir,
    _turn: Option<MutexGuard<'static, ()>>,
}

/// The path of a file of the repository.
pub(crate) fn in_repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// The path of a smoke case.
pub(crate) fn smoke(name: &str) -> String {
    in_repository(&format!("cases/smoke/{name}.toml")).display().to_string()
}

/// Waits for the turn to start `mpirun`; for programs that do so by themselves.
pub(crate) fn turn_of_mpirun() -> MutexGuard<'static, ()> {
    ONE_MPIRUN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Starts the program: by itself for no ranks, else under `mpirun`.
pub(crate) fn start(ranks: usize, arguments: &[&str]) -> Running {
    start_with(&[], ranks, arguments)
}

/// The same, with variables that are set for the program alone.
pub(crate) fn start_with(
    environment: &[(&str, String)],
    ranks: usize,
    arguments: &[&str],
) -> Running {
    let program = Path::new(env!("CARGO_BIN_EXE_talcum"));
    if environment.is_empty() {
        return start_program(program, ranks, arguments);
    }
    let settings = environment.iter().map(|(name, value)| format!("{name}={value}"));
    let through: Vec<String> = settings.chain([program.display().to_string()]).collect();
    let all: Vec<&str> =
        through.iter().map(String::as_str).chain(arguments.iter().copied()).collect();
    start_program(Path::new("/usr/bin/env"), ranks, &all)
}

/// Starts a program: by itself for no ranks, else under `mpirun`.
pub(crate) fn start_program(program: &Path, ranks: usize, arguments: &[&str]) -> Running {
    let turn = (ranks > 0).then(turn_of_mpirun);
    let mut command = Command::new(if ranks > 0 { Path::new("mpirun") } else { program });
    if ranks > 0 {
        command.args(["-n", &ranks.to_string()]).arg(program);
    }
    let folder = tempfile::tempdir().unwrap();
    let file = |name| File::create(folder.path().join(name)).unwrap();
    command.args(arguments).envs(ENVIRONMENT).env_remove("RUST_LOG").stdin(Stdio::null());
    command.stdout(file("output")).stderr(file("errors"));
    let child = command.spawn().expect("mpirun is in the path");
    Running { child, ranks, folder, _turn: turn }
}

/// Starts the program and waits for its end.
pub(crate) fn talcum(ranks: usize, arguments: &[&str]) -> Ended {
    start(ranks, arguments).wait()
}

/// Runs a case into an output folder.
pub(crate) fn run_case(ranks: usize, [case, output]: [&str; 2], more: &[&str]) -> Ended {
    talcum(ranks, &[&["run", case, "--output", output], more].concat())
}

/// Runs of one case, each on so many ranks into its own folder in `folder`, with more options.
pub(crate) fn runs_of(case: &str, folder: &Path) -> impl Fn(usize, &str, &[&str]) -> Ended + use<> {
    let (case, folder) = (case.to_owned(), folder.to_owned());
    move |ranks, name, more| {
        run_case(ranks, [&case, &folder.join(name).display().to_string()], more)
    }
}

impl Running {
    /// Waits for the end.
    pub(crate) fn wait(mut self) -> Ended {
        let begin = Instant::now();
        let status = loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                break status;
            }
            let message = || format!("no end within {PATIENCE:?}: {}", self.errors());
            assert!(begin.elapsed() < PATIENCE, "{}", message());
            std::thread::sleep(PAUSE);
        };
        Ended { status, output: self.read("output"), errors: self.errors() }
    }

    /// Waits until something is so; fails if the program ends before.
    pub(crate) fn wait_until(&mut self, mut is_so: impl FnMut() -> bool) {
        let begin = Instant::now();
        while !is_so() {
            let ended = self.child.try_wait().unwrap();
            assert!(ended.is_none(), "{ended:?}\n{}\n{}", self.read("output"), self.errors());
            assert!(begin.elapsed() < PATIENCE, "not so within {PATIENCE:?}");
            std::thread::sleep(PAUSE);
        }
    }

    /// Whether the program has ended.
    pub(crate) fn has_ended(&mut self) -> bool {
        self.child.try_wait().unwrap().is_some()
    }

    /// The first line of standard output, as soon as it is there; fails if the program ends before.
    pub(crate) fn first_line(&mut self) -> String {
        let output = self.folder.path().join("output");
        let line = || {
            let text = std::fs::read_to_string(&output).unwrap_or_default();
            text.split_once('\n').map(|(line, _)| line.to_owned())
        };
        self.wait_until(|| line().is_some());
        line().unwrap()
    }

    /// Process numbers of the ranks.
    pub(crate) fn rank_processes(&self) -> Vec<u32> {
        if self.ranks == 0 { vec![self.child.id()] } else { children_of(self.child.id()) }
    }

    /// The number of the process that was started: the program, or `mpirun`.
    pub(crate) fn process(&self) -> u32 {
        self.child.id()
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.folder.path().join(name)).unwrap_or_default()
    }

    fn errors(&self) -> String {
        self.read("errors")
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        if matches!(self.child.try_wait(), Ok(None)) {
            for process in self.rank_processes() {
                signal("KILL", process);
            }
            let _ = self.child.kill();
            let _ = self.child.wait();
        }
    }
}

/// Sends a signal to a process; that it has ended meanwhile is no error.
pub(crate) fn signal(name: &str, process: u32) {
    // The shell's own: a minimal system has no program of this name.
    let mut command = Command::new("sh");
    command.args(["-c", &format!("kill -{name} {process}")]).stderr(Stdio::null());
    command.status().unwrap();
}

/// Whether a process exists and has not ended.
fn is_alive(process: u32) -> bool {
    state_and_parent(process).is_some_and(|(state, _)| state != 'Z')
}

/// Waits until processes have ended; fails if they stay. `mpirun` ends shortly before the ranks that it kills.
pub(crate) fn wait_for_end_of(processes: &[u32]) {
    let begin = Instant::now();
    while processes.iter().any(|&process| is_alive(process)) {
        assert!(begin.elapsed() < Duration::from_secs(20), "mpirun leaves ranks behind");
        std::thread::sleep(PAUSE);
    }
}

fn children_of(parent: u32) -> Vec<u32> {
    let entries = std::fs::read_dir("/proc").unwrap().flatten();
    let numbers = entries.filter_map(|entry| entry.file_name().to_str()?.parse().ok());
    numbers
        .filter(|&process| state_and_parent(process).is_some_and(|(_, found)| found == parent))
        .collect()
}

/// Fields 3 and 4 of `/proc/N/stat`, which follow the name in brackets.
fn state_and_parent(process: u32) -> Option<(char, u32)> {
    let text = std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    let mut fields = text.rsplit_once(')')?.1.split_whitespace();
    Some((fields.next()?.chars().next()?, fields.next()?.parse().ok()?))
}

/// The rows of `series.csv` in a folder of results, with the header, without comments.
pub(crate) fn series(folder: &Path) -> String {
    let text = std::fs::read_to_string(folder.join("series.csv")).unwrap();
    text.split_inclusive('\n').filter(|line| !line.starts_with('#')).collect()
}

/// The checkpoints of a folder, oldest first.
pub(crate) fn checkpoints(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut found: Vec<PathBuf> = entries
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "h5"))
        .filter(|path| path.file_name().unwrap().to_string_lossy().starts_with("checkpoint-"))
        .collect();
    found.sort();
    found
}
