//! Files written with ranks as threads and with ranks of MPI are interchangeable: they have the same rows, and each
//! kind resumes from the other's checkpoint.

use super::on_threads;
use crate::launch::{checkpoints, series, smoke, talcum};
use std::collections::BTreeMap;
use std::path::Path;

fn text(path: &Path) -> String {
    path.display().to_string()
}

/// Shape and bytes of every dataset of numbers in a file.
fn datasets(path: &Path) -> BTreeMap<String, (Vec<usize>, Vec<u64>)> {
    let mut found = BTreeMap::new();
    let mut groups = vec![hdf5::File::open(path).unwrap().as_group().unwrap()];
    while let Some(group) = groups.pop() {
        groups.extend(group.groups().unwrap());
        for dataset in group.datasets().unwrap() {
            let bits = if dataset.dtype().unwrap().is::<f64>() {
                dataset.read_raw::<f64>().unwrap().into_iter().map(f64::to_bits).collect()
            } else {
                dataset.read_raw::<u64>().unwrap_or_default()
            };
            found.insert(dataset.name(), (dataset.shape(), bits));
        }
    }
    found
}

/// Everything that two folders of results must have in common.
fn assert_same_results(one: &Path, other: &Path) {
    assert_eq!(series(one), series(other));
    let [first, second] = [one, other].map(|folder| text(&checkpoints(folder).pop().unwrap()));
    for (one, other) in [
        (one.join("profiles.h5"), other.join("profiles.h5")),
        (one.join("particles.vtkhdf"), other.join("particles.vtkhdf")),
        (first.into(), second.into()),
    ] {
        let [one, other] = [one, other].map(|path| datasets(&path));
        assert!(one.len() >= 5, "{:?}", one.keys());
        assert_eq!(one, other);
    }
}

#[test]
fn threads_and_processes_write_the_same_rows() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    let (case, processes) = (smoke("staged"), place("processes"));
    let expected = talcum(2, &["run", &case, "--output", &text(&processes)]).digest();
    for threads in [1, 2, 4] {
        let output = place(&threads.to_string());
        assert_eq!(on_threads(threads, "staged", &output, &[]).digest(), expected);
        assert_same_results(&output, &processes);
    }
    let end = text(&checkpoints(&place("2")).pop().unwrap());
    let said = talcum(0, &["info", &end]).output;
    assert!(said.contains("2 ranks (threads)"), "{said}");
    let end = text(&checkpoints(&processes).pop().unwrap());
    let said = talcum(0, &["info", &end]).output;
    assert!(said.contains("2 ranks (MPI processes)"), "{said}");
}

/// Half of the run on processes and the rest on threads, and the reverse.
#[test]
fn each_resumes_from_the_checkpoints_of_the_other() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    let (case, whole) = (smoke("staged"), place("whole"));
    let expected = on_threads(1, "staged", &whole, &[]).digest();
    let half = ["--until", "1.75"];

    let output = place("processes first");
    talcum(2, &[&["run", &case, "--output", &text(&output)], &half[..]].concat()).digest();
    assert_eq!(on_threads(3, "staged", &output, &["--resume"]).digest(), expected);
    assert_same_results(&output, &whole);

    let output = place("threads first");
    on_threads(2, "staged", &output, &half).digest();
    let at_half = text(&checkpoints(&output).pop().unwrap());
    let elsewhere = text(&place("elsewhere"));
    let restart = ["restart", &at_half, "--output", &elsewhere];
    assert_eq!(talcum(2, &restart).digest(), expected);
    let resume = ["run", &case, "--resume", "--output", &text(&output)];
    assert_eq!(talcum(2, &resume).digest(), expected);
    assert_same_results(&output, &whole);
}
