//! Disks that fail or are full, and two runs in one folder: no data are lost, and no process hangs.

mod damage;
mod names;

use crate::launch::{Ended, checkpoints, series, smoke, start, start_with, talcum};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// A library that makes calls of the system fail, built once from failing_calls.c.
fn failing_calls() -> &'static Path {
    static LIBRARY: OnceLock<(tempfile::TempDir, PathBuf)> = OnceLock::new();
    let (_, path) = LIBRARY.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("failing_calls.so");
        let source = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/program/faults/failing_calls.c");
        let mut compiler = Command::new("cc");
        compiler.args(["-O1", "-shared", "-fPIC", "-o"]).arg(&path).arg(source).arg("-ldl");
        assert!(compiler.status().unwrap().success());
        (folder, path)
    });
    path
}

/// A run in which calls of one rank fail.
pub(crate) struct Fault<'a> {
    pub(crate) call: &'a str,
    pub(crate) file: &'a str,
    pub(crate) from: usize,
    /// `None`: all calls from that one on.
    pub(crate) count: Option<usize>,
    pub(crate) rank: usize,
}

impl Fault<'_> {
    fn run(&self, ranks: usize, arguments: &[&str]) -> Ended {
        start_with(&self.environment(), ranks, arguments).wait()
    }

    /// The process that makes such a call is killed in it.
    pub(crate) fn kill(&self, arguments: &[&str]) -> Ended {
        let mut environment = self.environment();
        environment.push(("FAULT_ERROR", "0".to_owned()));
        start_with(&environment, 0, arguments).wait()
    }

    fn environment(&self) -> Vec<(&'static str, String)> {
        let mut environment = vec![
            ("LD_PRELOAD", failing_calls().display().to_string()),
            ("FAULT_CALL", self.call.to_owned()),
            ("FAULT_PATH", self.file.to_owned()),
            ("FAULT_FROM", self.from.to_string()),
            ("FAULT_RANK", self.rank.to_string()),
        ];
        environment.extend(self.count.map(|count| ("FAULT_COUNT", count.to_string())));
        environment
    }
}

/// Every kind of output, often.
const OFTEN: [&str; 10] = [
    "--until",
    "0.1",
    "--set",
    "output.series=0.005",
    "--set",
    "output.profiles=0.01",
    "--set",
    "output.particles=0.02",
    "--set",
    "checkpoint.every_steps=80",
];

fn run_in(folder: &Path, more: &[&str]) -> Vec<String> {
    let start = ["run".to_owned(), smoke("walls"), "--output".to_owned()];
    let rest = OFTEN.iter().chain(more).map(|&argument| argument.to_owned());
    start.into_iter().chain([folder.display().to_string()]).chain(rest).collect()
}

fn arguments(owned: &[String]) -> Vec<&str> {
    owned.iter().map(String::as_str).collect()
}

#[test]
fn a_write_that_fails_on_one_rank_ends_all_ranks_and_the_run_resumes_where_it_was() {
    let whole = tempfile::tempdir().unwrap();
    let expected = talcum(0, &arguments(&run_in(whole.path(), &[]))).digest();
    let files = ["particles.vtkhdf", "profiles.h5", "series.csv", ".h5.partial"];
    for (number, file) in files.into_iter().enumerate() {
        // Only rank 0 writes the series and the profiles.
        let rank = if number % 3 == 0 { 1 } else { 0 };
        let folder = tempfile::tempdir().unwrap();
        let fault = Fault { call: "write", file, from: 3, count: None, rank };
        let ended = fault.run(2, &arguments(&run_in(folder.path(), &[])));
        let message = ended.errors.clone();
        assert_eq!(ended.code(), Some(1), "{file}: {message}");
        assert!(ended.error().contains(file), "{file}: {message}");
        assert!(ended.error().contains("No space left on device"), "{file}: {message}");
        let resumed = talcum(2, &arguments(&run_in(folder.path(), &["--resume"])));
        assert_eq!(resumed.digest(), expected, "{file}");
        assert_eq!(series(folder.path()), series(whole.path()), "{file}");
    }
}

#[test]
fn no_single_write_that_fails_goes_unnoticed() {
    // Small datasets would wait in buffers of HDF5, and be written as they are closed. One checkpoint, with a ledger.
    let short = ["--until", "0.01", "--set", "output.energy=0.01"];
    let mut written = 0;
    loop {
        let folder = tempfile::tempdir().unwrap();
        let output = folder.path().display().to_string();
        let case = smoke("walls");
        let mut command = vec!["run", &case, "--output", &output];
        command.extend(short);
        let from = written + 1;
        let fault = Fault { call: "write", file: ".h5.partial", from, count: Some(1), rank: 0 };
        let ended = fault.run(0, &command);
        if ended.code() == Some(0) {
            break;
        }
        assert_eq!(ended.code(), Some(1), "write {from}: {}", ended.errors);
        assert!(ended.error().contains("No space left on device"), "{from}: {}", ended.errors);
        written += 1;
    }
    // The control: all writes of the checkpoint were met, not the first few.
    assert!(written > 10, "{written}");
}

