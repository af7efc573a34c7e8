//! Files that are truncated, damaged, foreign or inconsistent are refused with a message.

use super::{forge, provenance, refusal, share};
use crate::launch::{in_repository, talcum};
use talcum::output::checkpoint::{read, write};
use talcum::parallel::OneRank;

#[test]
fn truncated_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("checkpoint.h5");
    write(&path, &share(5, 12, &OneRank), &provenance(&OneRank), &OneRank).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let lengths = (0..bytes.len()).step_by(311).chain(bytes.len() - 60..bytes.len());
    for length in lengths {
        std::fs::write(&path, &bytes[..length]).unwrap();
        let message = refusal(&path);
        match length {
            0 => assert_eq!(message, "the file is empty"),
            1..8 => assert_eq!(message, "this is not an HDF5 file"),
            _ => assert!(message.contains("cut short"), "{length}: {message}"),
        }
    }
}

#[test]
fn damaged_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("checkpoint.h5");
    write(&path, &share(5, 12, &OneRank), &provenance(&OneRank), &OneRank).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    for place in (0..bytes.len()).step_by(173).chain(bytes.len() - 60..bytes.len()) {
        let mut damaged = bytes.clone();
        damaged[place] ^= 0x10;
        std::fs::write(&path, &damaged).unwrap();
        let message = refusal(&path);
        assert!(
            message.contains("damaged") || message == "this is not an HDF5 file",
            "{place}: {message}"
        );
    }
    let longer = [&bytes[..], b"more"].concat();
    std::fs::write(&path, longer).unwrap();
    assert!(refusal(&path).contains("damaged"));
    std::fs::write(&path, bytes).unwrap();
    read(&path, &OneRank).unwrap();
}

#[test]
fn foreign_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file.h5");
    assert!(refusal(&path).contains("cannot be opened: No such file"));
    assert_eq!(refusal(folder.path()), "this is not a file");
    std::fs::write(&path, "time,height\n0,1\n").unwrap();
    assert_eq!(refusal(&path), "this is not an HDF5 file");
    let file = hdf5::File::create(&path).unwrap();
    file.new_dataset::<f64>().shape([100]).create("x").unwrap();
    file.close().unwrap();
    assert!(refusal(&path).contains("HDF5 file of another program"));
}

#[test]
fn intact_files_with_inconsistent_content_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("checkpoint.h5");
    let forged = |change: fn(&hdf5::File)| {
        write(&path, &share(5, 12, &OneRank), &provenance(&OneRank), &OneRank).unwrap();
        forge(&path, change);
        path.as_path()
    };
    read(forged(|_| ()), &OneRank).unwrap();
    let newer = forged(|file| file.attr("schema_version").unwrap().write_scalar(&8_u64).unwrap());
    assert!(refusal(newer).contains("written by a newer Talcum"));
    let none = forged(|file| file.attr("schema_version").unwrap().write_scalar(&0_u64).unwrap());
    assert!(refusal(none).contains("its schema is 0, which no Talcum has written"));
    let moved = forged(|file| {
        let mass = file.dataset("particles/mass").unwrap();
        let mut masses = mass.read_raw::<f64>().unwrap();
        masses[2] += 1.0e-15;
        mass.write_raw(&masses).unwrap();
    });
    assert!(refusal(moved).contains("the state's digest is"));
    let without = forged(|file| file.unlink("contacts/lower").unwrap());
    assert!(refusal(without).contains("/contacts/lower"));
    let stranger = forged(|file| file.group("/").unwrap().delete_attr("format").unwrap());
    assert!(refusal(stranger).contains("not a checkpoint"), "{}", refusal(stranger));
    let earlier = forged(|file| {
        file.group("clock").unwrap().attr("origin_step").unwrap().write_scalar(&99_u64).unwrap();
    });
    assert!(refusal(earlier).contains("origin lies after"));
}

#[test]
fn cells_beyond_the_grid_of_the_gas_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("checkpoint.h5");
    // Digests of version 2 are not compared.
    std::fs::copy(in_repository("tests/program/checkpoints/version-2.h5"), &path).unwrap();
    forge(&path, |file| {
        let cells = file.dataset("gas/cell").unwrap();
        let mut numbers = cells.read_raw::<u64>().unwrap();
        numbers[3] = 268_435_746;
        cells.write_raw(&numbers).unwrap();
    });
    let results = folder.path().join("results").display().to_string();
    let ended = talcum(2, &["restart", &path.display().to_string(), "--output", &results]);
    assert_eq!(ended.code(), Some(1), "{}", ended.errors);
    assert!(
        ended.errors.contains("cell 268435746 of the gas, and the grid 16 cells"),
        "{}",
        ended.errors
    );
}
