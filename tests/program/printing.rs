//! The output of commands may have no reader any more, or no room: the former is not an error, the latter is one.

use crate::analyse::made::{CASE, Made};
use crate::launch::{in_repository, smoke};
use std::fs::File;
use std::path::Path;
use std::process::{Command, Output, Stdio};

/// A folder with a complete run and a study of one run, and every command that prints.
struct Commands {
    folder: tempfile::TempDir,
    commands: Vec<Vec<String>>,
}

impl Commands {
    fn made() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name).display().to_string();
        let (case, study, results) = (smoke("walls"), path("study.toml"), path("whole"));
        let bed = in_repository("tests/program/study/bed.toml").display().to_string();
        let text = format!(
            "title = \"one\"\ncase = {bed:?}\nseeds = 1\n\
             [set]\nstage.pour.duration = 0.4\nstage.fluidise.duration = 0.4\n\
             [measure.top]\ncolumn = \"bed_top\"\nstatistic = \"last\"\n"
        );
        std::fs::write(&study, text).unwrap();
        let run = ["run", &case, "--until", "0.01", "--output"];
        let whole = Command::new(env!("CARGO_BIN_EXE_talcum")).args(run).arg(&results).output();
        assert!(whole.unwrap().status.success());
        let checkpoint = std::fs::read_dir(&results).unwrap().flatten();
        let mut checkpoints = checkpoint.map(|entry| entry.path().display().to_string());
        let checkpoint = checkpoints.find(|name| name.contains("checkpoint-")).unwrap();
        let lines = [
            "--help".to_owned(),
            "--version".to_owned(),
            "keys".to_owned(),
            "new".to_owned(),
            "info".to_owned(),
            "completions bash".to_owned(),
            "analyse --list".to_owned(),
            format!("check {case}"),
            format!("contact {case}"),
            format!("info {checkpoint}"),
            format!("analyse {results}"),
            format!("summary {results}"),
            format!("watch {results}"),
            format!("run {case} --until 0.01 --force --output {}", path("run")),
            format!("run {case} --until 0.01 --resume --output {results}"),
            format!("restart {checkpoint} --until 0.02 --force --output {}", path("restarted")),
            format!("study {study} --output {}", path("study")),
            format!("study {study} --only-list --output {}", path("study")),
            format!("study {study} --status --output {}", path("study")),
            format!("study {study} --write-slurm --output {}", path("study")),
            format!("study {study} --write-row --output {}", path("study")),
        ];
        let words = |line: &String| line.split(' ').map(str::to_owned).collect();
        let commands = lines.iter().map(words).collect();
        Self { folder, commands }
    }

    /// How each command ends whose standard output is what `output` opens.
    fn each(&self, output: impl Fn() -> Stdio, judge: impl Fn(&[String], Output)) {
        for words in &self.commands {
            let mut command = Command::new(env!("CARGO_BIN_EXE_talcum"));
            command.args(words).current_dir(self.folder.path()).env_remove("RUST_LOG");
            command.stdin(Stdio::null()).stdout(output()).stderr(Stdio::piped());
            judge(words, command.output().unwrap());
        }
    }
}

/// The writing end of a pipe that nobody reads.
fn closed_pipe() -> Stdio {
    let (_, writer) = std::io::pipe().unwrap();
    writer.into()
}

#[test]
fn a_reader_that_has_gone_is_no_error() {
    Commands::made().each(closed_pipe, |words, ended| {
        let errors = String::from_utf8_lossy(&ended.stderr);
        assert_eq!(ended.status.code(), Some(0), "{words:?}: {errors}");
        assert!(!errors.contains("panicked") && !errors.contains("error"), "{words:?}: {errors}");
    });
}

#[test]
fn a_full_device_is_an_error() {
    let full = || File::options().write(true).open("/dev/full").unwrap().into();
    Commands::made().each(full, |words, ended| {
        let errors = String::from_utf8_lossy(&ended.stderr);
        assert_eq!(ended.status.code(), Some(1), "{words:?}: {errors}");
        let expected = "error: standard output cannot be written: No space left on device";
        assert_eq!(errors.matches(expected).count(), 1, "{words:?}: {errors}");
    });
}

#[test]
fn a_server_whose_address_nobody_can_read_does_not_start() {
    let made = Made::of(CASE);
    let ended = |folder: &Path| {
        let full = File::options().write(true).open("/dev/full").unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_talcum"));
        command.arg("watch").arg(folder).args(["--serve", "0"]).stdout(full).output().unwrap()
    };
    assert_eq!(ended(made.path()).status.code(), Some(1));
}
