//! The energy ledger in a run, `energy.csv`: it closes over stages that change the models, and is the same on any ranks
//! and after an interruption.

use crate::launch::{smoke, talcum};
use std::path::Path;

/// Runs a smoke case with a ledger; its digest.
fn run(ranks: usize, case: &str, folder: &Path, more: &[&str]) -> String {
    let (case, output) = (smoke(case), folder.display().to_string());
    let set = ["--set", "output.energy=0.1"];
    let ended = talcum(ranks, &[&["run", &case, "--output", &output][..], &set, more].concat());
    assert_eq!(ended.code(), Some(0), "{ended:?}");
    ended.output.lines().last().unwrap().to_owned()
}

/// The line of names and the rows.
fn table(folder: &Path) -> (Vec<String>, Vec<Vec<f64>>) {
    let text = std::fs::read_to_string(folder.join("energy.csv")).unwrap();
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let names = lines.next().unwrap().split(',');
    let names = names.map(|name| name.split(' ').next().unwrap().to_owned()).collect();
    let row = |line: &str| line.split(',').map(|cell| cell.parse().unwrap()).collect();
    (names, lines.map(row).collect())
}

#[test]
fn the_ledger_of_a_run_in_stages_closes() {
    let folder = tempfile::tempdir().unwrap();
    run(0, "staged", folder.path(), &[]);
    let (names, rows) = table(folder.path());
    let last = rows.last().unwrap();
    let of = |name: &str| last[names.iter().position(|other| other == name).unwrap()];
    let mechanisms = ["dashpot", "friction", "plasticity", "cohesion", "gas", "walls", "gravity"];
    let work: f64 = mechanisms.iter().chain(&["models", "departed"]).map(|name| of(name)).sum();
    let start: f64 = rows[0][1..4].iter().sum();
    let stored = of("kinetic") + of("attraction") + of("elastic");
    // The same numbers, added in another order.
    assert!((stored - start - work - of("closure_error")).abs() < 1.0e-9, "{last:?}");
    let all: f64 = mechanisms.iter().map(|name| of(name).abs()).sum();
    println!("closure error of the staged case: {:.2e} of {all}", of("closure_error"));
    // Steps of a fifteenth of a contact and less: the integrator's first order.
    assert!(of("closure_error").abs() < 0.01 * all, "{last:?}");
    // Negative controls: a stage that switches cohesion or gas on is seen, and would be missed.
    assert!(of("gas") != 0.0 && of("models") != 0.0, "{last:?}");
}

#[test]
fn the_table_of_energies_is_the_same_on_any_ranks_and_through_an_interruption() {
    let folders = [(); 4].map(|()| tempfile::tempdir().unwrap());
    let [alone, two, interrupted, without] = folders.each_ref().map(|folder| folder.path());
    let digest = run(0, "walls", alone, &["--set", "time.end=2.5"]);
    let expected = table(alone);
    assert_eq!(expected.1.len(), 26);
    assert_eq!(run(2, "walls", two, &["--set", "time.end=2.5"]), digest);
    assert_eq!(table(two), expected);
    run(2, "walls", interrupted, &["--set", "time.end=2.5", "--until", "2.13"]);
    run(3, "walls", interrupted, &["--set", "time.end=2.5", "--resume"]);
    assert_eq!(table(interrupted), expected);
    // The account changes no bit of the run.
    let (case, output) = (smoke("walls"), without.display().to_string());
    let ended = talcum(0, &["run", &case, "--output", &output, "--set", "time.end=2.5"]);
    assert_eq!(ended.output.lines().last().unwrap(), digest);
    assert!(!without.join("energy.csv").exists());
}