#[test]
fn a_read_that_fails_is_an_error_and_the_same_command_resumes_later() {
    let whole = tempfile::tempdir().unwrap();
    let expected = talcum(0, &arguments(&run_in(whole.path(), &[]))).digest();
    for file in ["checkpoint-", "series.csv", "profiles.h5", "particles.vtkhdf"] {
        let folder = tempfile::tempdir().unwrap();
        let half = ["--until", "0.05"];
        let first: Vec<String> = run_in(folder.path(), &[])
            .into_iter()
            .map(|argument| if argument == "0.1" { half[1].to_owned() } else { argument })
            .collect();
        talcum(0, &arguments(&first)).digest();
        let before = checkpoints(folder.path());
        let resume = run_in(folder.path(), &["--resume"]);
        let fault = Fault { call: "read", file, from: 1, count: None, rank: 0 };
        let ended = fault.run(2, &arguments(&resume));
        assert_eq!(ended.code(), Some(1), "{file}: {}", ended.errors);
        assert!(ended.error().contains(file), "{file}: {}", ended.errors);
        assert_eq!(checkpoints(folder.path()), before, "{file}");
        let aside = fs::read_dir(folder.path()).unwrap().flatten();
        let aside =
            aside.filter(|entry| entry.file_name().to_string_lossy().contains("unreadable"));
        assert_eq!(aside.count(), 0, "{file}");
        assert_eq!(talcum(2, &arguments(&resume)).digest(), expected, "{file}");
        assert_eq!(series(folder.path()), series(whole.path()), "{file}");
    }
}

#[test]
fn a_second_run_in_a_folder_is_refused_and_a_dead_one_does_not_block() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().display().to_string();
    let case = smoke("walls");
    let endless = ["run", &case, "--output", &output, "--until", "1e6"];
    let mut first = start(0, &endless);
    first.wait_until(|| fs::read_to_string(folder.path().join("series.csv")).is_ok());
    let process = first.rank_processes()[0];
    for how in ["--force", "--resume"] {
        let second = talcum(0, &["run", &case, "--output", &output, how]);
        assert_eq!(second.code(), Some(1), "{how}");
        let message = second.error();
        assert!(
            message.contains(&format!("another run is writing here: process {process} on")),
            "{message}"
        );
        assert!(message.contains("UTC"), "{message}");
    }
    crate::launch::signal("KILL", process);
    first.wait();
    let next = talcum(0, &["run", &case, "--output", &output, "--force", "--until", "0.01"]);
    next.digest();
    assert!(!folder.path().join("running").exists());
}

#[test]
fn force_removes_results_only() {
    let folder = tempfile::tempdir().unwrap();
    let own = ["checkpoint-notes.txt", "checkpoint-1.h5.bak", "checkpoint-old.h5"];
    for name in own {
        fs::write(folder.path().join(name), "mine").unwrap();
    }
    let output = folder.path().display().to_string();
    let case = smoke("walls");
    // Alone they are no results.
    talcum(0, &["run", &case, "--output", &output, "--until", "0.01"]).digest();
    talcum(0, &["run", &case, "--output", &output, "--until", "0.01", "--force"]).digest();
    for name in own {
        assert_eq!(fs::read_to_string(folder.path().join(name)).unwrap(), "mine");
    }
}

#[test]
fn a_damaged_row_of_the_series_is_left_out_with_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let first = run_in(folder.path(), &[]);
    let digest = talcum(0, &arguments(&first)).digest();
    let path = folder.path().join("series.csv");
    let whole = fs::read_to_string(&path).unwrap();
    let row = whole.lines().find(|line| line.starts_with("0.05,")).unwrap();
    let damaged = whole.replace(row, &format!("0x{row}"));
    fs::write(&path, &damaged).unwrap();
    let again = run_in(folder.path(), &["--resume"]);
    let resumed = talcum(0, &arguments(&again));
    assert_eq!(resumed.digest(), digest);
    assert!(resumed.errors.contains("damaged rows are left out (line "), "{}", resumed.errors);
    assert_eq!(fs::read_to_string(&path).unwrap(), whole.replace(&format!("{row}\n"), ""));
    let copy = folder.path().join("series.csv.unreadable-1");
    assert_eq!(fs::read_to_string(copy).unwrap(), damaged);
}

#[test]
fn results_that_are_missing_start_again_with_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    talcum(0, &arguments(&run_in(folder.path(), &[]))).digest();
    fs::remove_file(folder.path().join("profiles.h5")).unwrap();
    let resumed = talcum(0, &arguments(&run_in(folder.path(), &["--resume"])));
    resumed.digest();
    assert!(resumed.errors.contains("profiles.h5 is not there"), "{}", resumed.errors);
}

#[test]
fn standard_error_that_cannot_be_written_is_no_panic() {
    let program = env!("CARGO_BIN_EXE_talcum");
    let script = format!("{program} check /nowhere/case.toml 2> /dev/full");
    let status = Command::new("sh").args(["-c", &script]).status().unwrap();
    assert_eq!(status.code(), Some(1));
}

#[test]
fn a_pipe_is_not_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe").display().to_string();
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let ended = talcum(0, &["info", &pipe]);
    assert_eq!(ended.code(), Some(1));
    assert!(ended.error().contains("this is not a file"), "{}", ended.errors);
}
