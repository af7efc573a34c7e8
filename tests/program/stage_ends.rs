//! States that are kept at the ends of stages, to branch from; `restart --force`.

use crate::launch::{Ended, smoke, talcum};
use std::path::Path;

/// Runs the smoke case of many stages into a folder.
fn run_stages(ranks: usize, output: &Path, more: &[&str]) -> String {
    let (case, output) = (smoke("staged"), output.display().to_string());
    let keep = ["--set", "checkpoint.stage_ends=true", "--set", "checkpoint.keep=1"];
    let run = ["run", case.as_str(), "--output", &output];
    talcum(ranks, &[&run[..], &keep, more].concat()).digest()
}

#[test]
fn the_end_of_each_stage_is_kept_and_leads_to_the_same_state() {
    let folder = tempfile::tempdir().unwrap();
    let results = folder.path().join("results");
    let digest = run_stages(2, &results, &[]);
    let names = ["1-settle", "2-gas_on", "3-cohesion_grows", "4-vibrate", "5-cohesion_off"];
    let branch = folder.path().join("branch").display().to_string();
    for name in names {
        let kept = results.join(format!("stage-{name}.h5")).display().to_string();
        let from = ["restart", kept.as_str(), "--output", &branch, "--force"];
        assert_eq!(talcum(0, &from).digest(), digest, "{name}");
    }
    // Without --force the results of the branch before stay.
    let kept = results.join("stage-1-settle.h5").display().to_string();
    let ended = talcum(0, &["restart", &kept, "--output", &branch]);
    assert!(ended.error().contains("holds the results of an earlier run"), "{ended:?}");
    // The folder of the checkpoint itself is never cleared.
    let ended = talcum(0, &["restart", &kept, "--force"]);
    assert!(ended.error().contains("--force would remove the checkpoint itself"), "{ended:?}");
    assert!(Path::new(&kept).exists());
}

#[test]
fn only_ends_of_stages_are_kept_and_only_if_the_case_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let kept = |name: &str| folder.path().join(name).join("stage-1-settle.h5").exists();
    // Stopped within the first stage, and at its end.
    run_stages(0, &folder.path().join("within"), &["--until", "0.5"]);
    assert!(!kept("within"));
    run_stages(0, &folder.path().join("end"), &["--until", "1.0"]);
    assert!(kept("end"));
    let off = ["--set", "checkpoint.stage_ends=false", "--until", "1.0"];
    run_stages(0, &folder.path().join("off"), &off);
    assert!(!kept("off"));
}

/// A key of a section that a stage only switches on.
#[test]
fn a_key_of_a_section_can_be_set_where_the_stage_says_on() {
    let case = smoke("staged");
    let set = |change: &'static str| ["--set", change];
    let off = set("stage.settle.vibration=\"off\"");
    let on = set("stage.gas on.vibration=\"on\"");
    let all = [set("vibration.gamma=2.0"), set("vibration.frequency=1.0"), off, on].concat();
    let other = set("stage.gas on.vibration.gamma=4.5");
    let check = |more: &[&str]| talcum(0, &[&["check", case.as_str()][..], &all, more].concat());
    let printed = |ended: &Ended| ended.output.matches("4.5000, 1.0000").count();
    let (usual, changed) = (check(&[]), check(&other));
    assert_eq!((usual.code(), changed.code()), (Some(0), Some(0)), "{}", changed.errors);
    assert_eq!(printed(&usual), 0, "{}", usual.output);
    assert!(printed(&changed) > 0, "{}", changed.output);
}
