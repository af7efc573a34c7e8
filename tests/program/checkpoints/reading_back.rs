//! Checkpoints come back unchanged on any number of ranks, and the newest intact one is found.

use super::{provenance, share, whole};
use talcum::output::checkpoint::{file_name, newest_good, prune, read, write};
use talcum::parallel::{OneRank, run_on_threads};

#[test]
fn a_checkpoint_is_read_back_on_any_number_of_ranks() {
    let folder = tempfile::tempdir().unwrap();
    for count in [0, 1, 2, 53] {
        let original = whole(vec![share(count, 12, &OneRank)]);
        let digest = original.digest(&OneRank);
        for writers in 1..=3 {
            let path = folder.path().join(file_name(writers as u64));
            let digests = run_on_threads(writers, |ranks| {
                write(&path, &share(count, 12, ranks), &provenance(ranks), ranks).unwrap()
            });
            assert!(digests.iter().all(|&written| written == digest));
            for readers in [1, 2, 3, 5] {
                let shares = run_on_threads(readers, |ranks| {
                    let (checkpoint, provenance, found) = read(&path, ranks).unwrap();
                    assert_eq!((provenance.ranks, found), (writers as u64, digest));
                    assert!(checkpoint.particles.len() <= count as usize / readers + 1);
                    checkpoint
                });
                assert_eq!(
                    whole(shares),
                    original,
                    "{count} particles, {writers} to {readers} ranks"
                );
            }
        }
    }
    assert!(std::fs::read_dir(folder.path()).unwrap().all(|entry| {
        entry.unwrap().path().extension().is_some_and(|extension| extension == "h5")
    }));
}

#[test]
fn a_checkpoint_has_the_same_bytes_from_any_number_of_ranks() {
    let folder = tempfile::tempdir().unwrap();
    let provenance = provenance(&OneRank);
    let files = [1, 2, 3].map(|n| {
        let path = folder.path().join(file_name(n));
        run_on_threads(n as usize, |ranks| {
            write(&path, &share(40, 12, ranks), &provenance, ranks).unwrap();
        });
        std::fs::read(path).unwrap()
    });
    assert!(files[0] == files[1] && files[0] == files[2]);
}

#[test]
fn the_newest_intact_checkpoint_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let path = |step| folder.path().join(file_name(step));
    assert!(newest_good(folder.path(), &OneRank).unwrap().found.is_none());
    for step in [9, 20, 100, 3000, 3001] {
        write(&path(step), &share(5, step, &OneRank), &provenance(&OneRank), &OneRank).unwrap();
    }
    std::fs::write(path(3001), "").unwrap();
    let bytes = std::fs::read(path(3000)).unwrap();
    std::fs::write(path(3000), &bytes[..bytes.len() / 2]).unwrap();
    std::fs::write(folder.path().join("checkpoint-000000009999.h5.partial"), bytes).unwrap();
    std::fs::write(folder.path().join("checkpoint-newest.h5"), "not one of ours").unwrap();
    run_on_threads(2, |ranks| {
        let search = newest_good(folder.path(), ranks).unwrap();
        let (found, checkpoint, ..) = search.found.unwrap();
        assert_eq!((found, checkpoint.clock.step), (path(100), 100));
        let refused: Vec<String> = search.refused.iter().map(ToString::to_string).collect();
        assert!(refused[0].ends_with("checkpoint-000000003001.h5: the file is empty"));
        assert!(refused[1].contains("cut short"));
    });
    run_on_threads(2, |ranks| prune(folder.path(), 3, ranks).unwrap());
    let mut names: Vec<String> = std::fs::read_dir(folder.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(names[..3], [100, 3000, 3001].map(file_name));
    assert_eq!(names[3..], ["checkpoint-newest.h5"]);
}

#[test]
fn a_failed_write_leaves_the_old_checkpoint() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(file_name(1));
    let digest = write(&path, &share(5, 1, &OneRank), &provenance(&OneRank), &OneRank).unwrap();
    std::fs::create_dir(folder.path().join(file_name(1) + ".partial")).unwrap();
    run_on_threads(2, |ranks| {
        let error = write(&path, &share(6, 2, ranks), &provenance(ranks), ranks).unwrap_err();
        assert!(error.to_string().contains(".partial: HDF5 says"), "{error}");
    });
    assert_eq!(read(&path, &OneRank).unwrap().2, digest);
}
