//! Drag from agglomerates, in a case and in its files.

use crate::launch::{checkpoints, in_repository, runs_of, series, talcum};
use std::path::Path;

fn file() -> String {
    in_repository("tests/cases/good/agglomerate-drag.toml").display().to_string()
}

/// The last column of the series.
fn drag_factors(folder: &Path) -> Vec<f64> {
    let table = series(folder);
    let mut rows = table.lines().filter(|line| !line.starts_with('#'));
    assert!(rows.next().unwrap().rsplit(',').next().unwrap().starts_with("drag_factor"));
    rows.map(|row| row.rsplit(',').next().unwrap().parse().unwrap()).collect()
}

/// Whether a checkpoint has what drag of agglomerates needs.
fn has_agglomerates(path: &str) -> bool {
    let file = hdf5::File::open(path).unwrap();
    ["looked_at", "particles/agglomerate_diameter"].iter().all(|name| file.link_exists(name))
}

#[test]
fn a_case_has_one_digest_on_any_ranks_and_through_a_restart_between_looks() {
    let folder = tempfile::tempdir().unwrap();
    let run = runs_of(&file(), folder.path());
    // The case asks for two ranks.
    let alone = ["--ranks", "1,1,1"];
    let digest = run(0, "whole", &alone).digest();
    for (ranks, grid) in [(2, "1,1,2"), (3, "1,1,3"), (4, "1,1,4")] {
        let name = format!("on {ranks}");
        assert_eq!(run(ranks, &name, &["--ranks", grid]).digest(), digest, "{ranks} ranks");
        // Every number of the series, the mean factor among them.
        assert_eq!(series(&folder.path().join(&name)), series(&folder.path().join("whole")));
    }
    // Step 2503: a look each 80 steps, a gas step each 4.
    run(2, "part", &["--until", "1.2515", "--ranks", "1,1,2"]);
    let start = checkpoints(&folder.path().join("part")).pop().unwrap().display().to_string();
    assert!(has_agglomerates(&start));
    let rest = |name: &str, more: &[&str]| {
        let output = folder.path().join(name).display().to_string();
        let arguments = ["restart", &start, "--output", &output, "--ranks", "1,1,3"];
        talcum(3, &[&arguments[..], more].concat()).digest()
    };
    assert_eq!(rest("rest", &[]), digest);
    // Control: one factor for all.
    assert_ne!(rest("other", &["--set", "gas.drag_factor=0.5"]), digest);
}

#[test]
fn the_series_shows_the_mean_factor() {
    let folder = tempfile::tempdir().unwrap();
    let run = runs_of(&file(), folder.path());
    run(0, "agglomerates", &["--ranks", "1,1,1"]);
    let factors = drag_factors(&folder.path().join("agglomerates"));
    // Single particles at first, agglomerates at the end, all of them small.
    assert_eq!(factors[0], 1.0);
    assert!((0.5..0.97).contains(factors.last().unwrap()), "{factors:?}");
    // Control: one factor for all is no measurement, and its checkpoints are those of before.
    run(0, "one", &["--ranks", "1,1,1", "--set", "gas.drag_factor=0.5", "--until", "0.2"]);
    let one = folder.path().join("one");
    assert!(drag_factors(&one).iter().all(|&factor| factor == 0.0));
    assert!(!has_agglomerates(&checkpoints(&one).pop().unwrap().display().to_string()));
}
