//! The file of gas snapshots.

use super::{check_by_vtk, head, time};
use nalgebra::Vector3;
use std::path::Path;
use talcum::domain::{Bounds, Face};
use talcum::grid::BoxGrid;
use talcum::output::{GasSnapshots, Output, Provenance, SnapshotStorage};
use talcum::parallel::{CellSample, Communicator, run_on_threads};

const COUNTS: [usize; 3] = [2, 3, 5];
const STEPS: usize = 4;

fn grid() -> BoxGrid {
    let bounds = Bounds::new(Vector3::new(0.5, 1.5, 5.0), [[Face::Periodic; 2]; 3]);
    BoxGrid::new(&bounds, COUNTS)
}

fn cells(step: usize) -> Vec<CellSample> {
    let number = |cell: u64, k: usize| ((cell as f64) + 0.1 * step as f64) / (k as f64 - 3.5);
    let cell = |cell: u64| CellSample {
        cell,
        pressure: number(cell, 0),
        velocity: [1, 2, 3].map(|k| number(cell, k)),
        voidage: number(cell, 4),
        open_fraction: 1.0,
        solids_velocity: [5, 6, 7].map(|k| number(cell, k)),
    };
    (0..COUNTS.iter().product::<usize>() as u64).map(cell).collect()
}

fn provenance(ranks: &dyn Communicator) -> Provenance {
    Provenance::here_and_now("A gas", "dimensionless", ranks)
}

fn append(snapshots: &mut GasSnapshots, step: usize, ranks: &dyn Communicator) {
    let mine = cells(step).into_iter().rev().skip(ranks.rank()).step_by(ranks.size());
    snapshots.append(time(step), &mine.collect::<Vec<_>>(), ranks).unwrap();
}

fn write_all(path: &Path, storage: SnapshotStorage, ranks: usize) {
    run_on_threads(ranks, |ranks| {
        let provenance = provenance(ranks);
        let (fields, head) = ((&grid(), storage), head(&provenance));
        let mut snapshots = GasSnapshots::open(path, fields, head, None, ranks).unwrap();
        for step in 0..STEPS {
            append(&mut snapshots, step, ranks);
            if step == 2 {
                snapshots.commit(ranks).unwrap();
            }
        }
    });
}

fn check(path: &Path) {
    let row = |step: usize, record: CellSample| {
        let CellSample { pressure, velocity, voidage, solids_velocity, .. } = record;
        [&[time(step), pressure][..], &velocity, &[voidage], &solids_velocity].concat()
    };
    let rows = (0..STEPS).flat_map(|step| cells(step).into_iter().map(move |cell| row(step, cell)));
    check_by_vtk(path, rows, "4 times, cells (3, 4, 6), spacing (0.25, 0.5, 1.0)");
}

/// As they are without a wish, and compressed.
fn storages() -> [SnapshotStorage; 2] {
    [0, 6].map(|compression| SnapshotStorage { compression, ..SnapshotStorage::default() })
}

#[test]
fn vtk_reads_gas_written_on_any_number_of_ranks() {
    let folder = tempfile::tempdir().unwrap();
    for (storage, ranks) in storages().into_iter().flat_map(|s| (1..=3).map(move |n| (s, n))) {
        let path = folder.path().join(format!("gas-{}-{ranks}.vtkhdf", storage.compression));
        write_all(&path, storage, ranks);
        check(&path);
    }
}

#[test]
fn a_resumed_gas_file_is_that_of_an_uninterrupted_run() {
    for storage in storages() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("gas.vtkhdf");
        write_all(&path, storage, 2);
        for (committed, ranks) in [(1, 3), (0, 1)] {
            run_on_threads(ranks, |ranks| {
                let (grid, provenance) = (grid(), provenance(ranks));
                let (time, head) = (Some(time(committed)), head(&provenance));
                let mut snapshots =
                    GasSnapshots::open(&path, (&grid, storage), head, time, ranks).unwrap();
                (committed + 1..STEPS).for_each(|step| append(&mut snapshots, step, ranks));
                snapshots.commit(ranks).unwrap();
            });
            check(&path);
        }
    }
}
