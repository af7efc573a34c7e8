//! The examples run, and print the promised results.

#![allow(clippy::unwrap_used, reason = "in tests a panic is the report")]

mod launch;

use launch::{checkpoints, smoke, start_program, talcum};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// The folder of the examples. They are built first if only this test program was.
fn folder() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        // The talcum of the same build: target/PROFILE/talcum.
        let folder = Path::new(env!("CARGO_BIN_EXE_talcum")).parent().unwrap();
        let mut command = Command::new(env!("CARGO"));
        command.args(["build", "--quiet", "--locked", "--examples", "--target-dir"]);
        command.arg(folder.parent().unwrap()).current_dir(env!("CARGO_MANIFEST_DIR"));
        if folder.ends_with("release") {
            command.arg("--release");
        }
        assert!(command.status().unwrap().success(), "the examples do not build");
        folder.join("examples")
    })
}

/// Runs an example: alone for no ranks, else under `mpirun`. What it prints.
fn run(name: &str, ranks: usize, arguments: &[&str]) -> String {
    let ended = start_program(&folder().join(name), ranks, arguments).wait();
    assert_eq!(ended.code(), Some(0), "{}\n{}", ended.output, ended.errors);
    ended.output
}

/// The numbers of the lines that begin with one, split at commas or blanks.
fn rows(text: &str) -> Vec<Vec<f64>> {
    let row = |line: &str| {
        let fields = line.split([',', ' ']).filter(|field| !field.is_empty());
        fields.map(|field| field.parse().ok()).collect()
    };
    text.lines().filter_map(row).collect()
}

#[test]
fn run_a_bed_prints_how_a_bed_settles() {
    let output = run("run_a_bed", 0, &[]);
    let rows = rows(&output);
    assert_eq!(rows.len(), 21, "{output}");
    let (first, last) = (rows[0][1], rows[20][1]);
    // Twelve layers 1.2 apart come to lie closer. Spheres cannot fill more than 0.7405 of the volume: then the mean
    // height of these 300 above 6 by 6 would be 300 (pi / 6) / 36 / 0.7405 / 2 = 2.9.
    assert!(last < 0.8 * first && last > 2.9, "{output}");
    assert!((rows[20][0] - 4.0).abs() < 1.0e-9, "rounding of a product: {output}");
}

#[test]
fn custom_output_writes_a_row_for_each_interval() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("table.csv");
    run("custom_output", 0, &[path.to_str().unwrap()]);
    let table = std::fs::read_to_string(path).unwrap();
    assert!(table.starts_with("time,touching,kinetic_energy\n"), "{table}");
    let rows = rows(&table);
    assert_eq!(rows.len(), 21, "{table}");
    assert!(rows[0][1] == 0.0 && rows[0][2] == 0.0, "at first nothing touches or moves: {table}");
    assert!(rows[20][1] > 0.0 && rows[20][2] > 0.0, "{table}");
}

#[test]
fn custom_contact_law_returns_the_speed() {
    let output = run("custom_contact_law", 0, &[]);
    assert!(output.starts_with("met at a speed of 2, separated at "), "{output}");
}

#[test]
fn read_checkpoint_prints_what_the_run_ended_with() {
    let folder = tempfile::tempdir().unwrap();
    let results = folder.path().join("results").display().to_string();
    let case = smoke("walls");
    let digest = talcum(0, &["run", &case, "--output", &results]).digest();
    let last = checkpoints(Path::new(&results)).pop().unwrap();
    let output = run("read_checkpoint", 0, &[last.to_str().unwrap()]);
    assert_eq!(output.lines().last().unwrap(), format!("digest {digest}"));
    assert!(rows(&output).iter().all(|row| row.len() == 8), "{output}");
    assert!(rows(&output).len() > 10, "{output}");
}

#[test]
fn on_mpi_ranks_prints_the_same_digest_on_one_and_two_ranks() {
    let [one, two] = [1, 2].map(|ranks| run("on_mpi_ranks", ranks, &[]));
    assert!(one.starts_with("300 particles on 1 ranks\n"), "{one}");
    assert!(two.starts_with("300 particles on 2 ranks\n"), "{two}");
    assert_eq!(one.lines().last(), two.lines().last());
    assert!(one.contains("digest "), "{one}");
}

#[test]
fn custom_field_has_one_answer_on_any_ranks_and_through_a_restart() {
    let folder = tempfile::tempdir().unwrap();
    let outputs: Vec<String> = (1..=4)
        .map(|ranks| {
            let results = folder.path().join(ranks.to_string());
            run("custom_field", ranks, &[results.to_str().unwrap()])
        })
        .collect();
    assert!(outputs.iter().all(|output| *output == outputs[0]), "{outputs:?}");
    let results = folder.path().join("3");
    let middle = hdf5::File::open(results.join("middle.h5")).unwrap();
    let temperatures = middle.dataset("particles/temperature").unwrap().read_raw::<f64>().unwrap();
    let between = temperatures.iter().filter(|&&kelvin| kelvin > 301.0 && kelvin < 399.0).count();
    assert!(temperatures.len() == 300 && between > 30, "heat has flowed: {temperatures:?}");
    // Heat is conserved to the rounding of 300 particles' temperatures at each of 10,000 steps, half a unit in the last place each.
    let heat: f64 = temperatures.iter().sum();
    // Four layers of 25 lattice sites are below the height of 4.
    let at_start = 100.0 * 400.0 + 200.0 * 300.0;
    assert!((heat - at_start).abs() < 10_000.0 * 300.0 * 400.0 * f64::EPSILON, "{heat} {at_start}");
    let shown = hdf5::File::open(results.join("particles.vtkhdf")).unwrap();
    let shown = shown.dataset("VTKHDF/PointData/temperature").unwrap();
    assert_eq!(shown.read_raw::<f64>().unwrap()[..300], temperatures);
    // The program itself does not know the field, and says so.
    let middle = results.join("middle.h5").display().to_string();
    assert!(talcum(0, &["info", &middle]).output.contains("temperature of the particle"));
}
