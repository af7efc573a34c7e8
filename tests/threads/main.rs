//! The program with threads as ranks: the digests of the repository, and the features shared with runs under MPI:
//! results, checkpoints, signals, errors. Without the feature `mpi` the tests are the same, except for those that need
//! `mpirun`.
#![allow(clippy::unwrap_used, reason = "in tests a panic is the report")]

#[path = "../launch/mod.rs"]
mod launch;

mod endings;
#[cfg(feature = "mpi")]
mod interchange;

use launch::{Ended, in_repository, smoke, talcum};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Runs a smoke case into a folder on so many threads.
fn on_threads(threads: usize, case: &str, output: &Path, more: &[&str]) -> Ended {
    let (case, output) = (smoke(case), output.display().to_string());
    let threads = threads.to_string();
    let run = ["run", &case, "--output", &output, "--threads", &threads];
    talcum(0, &[&run, more].concat())
}

/// The digests of tests/golden.toml are those of one rank of MPI, where there is MPI (tests/program/golden.rs).
#[test]
fn the_smoke_cases_give_the_digests_of_the_repository_on_any_number_of_threads() {
    let text = fs::read_to_string(in_repository("tests/golden.toml")).unwrap();
    let expected: BTreeMap<String, String> = toml::from_str(&text).unwrap();
    // A column gas, and a volume-averaged gas, whose pressure all ranks solve for together.
    for case in ["rank-equality", "fluidised"] {
        for threads in [1, 2, 4] {
            let folder = tempfile::tempdir().unwrap();
            let digest = on_threads(threads, case, folder.path(), &[]).digest();
            assert_eq!(digest, expected[case], "{case} on {threads} threads");
        }
    }
}

#[test]
fn the_program_says_how_it_was_built() {
    let ended = talcum(0, &["info"]);
    assert_eq!(ended.code(), Some(0), "{}", ended.errors);
    assert!(ended.output.contains("--threads N"), "{}", ended.output);
    assert_eq!(ended.output.contains("processes of MPI"), cfg!(feature = "mpi"));
    assert!(ended.output.contains("HDF5"), "{}", ended.output);
}
