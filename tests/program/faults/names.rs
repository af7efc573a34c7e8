//! Folders of results with any name: their contents are read and written, or the name is rejected.

use crate::launch::{checkpoints, smoke, talcum};
use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::process::Command;

const NAMES: [&str; 8] =
    ["12:30", "a:b:c", "e\u{301}", "two words", "it's", "\"quoted\"", "two\nlines", "-o"];

#[test]
fn a_folder_of_any_name_holds_results_that_can_be_gone_on_from() {
    let folder = tempfile::tempdir().unwrap();
    let run = |ranks: usize, output: &Path, more: &[&str]| {
        let (case, output) = (smoke("walls"), format!("--output={}", output.display()));
        talcum(ranks, &[&["run", &case, &output, "--until", "0.02"], more].concat()).digest()
    };
    let expected = run(0, &folder.path().join("plain"), &[]);
    for (number, name) in NAMES.into_iter().enumerate() {
        let output = folder.path().join(name);
        assert_eq!(run(if number < 2 { 2 } else { 0 }, &output, &[]), expected, "{name:?}");
        let newest = checkpoints(&output).pop().unwrap().display().to_string();
        assert!(talcum(0, &["info", &newest]).output.contains(&expected), "{name:?}");
        let ended = talcum(0, &["restart", &newest, "--until", "0.03"]);
        ended.digest();
        assert!(output.join("series.csv").exists(), "{name:?}");
    }
}

#[test]
fn the_command_that_resumes_can_be_given_to_a_shell() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("it's two words");
    let ended = talcum(
        0,
        &[
            "run",
            &smoke("walls"),
            "--output",
            &output.display().to_string(),
            "--set",
            "run.wall_clock=\"1s\"",
            "--until",
            "1e6",
        ],
    );
    assert_eq!(ended.code(), Some(0), "{ended:?}");
    let line =
        ended.output.lines().find_map(|line| line.split_once("resume with: talcum ")).unwrap();
    let command = line.1.replace("--until 1000000", "--until 0.01 --force").replace("--resume", "");
    let command = format!("{} {command}", env!("CARGO_BIN_EXE_talcum"));
    let status = Command::new("sh").args(["-c", &command]).output().unwrap().status;
    assert_eq!(status.code(), Some(0), "{command}");
}

#[test]
fn a_name_that_is_not_in_utf_8_is_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join(OsStr::from_bytes(b"\xff"));
    let mut command = Command::new(env!("CARGO_BIN_EXE_talcum"));
    let ended = command.args(["run", &smoke("walls"), "--output"]).arg(&output).output().unwrap();
    assert_eq!(ended.status.code(), Some(1));
    let errors = String::from_utf8_lossy(&ended.stderr);
    assert!(errors.contains("not in UTF-8"), "{errors}");
    assert!(!output.exists());
}

#[test]
fn a_rank_grid_beyond_all_numbers_is_refused_for_its_number_of_ranks() {
    let ended = talcum(0, &["check", &smoke("walls"), "--ranks", "7,7905747460161236407,1"]);
    assert_eq!(ended.code(), Some(1));
    assert!(
        ended.error().contains("ranks, but 1 were started")
            || ended.error().contains("but 1 was started"),
        "{ended:?}"
    );
}
