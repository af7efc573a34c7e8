//! A study with the real program: interrupted or not, on any ranks, it comes to the same tables; a bad value is refused
//! before anything runs.

use crate::launch::{Ended, in_repository, signal, start, talcum, turn_of_mpirun};
use std::path::{Path, PathBuf};

/// Exit code of a study that was stopped and can go on.
const STOPPED: i32 = 75;

fn data(name: &str) -> PathBuf {
    in_repository("tests/program/study").join(name)
}

fn arguments<'a>(study: &'a Path, output: &'a Path, options: &[&'a str]) -> Vec<&'a str> {
    let mut arguments = vec!["study", study.to_str().unwrap(), "--output"];
    arguments.push(output.to_str().unwrap());
    arguments.extend(options);
    arguments
}

fn run(study: &Path, output: &Path, options: &[&str]) -> Ended {
    talcum(0, &arguments(study, output, options))
}

#[track_caller]
fn assert_code(ended: &Ended, code: i32) {
    assert_eq!(ended.code(), Some(code), "{}\n{}", ended.output, ended.errors);
}

fn tables(output: &Path) -> String {
    let read = |name: &str| std::fs::read_to_string(output.join(name)).unwrap();
    read("runs.csv") + &read("points.csv")
}

/// Starts a study, waits until a run has written a checkpoint without being complete, and sends a signal.
fn interrupt(study: &Path, output: &Path, options: &[&str], name: &str) -> Ended {
    let mut running = start(0, &arguments(study, output, options));
    running.wait_until(|| is_under_way(output));
    signal(name, running.process());
    running.wait()
}

fn is_under_way(output: &Path) -> bool {
    let runs = std::fs::read_dir(output.join("runs")).into_iter().flatten().flatten();
    let under_way = |folder: PathBuf| {
        let entries = std::fs::read_dir(&folder).unwrap().flatten();
        let names: Vec<String> =
            entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        let has_checkpoint = names.iter().any(|name| name.starts_with("checkpoint-"));
        has_checkpoint && !names.iter().any(|name| name == "complete")
    };
    runs.map(|entry| entry.path()).any(under_way)
}

#[test]
fn tables_do_not_depend_on_ranks_and_interruptions() {
    let _turn = turn_of_mpirun();
    let folder = tempfile::tempdir().unwrap();
    let study = data("study.toml");
    let (whole, broken) = (folder.path().join("whole"), folder.path().join("broken"));
    assert_code(&run(&study, &whole, &["--at-a-time", "2"]), 0);
    let expected = tables(&whole);
    assert_eq!(expected.matches(",complete,").count(), 8, "{expected}");

    // Stopped gently: all runs have ended when the study ends.
    let on_two = ["--ranks-per-run", "2"];
    assert_code(&interrupt(&study, &broken, &on_two, "INT"), STOPPED);
    let status = run(&study, &broken, &["--status"]);
    assert!(status.output.contains(" 0 running"), "{}", status.output);

    // Killed at once: its run goes on by itself, and the next study waits for it instead of running it twice.
    assert_eq!(interrupt(&study, &broken, &on_two, "KILL").code(), None);
    assert_code(&run(&study, &broken, &on_two), 0);
    assert_eq!(tables(&broken), expected);

    // Nothing is left to do, and what is written again is the same.
    std::fs::remove_file(broken.join("runs.csv")).unwrap();
    let nothing_starts = ["--ranks-per-run", "2", "--launcher", "no-such-program"];
    assert_code(&run(&study, &broken, &nothing_starts), 0);
    assert_eq!(tables(&broken), expected);
}

#[test]
fn a_bad_value_is_refused_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(data("study.toml")).unwrap();
    let text = text.replace("bed.toml", &data("bed.toml").display().to_string());
    let study = folder.path().join("bad.toml");
    std::fs::write(&study, text.replace("[0.0, 8.0]", "[-1.0, 8.0]")).unwrap();
    let output = folder.path().join("out");
    let refused = run(&study, &output, &[]);
    assert_code(&refused, 1);
    let message = refused.error();
    assert!(message.contains("bad.toml:5: cohesion.bond_number = -1.0: must be"), "{message}");
    assert!(!output.join("runs").exists());
}

#[test]
fn the_case_and_the_study_are_those_of_the_docs() {
    let docs = std::fs::read_to_string(in_repository("docs/study.md")).unwrap();
    for name in ["bed.toml", "study.toml"] {
        let text = std::fs::read_to_string(data(name)).unwrap();
        assert!(docs.contains(&format!("```toml\n{text}```")), "{name}");
    }
}
