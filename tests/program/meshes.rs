//! Meshes come from files: results hold a copy, and a run continues with the mesh with which it began.

use crate::launch::{checkpoints, in_repository, talcum};
use std::fs;
use std::path::{Path, PathBuf};

/// The smoke case with its meshes in a folder.
fn case_in(folder: &Path) -> PathBuf {
    for name in ["meshes.toml", "hopper.stl", "blade.obj"] {
        fs::copy(in_repository("cases/smoke").join(name), folder.join(name)).unwrap();
    }
    folder.join("meshes.toml")
}

fn text(path: &Path) -> String {
    path.display().to_string()
}

#[test]
fn a_restart_needs_the_mesh_with_which_the_run_began() {
    let folder = tempfile::tempdir().unwrap();
    let (case, results) = (text(&case_in(folder.path())), folder.path().join("results"));
    let of_whole = folder.path().join("whole");
    let whole = talcum(0, &["run", &case, "--output", &text(&of_whole), "--until", "12"]).digest();
    talcum(0, &["run", &case, "--output", &text(&results), "--until", "10"]).digest();
    let middle = text(&checkpoints(&results).pop().unwrap());
    let restart = || talcum(2, &["restart", &middle, "--until", "12"]);
    let hopper = folder.path().join("hopper.stl");
    let original = fs::read_to_string(&hopper).unwrap();
    fs::write(&hopper, original.replace("vertex -25", "vertex -22")).unwrap();
    let refused = restart();
    assert_ne!(refused.code(), Some(0));
    let words = "checksum = \"f37b6ace";
    assert!(refused.errors.contains(words), "{}", refused.errors);
    assert!(refused.errors.contains("the file has changed"), "{}", refused.errors);
    fs::write(&hopper, original).unwrap();
    assert_eq!(restart().digest(), whole);
    // Control: with the other mesh a new run gives another digest.
    let narrow = fs::read_to_string(&hopper).unwrap().replace("vertex -25", "vertex -22");
    fs::write(&hopper, narrow).unwrap();
    let of_other = text(&folder.path().join("other"));
    let other = talcum(0, &["run", &case, "--output", &of_other, "--until", "12"]).digest();
    assert_ne!(other, whole);
}

#[test]
fn results_can_be_read_without_the_original_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let (case, results) = (text(&case_in(folder.path())), folder.path().join("results"));
    talcum(0, &["run", &case, "--output", &text(&results), "--until", "10"]).digest();
    fs::remove_file(folder.path().join("hopper.stl")).unwrap();
    let analysed = talcum(0, &["analyse", &text(&results), "--no-save"]);
    assert!(!analysed.output.contains("does not accept"), "{}", analysed.output);
    let again = text(&results.join("case.toml"));
    let of_copy = folder.path().join("copy");
    let copied = talcum(0, &["run", &again, "--output", &text(&of_copy), "--until", "1"]);
    assert_eq!(copied.code(), Some(0), "{}", copied.errors);
    // Negative control: without the copy neither is possible.
    fs::remove_file(results.join("mesh-f37b6ace83692aad.stl")).unwrap();
    assert_ne!(talcum(0, &["check", &again]).code(), Some(0));
}
