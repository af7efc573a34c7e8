//! The digests of the smoke cases, kept in tests/golden.toml: an unintended change of results is detected.
//!
//! After an intended change, examine its effect on the beds, write the new digests with
//!
//! ```sh
//! TALCUM_UPDATE_GOLDEN=1 cargo test --test program golden
//! ```
//!
//! and explain in the commit what changed the results. The computation of the state uses no function of the system's
//! mathematical library, so the digests hold on any machine with IEEE 754 doubles.

use crate::launch::{Ended, in_repository, smoke, start_with, talcum};
use std::collections::BTreeMap;
use std::fs;

const HEAD: &str =
    "# Digests at the end of the cases in cases/smoke. How to update: tests/program/golden.rs.\n";

fn digest_of(case: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("results").display().to_string();
    talcum(0, &["run", case, "--output", &output]).digest()
}

#[test]
fn the_smoke_cases_give_the_digests_of_the_repository() {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(in_repository("cases/smoke")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let name = path.file_stem().unwrap().to_string_lossy().into_owned();
            found.insert(name, digest_of(&path.display().to_string()));
        }
    }
    let golden = in_repository("tests/golden.toml");
    if std::env::var_os("TALCUM_UPDATE_GOLDEN").is_some() {
        let rows = found.iter().map(|(name, digest)| format!("{name} = \"{digest}\"\n"));
        fs::write(&golden, HEAD.to_owned() + &rows.collect::<String>()).unwrap();
    }
    let text = fs::read_to_string(&golden).unwrap();
    let expected: BTreeMap<String, String> = toml::from_str(&text).unwrap();
    assert_eq!(
        found, expected,
        "results have changed; if that is intended, tests/program/golden.rs says what to do"
    );
}

/// Runs a smoke case with vectors of at most this kind.
fn run_with_vectors(vectors: &str, ranks: usize, case: &str) -> Ended {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("results").display().to_string();
    let variable = [("TALCUM_VECTORS", vectors.to_owned())];
    start_with(&variable, ranks, &["run", &smoke(case), "--output", &output]).wait()
}

/// Pairs of one size and of many, walls, the column gas and the volume-averaged gas.
#[test]
fn vectors_of_any_width_give_one_digest() {
    for case in ["fluidised", "polydisperse", "walls"] {
        let digest = digest_of(&smoke(case));
        for vectors in ["baseline", "avx2", "avx512"] {
            let found = run_with_vectors(vectors, 0, case).digest();
            assert_eq!(found, digest, "{case} with vectors of {vectors}");
        }
    }
}

#[test]
fn vectors_of_an_unknown_kind_are_refused_by_one_message() {
    let ended = run_with_vectors("wide", 2, "walls");
    assert_eq!(ended.code(), Some(1), "{ended:?}");
    let words = "TALCUM_VECTORS = \"wide\": must be baseline, avx2 or avx512";
    assert_eq!(ended.errors.matches(words).count(), 1, "{}", ended.errors);
}
