//! The digests of the smoke cases, kept in tests/golden.toml: an unintended change of results is seen.
//!
//! After an intended change, look at what it does to the beds, write the new digests with
//!
//! ```sh
//! TALCUM_UPDATE_GOLDEN=1 cargo test --test program golden
//! ```
//!
//! and say in the commit what changed the results. The state's path uses no function of the system's
//! mathematical library, so that the digests are those of any machine with IEEE 754 doubles.

use crate::launch::{in_repository, talcum};
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
        "results have changed; if that is intended, tests/program/golden.rs says how to go on"
    );
}
