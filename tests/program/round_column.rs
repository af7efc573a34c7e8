//! Gas in a round column, in a case and in its files.

use crate::launch::{checkpoints, in_repository, run_case, runs_of, series, talcum};

fn file() -> String {
    in_repository("tests/cases/good/round-column.toml").display().to_string()
}

#[test]
fn a_case_has_one_digest_on_any_ranks_and_through_a_restart() {
    let folder = tempfile::tempdir().unwrap();
    let run = runs_of(&file(), folder.path());
    let digest = run(0, "whole", &[]).digest();
    for ranks in [2, 3, 4] {
        assert_eq!(run(ranks, &format!("{ranks}"), &[]).digest(), digest, "{ranks} ranks");
    }
    run(2, "part", &["--until", "0.5"]);
    let start = checkpoints(&folder.path().join("part")).pop().unwrap().display().to_string();
    let output = folder.path().join("rest").display().to_string();
    let rest = talcum(3, &["restart", &start, "--output", &output]).digest();
    assert_eq!(rest, digest);
    // Control: a narrower column.
    assert_ne!(run(0, "narrower", &["--set", "wall.1.radius=3.7"]).digest(), digest);
}

#[test]
fn fluxes_are_those_of_the_column_and_closed_cells_have_no_gas() {
    let folder = tempfile::tempdir().unwrap();
    run_case(2, [&file(), &folder.path().display().to_string()], &[]).digest();
    let table = series(folder.path());
    let mut rows = table.lines().filter(|line| !line.starts_with('#'));
    let names = rows.next().unwrap().split(',').collect::<Vec<_>>();
    let column = names.iter().position(|name| name.starts_with("superficial_velocity")).unwrap();
    let velocities: Vec<f64> =
        rows.map(|row| row.split(',').nth(column).unwrap().parse().unwrap()).collect();
    // A parabolic profile of this mean over pi R^2, from the first gas step on; sums of some 30 cells.
    assert!(velocities.len() > 5);
    assert!(velocities[1..].iter().all(|u| (u - 0.25).abs() < 1.0e-14), "{velocities:?}");
    let gas = hdf5::File::open(folder.path().join("gas.vtkhdf")).unwrap();
    let voidage: Vec<f64> = gas.dataset("VTKHDF/CellData/voidage").unwrap().read_raw().unwrap();
    let velocity: Vec<f64> = gas.dataset("VTKHDF/CellData/velocity").unwrap().read_raw().unwrap();
    let pressure: Vec<f64> = gas.dataset("VTKHDF/CellData/pressure").unwrap().read_raw().unwrap();
    for (cell, (&eps, u)) in voidage.iter().zip(velocity.chunks_exact(3)).enumerate() {
        let centre = [(cell % 6) as f64 + 0.5, (cell / 6 % 6) as f64 + 0.5];
        let [x, y] = [centre[0] * 8.0 / 6.0 - 4.1, centre[1] * 9.0 / 6.0 - 4.4];
        let is_open = x.hypot(y) < 3.8;
        assert!(if is_open { (0.2..=1.0).contains(&eps) } else { eps == 0.0 }, "{cell}: {eps}");
        assert!(is_open || (u == [0.0; 3] && pressure[cell] == 0.0), "{cell}: {u:?}");
    }
    // The control: some are open and some closed.
    assert!(voidage.contains(&0.0) && voidage.iter().any(|&eps| eps < 0.9 && eps > 0.0));
}
