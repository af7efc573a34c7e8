//! The same bits on any number of ranks, on slabs and blocks, with moving and fixed cut planes: the program under
//! `mpirun`, on a dense, cohesive, frictional, vibrated bed with gas.

use crate::launch::{checkpoints, series, smoke, talcum};

/// What a run leaves, as far as the number of ranks must not change it.
#[derive(Debug, PartialEq)]
struct Results {
    digest: String,
    series: String,
}

/// Runs the case on so many ranks, and asks for the digest of the file that it left as well.
fn run(ranks: usize, until: &str, more: &[&str]) -> Results {
    let folder = tempfile::tempdir().unwrap();
    let (case, output) = (smoke("rank-equality"), folder.path().display().to_string());
    let arguments = [&["run", &case, "--output", &output, "--until", until], more].concat();
    let digest = talcum(ranks, &arguments).digest();
    let end = checkpoints(folder.path()).pop().expect("a run leaves a checkpoint");
    let info = talcum(0, &["info", &end.display().to_string()]);
    assert_eq!(info.digest(), digest);
    assert!(info.output.contains("whole"), "{}", info.output);
    Results { digest, series: series(folder.path()) }
}

fn mean_coordination_number(series: &str) -> f64 {
    let column = series.split(',').position(|name| name.starts_with("coordination_number"));
    let numbers: Vec<f64> = series
        .lines()
        .skip(1)
        .map(|row| row.split(',').nth(column.unwrap()).unwrap().parse().unwrap())
        .collect();
    numbers.iter().sum::<f64>() / numbers.len() as f64
}

const BALANCE_OFF: [&str; 2] = ["--set", "parallel.balance=off"];

#[test]
fn the_digest_is_the_same_on_any_number_of_mpi_ranks() {
    const BLOCKS: [&str; 2] = ["--ranks", "2,2,2"];
    let expected = run(0, "5", &[]);
    assert!(mean_coordination_number(&expected.series) > 2.0, "{}", expected.series);
    assert!(expected.series.lines().count() > 20);
    for (ranks, more) in [
        (1, &[][..]),
        (2, &[]),
        (3, &[]),
        (4, &[]),
        (6, &[]),
        (8, &[]),
        (8, &BLOCKS),
        (3, &BALANCE_OFF),
        (4, &[&["--ranks", "2,2,1"][..], &BALANCE_OFF].concat()),
        (6, &BALANCE_OFF),
        (8, &BALANCE_OFF),
        (8, &[BLOCKS, BALANCE_OFF].concat()),
    ] {
        assert_eq!(run(ranks, "5", more), expected, "{ranks} ranks {more:?}");
    }
}

/// Runs that must differ do.
#[test]
fn another_seed_gives_another_digest() {
    let one = run(0, "0.1", &[]);
    let other = run(0, "0.1", &["--set", "particles.seed=8"]);
    assert_ne!(one.digest, other.digest);
    assert_ne!(one.series, other.series);
}
