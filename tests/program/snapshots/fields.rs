//! Optional columns of snapshots, compared with the series and on several ranks.

use crate::launch::{smoke, talcum};
use std::path::Path;
use talcum::output::readers::SeriesTable;

/// Two classes of one size, the second 2.5 times as heavy; the smaller ones of a third class are light.
const CLASSES: &str = "particles.diameter={ values = [1.0, 1.0, 0.8], fractions = [0.5, 0.3, 0.2], densities = [1.0, 2.5, 0.5] }";
const FIELDS: &str =
    "output.particle_fields=[\"mass\", \"class\", \"force\", \"gas_force\", \"coordination\"]";

fn run(ranks: usize, folder: &Path, more: &[&str]) {
    let (case, output) = (smoke("rank-equality"), folder.display().to_string());
    let mut arguments = vec!["run", &case, "--output", &output, "--until", "1.5"];
    for change in ["output.particles=0.5", "output.series=0.5", CLASSES].iter().chain(more) {
        arguments.extend(["--set", change]);
    }
    let ended = talcum(ranks, &arguments);
    assert_eq!(ended.code(), Some(0), "{ended:?}");
}

/// Numbers of a dataset, snapshot after snapshot.
fn numbers(folder: &Path, name: &str) -> Option<Vec<Vec<f64>>> {
    let file = hdf5::File::open(folder.join("particles.vtkhdf")).unwrap();
    let dataset = file.dataset(&format!("VTKHDF/PointData/{name}")).ok()?;
    let all = dataset.read_raw::<f64>().unwrap();
    let snapshots = file.dataset("VTKHDF/NumberOfPoints").unwrap().size();
    Some(all.chunks_exact(all.len() / snapshots).map(<[f64]>::to_vec).collect())
}

fn column(folder: &Path, name: &str) -> Vec<f64> {
    SeriesTable::read(&folder.join("series.csv")).unwrap().column(name).unwrap().to_vec()
}

#[test]
fn the_fields_of_particles_add_up_to_the_series_on_any_ranks() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    run(0, &place("one"), &[FIELDS]);
    let of = |name: &str| numbers(&place("one"), name).unwrap();
    let (weights, gas) = (column(&place("one"), "weight"), column(&place("one"), "gas_force"));
    let touching = column(&place("one"), "coordination_number");
    let [masses, classes, gas_forces] = ["mass", "class", "gas_force"].map(of);
    let coordination = of("coordination");
    assert_eq!(masses.len(), 4);
    let sphere = |density: f64, diameter: f64| {
        density * std::f64::consts::PI / 6.0 * diameter * diameter * diameter
    };
    let of_class = [sphere(1.0, 1.0), sphere(2.5, 1.0), sphere(0.5, 0.8)];
    for (snapshot, weight) in weights.iter().enumerate() {
        for (mass, class) in masses[snapshot].iter().zip(&classes[snapshot]) {
            assert_eq!(*mass, of_class[*class as usize]);
        }
        // Sums of 400 numbers of one size: rounding.
        let sum: f64 = masses[snapshot].iter().sum();
        assert!((sum / weight - 1.0).abs() < 1e-12);
        let lifted: f64 = gas_forces[snapshot].chunks_exact(3).map(|force| force[2]).sum();
        assert!((lifted / weight - gas[snapshot]).abs() < 1e-12, "{lifted} {}", gas[snapshot]);
        let count = coordination[snapshot].len() as f64;
        let mean = coordination[snapshot].iter().sum::<f64>() / count;
        assert!((mean - touching[snapshot]).abs() < 1e-12);
    }
    assert!(gas[3] > 0.01 && touching[3] > 0.1, "there is something to add up");
    assert!((0..3).all(|class| classes[3].contains(&f64::from(class))));

    run(2, &place("two"), &[FIELDS, "output.compression=4"]);
    let compressed = hdf5::File::open(place("two").join("particles.vtkhdf")).unwrap();
    let first: Vec<i64> =
        compressed.dataset("VTKHDF/Steps/PointOffsets").unwrap().read_raw().unwrap();
    for name in ["mass", "class", "force", "gas_force", "coordination"] {
        let one = of(name);
        let dataset = compressed.dataset(&format!("VTKHDF/PointData/{name}")).unwrap();
        let two: Vec<f64> = dataset.read_raw().unwrap();
        let width = one[0].len() / 400;
        for (snapshot, &row) in first.iter().enumerate() {
            assert_eq!(two[row as usize * width..][..one[snapshot].len()], one[snapshot], "{name}");
        }
    }

    // The control: without a gas there is no force of it, and what is not asked for is not shown.
    run(0, &place("dry"), &["output.particle_fields=[\"gas_force\"]", "gas=off"]);
    let dry = numbers(&place("dry"), "gas_force").unwrap();
    assert!(dry.iter().flatten().all(|&force| force == 0.0));
    assert!(numbers(&place("dry"), "mass").is_none());
}
