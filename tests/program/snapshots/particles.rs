//! The file of particle snapshots.

use std::path::Path;

use super::{check_by_vtk, head, time};
use bytemuck::Zeroable;
use talcum::fields::{Column, Kind, Unit};
use talcum::output::readers::ParticleSnapshotReader;
use talcum::output::{
    Output, ParticleSnapshots, PointColumn, Provenance, SnapshotFormat, SnapshotStorage,
};
use talcum::parallel::{Communicator, ParticleRecord, run_on_threads};

/// Particles at each of the times 0, 0.1, ...; some times have none, most another number.
const COUNTS: [u64; 7] = [5, 3, 0, 1, 4000, 7, 7];

fn particles(step: usize) -> Vec<ParticleRecord> {
    let particle = |k: u64| {
        let x = (k as f64 + 0.1 * step as f64) / 3.0;
        ParticleRecord {
            id: 5 * k + 1,
            position: [x, 1.0e-9 * x, -x],
            velocity: [0.1, x, 1.0e-3],
            angular_velocity: [-0.2 * x, 0.3, 0.0],
            radius: 0.5 + x,
            mass: 7.0 - x,
            ..Zeroable::zeroed()
        }
    };
    (0..COUNTS[step]).map(particle).collect()
}

fn append(snapshots: &mut ParticleSnapshots, step: usize, ranks: &dyn Communicator) {
    let mine = particles(step).into_iter().rev().skip(ranks.rank()).step_by(ranks.size());
    let mine: Vec<ParticleRecord> = mine.collect();
    let columns = [
        mine.iter().map(|particle| particle.mass).collect(),
        mine.iter().flat_map(|particle| particle.velocity.map(|v| 2.0 * v)).collect(),
        mine.iter().map(|particle| particle.id as f64 - 3.0).collect(),
    ];
    let shown = &columns[..snapshots.format().columns.len()];
    snapshots.append(time(step), &mine, shown, ranks).unwrap();
}

/// Mass, a vector and a whole number beside what is always shown.
fn columns() -> Vec<PointColumn> {
    let (unit, meaning) = (Unit::One, "of a test");
    vec![
        Column::of_kind("mass", Kind::Number, unit, meaning),
        Column::of_kind("force", Kind::Vector, unit, meaning),
        Column::of_kind("class", Kind::Integer, unit, meaning),
    ]
}

fn compressed() -> SnapshotFormat {
    let storage = SnapshotStorage { compression: 6, ..SnapshotStorage::default() };
    SnapshotFormat { columns: columns(), storage }
}

/// As it is without a wish, and compressed with further columns.
fn formats() -> [SnapshotFormat; 2] {
    [SnapshotFormat::default(), compressed()]
}

fn provenance(ranks: &dyn Communicator) -> Provenance {
    Provenance::here_and_now("A bed", "dimensionless", ranks)
}

fn write_all(path: &Path, format: &SnapshotFormat, ranks: usize) {
    run_on_threads(ranks, |ranks| {
        let provenance = provenance(ranks);
        let mut snapshots =
            ParticleSnapshots::open(path, format, head(&provenance), None, ranks).unwrap();
        (0..COUNTS.len()).for_each(|step| append(&mut snapshots, step, ranks));
        snapshots.commit(ranks).unwrap();
    });
}

fn check(path: &Path) {
    let row = |step: usize, particle: ParticleRecord| {
        let ParticleRecord { id, position, velocity, angular_velocity, radius, .. } = particle;
        let ahead = [time(step), id as f64];
        [&ahead[..], &position, &velocity, &angular_velocity, &[radius]].concat()
    };
    let steps = 0..COUNTS.len();
    let rows =
        steps.flat_map(|step| particles(step).into_iter().map(move |particle| row(step, particle)));
    check_by_vtk(path, rows, "7 times, 1 of them without particles");
}

/// What is beside that, read back without VTK.
fn check_columns(path: &Path, format: &SnapshotFormat) {
    let reader = ParticleSnapshotReader::open(path).unwrap();
    for step in 0..COUNTS.len() {
        let found = reader.snapshot(step).unwrap();
        let expected = particles(step);
        assert_eq!(found.ids, expected.iter().map(|particle| particle.id).collect::<Vec<_>>());
        let masses: Vec<f64> = expected.iter().map(|particle| particle.mass).collect();
        assert_eq!(found.masses, (!format.columns.is_empty()).then_some(masses));
    }
    if format.columns.is_empty() {
        return;
    }
    let file = hdf5::File::open(path).unwrap();
    let first = file.dataset("VTKHDF/Steps/PointOffsets").unwrap().read_raw::<i64>().unwrap();
    let classes = file.dataset("VTKHDF/PointData/class").unwrap().read_raw::<i64>().unwrap();
    let forces = file.dataset("VTKHDF/PointData/force").unwrap().read_raw::<f64>().unwrap();
    for (step, &first) in first.iter().enumerate() {
        for (row, particle) in particles(step).iter().enumerate() {
            let row = first as usize + row;
            assert_eq!(classes[row], particle.id as i64 - 3);
            assert_eq!(forces[3 * row..][..3], particle.velocity.map(|v| 2.0 * v));
        }
    }
}

#[test]
fn vtk_reads_particles_written_on_any_number_of_ranks() {
    let folder = tempfile::tempdir().unwrap();
    for (number, format) in formats().iter().enumerate() {
        for ranks in 1..=3 {
            let path = folder.path().join(format!("particles-{number}-{ranks}.vtkhdf"));
            write_all(&path, format, ranks);
            check(&path);
            check_columns(&path, format);
        }
    }
}

