//! The command: its printed and written results, its messages on missing, damaged or foreign files, and their
//! independence of the ranks of the run.

use super::made::{CASE, Made};
use crate::launch::{Ended, in_repository, talcum};
use std::path::Path;
use talcum::analysis::SeriesRow;
use talcum::post_processing::scalar_names;

fn analyse(folder: &Path, options: &[&str]) -> Ended {
    talcum(0, &[&["analyse", folder.to_str().unwrap()], options].concat())
}

/// The last line: the hash of all that was found.
fn tables(ended: &Ended) -> &str {
    assert_eq!(ended.code(), Some(0), "{}\n{}", ended.output, ended.errors);
    ended.output.lines().last().unwrap().strip_prefix("tables ").unwrap()
}

fn with_series() -> Made {
    let made = Made::of(CASE);
    let row = |k: u32| SeriesRow {
        time: 0.5 * f64::from(k),
        gas_force: 1.0 + 0.1 * f64::from(k % 7),
        ..Default::default()
    };
    made.series((0..200).map(row));
    made
}

#[test]
fn what_files_do_not_allow_is_said_and_is_no_error() {
    let made = with_series();
    let ended = analyse(made.path(), &[]);
    tables(&ended);
    assert!(ended.errors.is_empty(), "{}", ended.errors);
    for said in [
        "there is no profiles.h5: the key output.profiles of the case would give it",
        "there is no particles.vtkhdf: the key output.particles",
        "there is no gas.vtkhdf: the key output.gas",
        "there is no checkpoint: [checkpoint] of the case",
        "mean.gas_force ",
    ] {
        assert!(ended.output.contains(said), "{said}\n{}", ended.output);
    }
    assert!(made.path().join("analysis.h5").exists());
    // A part of it elsewhere.
    let other = tempfile::tempdir().unwrap();
    let options =
        ["--analysis", "mean", "--from", "10", "--output", other.path().to_str().unwrap()];
    let part = analyse(made.path(), &options);
    assert!(part.output.contains("mean.gas_force") && !part.output.contains("profiles.h5"));
    assert!(other.path().join("analysis.h5").exists());
    assert_ne!(tables(&part), tables(&ended));
}

#[test]
fn damaged_and_foreign_files_are_named() {
    let made = with_series();
    let profiles = made.path().join("profiles.h5");
    let heights: Vec<f64> = (0..200).map(f64::from).collect();
    made.profiles(&heights, |z, _| if z < 50.0 { 0.6 } else { 0.0 });
    let whole = std::fs::read(&profiles).unwrap();
    let cut = whole[..whole.len() / 2].to_vec();
    let empty = Vec::new();
    for (bytes, said) in [
        (cut, "talcum run --resume"),
        (empty, "not an HDF5 file, or it was cut short"),
        (b"solids fraction".to_vec(), "not an HDF5 file"),
    ] {
        std::fs::write(&profiles, bytes).unwrap();
        let ended = analyse(made.path(), &["--analysis", "waves", "--analysis", "mean"]);
        assert_eq!(ended.code(), Some(1), "{}\n{}", ended.output, ended.errors);
        let error = ended.error();
        assert!(error.contains("profiles.h5") && error.contains(said), "{error}");
        // What can be measured is.
        assert!(ended.output.contains("mean.gas_force"), "{}", ended.output);
    }
    std::fs::write(&profiles, whole).unwrap();
    assert_eq!(analyse(made.path(), &["--analysis", "waves"]).code(), Some(0));
    // A series with a row that is none, and one that is being written.
    let series = made.path().join("series.csv");
    let text = std::fs::read_to_string(&series).unwrap();
    std::fs::write(&series, format!("{text}1.0,2.0\n")).unwrap();
    let ended = analyse(made.path(), &["--analysis", "mean"]);
    assert!(ended.error().contains("is not a row of numbers"), "{}", ended.errors);
    std::fs::write(&series, format!("{text}100.0,2.")).unwrap();
    assert_eq!(analyse(made.path(), &["--analysis", "mean"]).code(), Some(0));
}

#[test]
fn bad_options_are_refused() {
    let made = with_series();
    let refused = |options: &[&str], said: &str| {
        let ended = analyse(made.path(), options);
        assert_eq!(ended.code(), Some(1));
        assert!(ended.error().contains(said), "{}", ended.errors);
    };
    refused(
        &["--analysis", "wave"],
        "--analysis wave: there is no such analysis; there are bed, waves, u_mf",
    );
    refused(&["--from", "5", "--to", "2"], "the first must not be after the last");
    let elsewhere = tempfile::tempdir().unwrap();
    let ended = analyse(elsewhere.path(), &[]);
    assert!(ended.error().contains("name the folder of results of a run"), "{}", ended.errors);
    let none = made.path().join("late");
    std::fs::create_dir(&none).unwrap();
    let late = analyse(made.path(), &["--analysis", "mean", "--from", "1000"]);
    assert_eq!(late.code(), Some(0));
    assert!(late.output.contains("holds nothing between the times 1000"), "{}", late.output);
}

#[test]
fn every_number_has_its_line_in_the_manual() {
    let manual = std::fs::read_to_string(in_repository("docs/analyse.md")).unwrap();
    let listed = talcum(0, &["analyse", "--list"]);
    let names = scalar_names();
    assert!(names.len() > 60);
    for name in &names {
        assert!(listed.output.contains(name.as_str()), "talcum analyse --list lacks {name}");
        // Those of one kind stand for all columns of series.csv.
        let family = name.split('.').next().unwrap_or_default();
        let shown = match family {
            "mean" | "spectrum" => format!("`{family}.COLUMN`"),
            _ => format!("`{name}`"),
        };
        assert!(manual.contains(&shown), "docs/analyse.md lacks {shown}");
    }
}

#[test]
fn runs_on_any_ranks_are_analysed_to_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let case = in_repository("tests/program/study/bed.toml").display().to_string();
    let analysed = |ranks: usize, seed: &str| {
        let output = folder.path().join(format!("{ranks}-{seed}"));
        let set = format!("particles.seed={seed}");
        let arguments = [
            "run",
            &case,
            "--output",
            output.to_str().unwrap(),
            "--until",
            "4",
            "--set",
            &set,
            "--set",
            "output.profiles=0.1",
            "--set",
            "output.particles=0.2",
            "--set",
            "checkpoint.keep=9",
        ];
        talcum(ranks, &arguments).digest();
        tables(&analyse(&output, &[])).to_owned()
    };
    let one = analysed(0, "1");
    assert_eq!(analysed(2, "1"), one);
    // The control: another bed gives other numbers.
    assert_ne!(analysed(0, "2"), one);
}
