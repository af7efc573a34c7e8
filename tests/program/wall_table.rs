//! The table of forces on walls, `walls.csv`: names and size classes; it is the same on any ranks and after an
//! interruption.

use crate::launch::{smoke, talcum};
use std::path::Path;

const SET: [&str; 8] = [
    "--set",
    "particles.diameter={ values = [1.0, 0.8], fractions = [0.5, 0.5] }",
    "--set",
    "particles.reference_diameter=1.0",
    "--set",
    "time.end=3.0",
    "--set",
    "output.walls=0.3",
];

fn run(ranks: usize, folder: &Path, more: &[&str]) {
    let (case, output) = (smoke("walls"), folder.display().to_string());
    let arguments = [&["run", &case, "--output", &output][..], &SET, more].concat();
    let ended = talcum(ranks, &arguments);
    assert_eq!(ended.code(), Some(0), "{ended:?}");
}

/// The rows, without the comments.
fn rows(folder: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(folder.join("walls.csv")).unwrap();
    text.lines().filter(|line| !line.starts_with('#')).map(str::to_owned).collect()
}

#[test]
fn the_table_of_walls_is_the_same_on_any_ranks_and_through_an_interruption() {
    let folders = [(); 3].map(|()| tempfile::tempdir().unwrap());
    let [alone, two, interrupted] = folders.each_ref().map(|folder| folder.path());
    run(0, alone, &[]);
    let expected = rows(alone);
    assert_eq!(
        expected[0],
        "time [sqrt(d/g)],wall,diameter [d],force_x [rho_s g d^3],force_y [rho_s g d^3],force_z [rho_s g d^3]"
    );
    // 11 times, 7 walls, all particles and two classes.
    assert_eq!(expected.len(), 1 + 11 * 7 * 3);
    assert!(expected[1].starts_with("0,x lower,,") && expected[2].starts_with("0,x lower,0.8,"));
    let on_plate = expected.iter().rfind(|row| row.contains(",base plate,,")).unwrap();
    let force: f64 = on_plate.rsplit(',').next().unwrap().parse().unwrap();
    assert!(force < -1.0, "the plate carries particles: {on_plate}");
    run(2, two, &[]);
    assert_eq!(rows(two), expected);
    run(2, interrupted, &["--until", "1.65"]);
    assert!(rows(interrupted).len() < expected.len());
    run(0, interrupted, &["--resume"]);
    assert_eq!(rows(interrupted), expected);
}