#[test]
fn a_resumed_particle_file_is_that_of_an_uninterrupted_run() {
    for format in &formats() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("particles.vtkhdf");
        write_all(&path, format, 2);
        for (committed, ranks) in [(4, 3), (0, 1), (6, 2)] {
            run_on_threads(ranks, |ranks| {
                let provenance = provenance(ranks);
                let (time, head) = (time(committed), head(&provenance));
                let mut snapshots =
                    ParticleSnapshots::open(&path, format, head, Some(time), ranks).unwrap();
                (committed + 1..COUNTS.len()).for_each(|step| append(&mut snapshots, step, ranks));
                snapshots.commit(ranks).unwrap();
            });
            check(&path);
            check_columns(&path, format);
        }
    }
}

#[test]
fn a_file_damaged_by_a_kill_is_continued_from_its_last_commit() {
    for (format, ranks) in formats().iter().flat_map(|format| [(format, 1), (format, 2)]) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("particles.vtkhdf");
        run_on_threads(ranks, |ranks| {
            let provenance = provenance(ranks);
            let mut snapshots =
                ParticleSnapshots::open(&path, format, head(&provenance), None, ranks).unwrap();
            (0..4).for_each(|step| append(&mut snapshots, step, ranks));
            snapshots.commit(ranks).unwrap();
            (4..COUNTS.len()).for_each(|step| append(&mut snapshots, step, ranks));
        });
        // Its head did not reach the disk.
        let mut damaged = std::fs::read(&path).unwrap();
        damaged[..4096].fill(0);
        std::fs::write(&path, &damaged).unwrap();
        run_on_threads(ranks, |ranks| {
            let provenance = provenance(ranks);
            let (time, head) = (time(3), head(&provenance));
            let mut snapshots =
                ParticleSnapshots::open(&path, format, head, Some(time), ranks).unwrap();
            (4..COUNTS.len()).for_each(|step| append(&mut snapshots, step, ranks));
        });
        check(&path);
        check_columns(&path, format);
        assert!(!folder.path().join("particles.vtkhdf.unreadable-1").exists());
    }
}

#[test]
fn a_file_continues_as_it_was_begun_and_one_that_shows_more_is_set_aside() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("particles.vtkhdf");
    let resume = |format: &SnapshotFormat| {
        run_on_threads(2, |ranks| {
            let provenance = provenance(ranks);
            let (time, head) = (time(4), head(&provenance));
            let mut snapshots =
                ParticleSnapshots::open(&path, format, head, Some(time), ranks).unwrap();
            (5..COUNTS.len()).for_each(|step| append(&mut snapshots, step, ranks));
        });
    };
    write_all(&path, &compressed(), 2);
    let plain = SnapshotFormat { columns: columns(), ..SnapshotFormat::default() };
    resume(&plain);
    check(&path);
    check_columns(&path, &plain);
    let aside = folder.path().join("particles.vtkhdf.unreadable-1");
    assert!(!aside.exists());
    resume(&SnapshotFormat::default());
    assert!(aside.exists());
}

#[test]
fn single_precision_and_compression_make_files_smaller() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, single_precision, compression| {
        let path = folder.path().join(name);
        let storage = SnapshotStorage { single_precision, compression };
        write_all(&path, &SnapshotFormat { columns: Vec::new(), storage }, 2);
        let bytes = std::fs::metadata(&path).unwrap().len() as f64;
        let snapshot = ParticleSnapshotReader::open(&path).unwrap().snapshot(4).unwrap();
        (bytes, snapshot.positions)
    };
    let (whole, exact) = write("double", false, 0);
    let (half, rounded) = write("single", true, 0);
    let (packed, same) = write("packed", false, 4);
    assert_eq!(same, exact);
    assert!(packed < 0.6 * whole, "{packed} of {whole}");
    // Ten numbers of 4 bytes in place of 8, the id as it was: 48 of 88, beside pieces that are not full.
    assert!(half < 0.7 * whole, "{half} of {whole}");
    assert_ne!(rounded, exact);
    for (rounded, exact) in rounded.iter().flatten().zip(exact.iter().flatten()) {
        // Half of the last of 24 bits.
        assert!((rounded - exact).abs() <= 2.0_f64.powi(-24) * exact.abs());
    }
}

#[test]
fn ids_that_do_not_ascend_are_reported_when_snapshots_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("particles.vtkhdf");
    write_all(&path, &SnapshotFormat::default(), 1);
    let last = COUNTS.len() - 1;
    let read = || ParticleSnapshotReader::open(&path).unwrap().snapshot(last);
    assert!(read().is_ok());
    {
        let file = hdf5::File::open_rw(&path).unwrap();
        let dataset = file.dataset("VTKHDF/PointData/id").unwrap();
        let mut ids = dataset.read_raw::<i64>().unwrap();
        *ids.last_mut().unwrap() = -1;
        dataset.write_raw(&ids).unwrap();
    }
    let error = read().unwrap_err().to_string();
    assert!(error.contains("particles.vtkhdf: the ids at time"), "{error}");
}

#[test]
fn an_unreadable_particle_file_is_set_aside() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("particles.vtkhdf");
    write_all(&path, &SnapshotFormat::default(), 1);
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    run_on_threads(2, |ranks| {
        let provenance = provenance(ranks);
        let (format, head) = (SnapshotFormat::default(), head(&provenance));
        let mut snapshots =
            ParticleSnapshots::open(&path, &format, head, Some(0.0), ranks).unwrap();
        (0..COUNTS.len()).for_each(|step| append(&mut snapshots, step, ranks));
    });
    check(&path);
    assert!(folder.path().join("particles.vtkhdf.unreadable-1").exists());
}
