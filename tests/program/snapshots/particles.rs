//! The file of particles.

use std::path::Path;

use super::{check_by_vtk, head, time};
use bytemuck::Zeroable;
use talcum::output::readers::ParticleSnapshotReader;
use talcum::output::{Output, ParticleSnapshots, Provenance};
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
            ..Zeroable::zeroed()
        }
    };
    (0..COUNTS[step]).map(particle).collect()
}

fn append(snapshots: &mut ParticleSnapshots, step: usize, ranks: &dyn Communicator) {
    let mine = particles(step).into_iter().rev().skip(ranks.rank()).step_by(ranks.size());
    snapshots.append(time(step), &mine.collect::<Vec<_>>(), ranks).unwrap();
}

fn provenance(ranks: &dyn Communicator) -> Provenance {
    Provenance::here_and_now("A bed", "dimensionless", ranks)
}

fn write_all(path: &Path, ranks: usize) {
    run_on_threads(ranks, |ranks| {
        let provenance = provenance(ranks);
        let mut snapshots = ParticleSnapshots::create(path, head(&provenance), ranks).unwrap();
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

#[test]
fn vtk_reads_particles_written_on_any_number_of_ranks() {
    let folder = tempfile::tempdir().unwrap();
    for ranks in 1..=3 {
        let path = folder.path().join(format!("particles-{ranks}.vtkhdf"));
        write_all(&path, ranks);
        check(&path);
    }
}

#[test]
fn a_resumed_particle_file_is_that_of_an_uninterrupted_run() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("particles.vtkhdf");
    write_all(&path, 2);
    for (committed, ranks) in [(4, 3), (0, 1), (6, 2)] {
        run_on_threads(ranks, |ranks| {
            let provenance = provenance(ranks);
            let mut snapshots =
                ParticleSnapshots::resume(&path, time(committed), head(&provenance), ranks)
                    .unwrap();
            (committed + 1..COUNTS.len()).for_each(|step| append(&mut snapshots, step, ranks));
            snapshots.commit(ranks).unwrap();
        });
        check(&path);
    }
}

#[test]
fn a_file_damaged_by_a_kill_is_continued_from_its_last_commit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("particles.vtkhdf");
    for ranks in [1, 2] {
        run_on_threads(ranks, |ranks| {
            let provenance = provenance(ranks);
            let mut snapshots = ParticleSnapshots::create(&path, head(&provenance), ranks).unwrap();
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
            let mut snapshots =
                ParticleSnapshots::resume(&path, time(3), head(&provenance), ranks).unwrap();
            (4..COUNTS.len()).for_each(|step| append(&mut snapshots, step, ranks));
        });
        check(&path);
        assert!(!folder.path().join("particles.vtkhdf.unreadable-1").exists());
    }
}

#[test]
fn ids_that_do_not_ascend_are_told_when_snapshots_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("particles.vtkhdf");
    write_all(&path, 1);
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
    write_all(&path, 1);
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    run_on_threads(2, |ranks| {
        let provenance = provenance(ranks);
        let mut snapshots =
            ParticleSnapshots::resume(&path, 0.0, head(&provenance), ranks).unwrap();
        (0..COUNTS.len()).for_each(|step| append(&mut snapshots, step, ranks));
    });
    check(&path);
    assert!(folder.path().join("particles.vtkhdf.unreadable-1").exists());
}
