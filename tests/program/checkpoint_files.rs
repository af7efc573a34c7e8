//! Checkpoints are read back unchanged on any number of ranks, and anything else is rejected with a message.

use std::path::Path;

use crate::launch::{in_repository, talcum};
use bytemuck::Zeroable;
use hdf5::types::VarLenUnicode;
use talcum::analysis::Pair;
use talcum::fields::{Field, Kind, Unit};
use talcum::output::Provenance;
use talcum::output::checkpoint::{Checkpoint, file_name, newest_good, prune, read, write};
use talcum::parallel::{
    CellRecord, Communicator, ContactRecord, OneRank, ParticleRecord, WallContactRecord,
    run_on_threads,
};
use talcum::particles::{ContactState, CustomFields};
use talcum::state::{Clock, Departed, GasReport, SizeRange};
use xxhash_rust::xxh3::xxh3_128;

/// A state of so many particles, of which this rank has every n-th.
fn share(count: u64, step: u64, ranks: &dyn Communicator) -> Checkpoint {
    let mine = |id: &u64| (id + 1) % ranks.size() as u64 == ranks.rank() as u64;
    let particle = |id| {
        let x = id as f64 / 3.0;
        let mut particle: ParticleRecord = Zeroable::zeroed();
        bytemuck::cast_slice_mut::<_, f64>(std::slice::from_mut(&mut particle)).fill(x);
        let species = (id / 10 % 2) as f64;
        let particle = ParticleRecord { id, velocity: [-x, 1.0e-300, -0.0], species, ..particle };
        without_agglomerate(particle)
    };
    let spring = [1.0e-9, -2.0e-9, 0.0];
    let contact = |k: u64| ContactRecord {
        lower: 7 * (k / 3),
        higher: 7 * (k / 3) + 3 - k % 3,
        state: ContactState {
            tangential_spring: spring,
            largest_overlap: k as f64,
            rolling_angle: if k.is_multiple_of(2) { [0.0; 3] } else { [0.1, -0.2, 0.3] },
            twisting_angle: if k.is_multiple_of(3) { 0.0 } else { 0.02 },
        },
    };
    let wall_contact = |k| WallContactRecord {
        particle: k / 2,
        wall: 1 - k % 2,
        state: ContactState {
            tangential_spring: spring,
            largest_overlap: 0.1,
            rolling_angle: [0.0, 0.01, 0.0],
            twisting_angle: -0.03,
        },
    };
    let cell = |cell: u64| CellRecord {
        cell,
        lower_velocity: [0.0, 1.0 / 3.0, 2.0 / 3.0],
        upper_velocity: [1.0, 4.0 / 3.0, 5.0 / 3.0],
        pressure: 2.0,
        voidage: 7.0 / 3.0,
    };
    Checkpoint {
        clock: Clock { step, origin_time: 0.1, origin_step: 1, time_step: 2.5e-4 },
        departed: Departed { count: 2, volume: 1.04 },
        sizes: SizeRange { smallest_diameter: 0.8, largest_diameter: 1.2, largest_mass: 1.7 },
        case_text: "title = \"Grüße\"\n".repeat(if count > 5 { 6000 } else { 1 }),
        case_folder: "/some/where".to_owned(),
        particles: (0..count).map(|k| k * 10).filter(mine).map(particle).collect(),
        custom: CustomFields::default(),
        contacts: (0..count / 2).filter(mine).map(contact).collect(),
        wall_contacts: (0..count / 4).filter(mine).map(wall_contact).collect(),
        cells: (0..count / 3).filter(mine).map(cell).collect(),
        gas_report: GasReport {
            iterations: 7,
            raised_cells: 1,
            courant: 0.2,
            momentum_error: 1.0e-12,
        },
        looked_at: None,
        energy: None,
        instruments: Vec::new(),
    }
}

/// The record of a particle whose drag does not follow from an agglomerate.
fn without_agglomerate(particle: ParticleRecord) -> ParticleRecord {
    ParticleRecord {
        agglomerate_diameter: 0.0,
        agglomerate_packing: 0.0,
        drag_factor: 0.0,
        ..particle
    }
}

fn provenance(ranks: &dyn Communicator) -> Provenance {
    Provenance::here_and_now("A bed", "dimensionless", ranks)
}

/// All ranks' shares as one, sorted.
fn whole(shares: Vec<Checkpoint>) -> Checkpoint {
    let mut shares = shares.into_iter();
    let mut whole = shares.next().unwrap();
    for share in shares {
        assert_eq!(
            (share.clock, share.departed, share.sizes),
            (whole.clock, whole.departed, whole.sizes)
        );
        assert_eq!(share.case_text, whole.case_text);
        whole.particles.extend(share.particles);
        whole.contacts.extend(share.contacts);
        whole.wall_contacts.extend(share.wall_contacts);
        whole.cells.extend(share.cells);
    }
    whole.particles.sort_by_key(|particle| particle.id);
    whole.contacts.sort_by_key(|contact| (contact.lower, contact.higher));
    whole.wall_contacts.sort_by_key(|contact| (contact.particle, contact.wall));
    whole.cells.sort_by_key(|cell| cell.cell);
    whole
}

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

/// The words in which a file is refused, the same on two ranks.
fn refusal(path: &Path) -> String {
    let refusals = run_on_threads(2, |ranks| read(path, ranks).map(|_| "read").unwrap_err());
    assert_eq!(refusals[0], refusals[1]);
    assert_eq!(refusals[0].path, path);
    refusals[0].message.clone()
}

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

/// Changes a checkpoint in a way that no damage could, and appends its checksum again.
pub(crate) fn forge(path: &Path, change: impl FnOnce(&hdf5::File)) {
    let bytes = std::fs::read(path).unwrap();
    std::fs::write(path, &bytes[..bytes.len() - 40]).unwrap();
    let file = hdf5::File::open_rw(path).unwrap();
    change(&file);
    file.close().unwrap();
    let mut bytes = std::fs::read(path).unwrap();
    let length = bytes.len() as u64;
    assert!(length < 1 << 22, "one block");
    let hash = xxh3_128(&xxh3_128(&bytes).to_be_bytes());
    bytes.extend_from_slice(b"\nTalcum seal  2\n");
    bytes.extend_from_slice(&length.to_le_bytes());
    bytes.extend_from_slice(&hash.to_be_bytes());
    std::fs::write(path, bytes).unwrap();
}

#[test]
fn agglomerates_are_in_checkpoints_where_drag_follows_from_them_alone() {
    let folder = tempfile::tempdir().unwrap();
    let groups = |path: &Path| {
        let file = hdf5::File::open(path).unwrap();
        ["looked_at", "particles/drag_factor"].map(|name| file.link_exists(name))
    };
    let written = |name: &str, ranks: usize, pairs: Option<u64>| {
        let path = folder.path().join(name);
        run_on_threads(ranks, |ranks| {
            let mut share = share(40, 12, ranks);
            let mine = |pair: &Pair| pair.higher % ranks.size() as u64 == ranks.rank() as u64;
            share.looked_at = pairs.map(|count| {
                (0..count).map(|k| Pair { lower: k % 7, higher: 100 + k }).filter(mine).collect()
            });
            if pairs.is_some() {
                share.particles.iter_mut().for_each(|it| it.drag_factor = 0.2 + it.mass);
            }
            write(&path, &share, &provenance(ranks), ranks).unwrap();
        });
        path
    };
    let path = written("with", 3, Some(20));
    assert_eq!(groups(&path), [true, true]);
    for ranks in [1, 2, 4] {
        let shares = run_on_threads(ranks, |ranks| read(&path, ranks).unwrap().0);
        let pairs = shares.iter().flat_map(|share| share.looked_at.clone().unwrap());
        let pairs: Vec<Pair> = pairs.collect();
        assert!(pairs.len() == 20 && pairs.is_sorted_by(|a, b| a < b), "{pairs:?}");
        let mut particles = shares.iter().flat_map(|share| &share.particles);
        assert!(particles.all(|it| it.drag_factor == 0.2 + it.mass && it.species <= 1.0));
    }
    // None yet, but a look: the next one must know.
    let none = read(&written("none", 2, Some(0)), &OneRank).unwrap().0;
    assert_eq!(none.looked_at, Some(Vec::new()));
    // The control: files of other runs have neither.
    let path = written("without", 2, None);
    assert_eq!(groups(&path), [false, false]);
    assert_eq!(read(&path, &OneRank).unwrap().0.looked_at, None);
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

/// The digest of each file in `checkpoints`, one for each version of the schema, and of the run that continues from it to t = 2.5;
/// commit c075153 found them, whose program wrote the files of versions 4 to 6. Those of versions 1 to 3 were made from its files by
/// taking away what later versions brought.
const OLD_FILES: [[&str; 2]; 6] = [
    ["70e45156e11fc25bdbcf23b01b4af4a4", "31e8439719fb6e0ce61321017154a0eb"],
    ["31b736eb016e45f444c008c212ef2849", "9d6b7ca2103c46ad7738fac0be85f9cc"],
    ["31b736eb016e45f444c008c212ef2849", "9d6b7ca2103c46ad7738fac0be85f9cc"],
    ["1eda81a9dad360cab7d1bccee71707d8", "afd9b17e8e794ecbbcb3979dc5122bb7"],
    ["e66fcf33321117df8cb672c855daae08", "82cd92a1d1b7bc59e01aef72a9562e5b"],
    ["0ea1cb43921dda58c4ba53e45763fb26", "a840f2833abb111090d6ed22567cb028"],
];

#[test]
fn files_of_all_schema_versions_restart() {
    let folder = tempfile::tempdir().unwrap();
    for (digests, version) in OLD_FILES.iter().zip(1..) {
        let file = in_repository(&format!("tests/program/checkpoints/version-{version}.h5"));
        let (found, _, digest) = read(&file, &OneRank).unwrap();
        assert_eq!((digest.to_string().as_str(), found.particles.len()), (digests[0], 24));
        assert_eq!(found.looked_at.is_some(), version == 6);
        let results = folder.path().join(version.to_string()).display().to_string();
        let ended = talcum(
            version % 2,
            &[
                "restart",
                &file.display().to_string(),
                "--output",
                &results,
                "--set",
                "time.end=2.5",
            ],
        );
        assert_eq!(ended.digest(), digests[1], "version {version}");
    }
}

#[test]
fn a_checkpoint_whose_case_has_a_former_name_restarts() {
    let folder = tempfile::tempdir().unwrap();
    let in_folder = |name: &str| folder.path().join(name).display().to_string();
    let case = in_repository("tests/cases/good/adhesive-elastic-plastic.toml");
    let case = case.display().to_string();
    talcum(1, &["run", &case, "--until", "0.05", "--output", &in_folder("first")]).digest();
    let (first, ..) = newest_good(Path::new(&in_folder("first")), &OneRank).unwrap().found.unwrap();
    let restarted = |output: &str, more: &[&str]| {
        let (file, output) = (first.display().to_string(), in_folder(output));
        let restart = ["restart", &file, "--until", "0.06", "--output", &output];
        talcum(1, &[&restart, more].concat())
    };
    let expected = restarted("present", &[]).digest();
    forge(&first, |file| {
        let text = file.attr("case").unwrap().read_scalar::<VarLenUnicode>().unwrap();
        let former: VarLenUnicode =
            text.replace("adhesion_over_weight", "bond_number").parse().unwrap();
        assert_ne!(former, text, "the control: the name is in it");
        file.attr("case").unwrap().write_scalar(&former).unwrap();
        let hash: VarLenUnicode =
            blake3::hash(former.as_bytes()).to_hex().to_string().parse().unwrap();
        file.attr("case_blake3").unwrap().write_scalar(&hash).unwrap();
    });
    assert_eq!(restarted("former", &[]).digest(), expected);
    // What the user writes now is another matter.
    let refused = restarted("set", &["--set", "contact.bond_number=10"]);
    assert!(refused.errors.contains("is now contact.adhesion_over_weight"), "{}", refused.errors);
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

#[test]
fn fields_that_are_zero_take_no_dataset_and_those_that_are_not_must_be_there() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("checkpoint.h5");
    let mut state = share(20, 12, &OneRank);
    write(&path, &state, &provenance(&OneRank), &OneRank).unwrap();
    let names = |group: &str| {
        hdf5::File::open(&path).unwrap().group(group).unwrap().member_names().unwrap()
    };
    let optional = ["rolling_angle", "twisting_angle"];
    assert!(optional.iter().all(|name| names("contacts").iter().any(|other| other == name)));
    for name in optional {
        forge(&path, |file| file.group("contacts").unwrap().unlink(name).unwrap());
        assert!(refusal(&path).contains("the state's digest is"), "{name}");
        write(&path, &state, &provenance(&OneRank), &OneRank).unwrap();
    }
    for contact in &mut state.contacts {
        (contact.state.rolling_angle, contact.state.twisting_angle) = ([0.0; 3], 0.0);
    }
    state.particles.iter_mut().for_each(|particle| particle.species = 0.0);
    let digest = write(&path, &state, &provenance(&OneRank), &OneRank).unwrap();
    assert!(!optional.iter().any(|name| names("contacts").iter().any(|other| other == name)));
    assert!(!names("particles").iter().any(|name| name == "species"));
    assert!(names("wall_contacts").iter().any(|name| name == "rolling_angle"), "the control");
    let (found, _, found_digest) = read(&path, &OneRank).unwrap();
    assert_eq!((found_digest, whole(vec![found])), (digest, whole(vec![state])));
}

#[test]
fn custom_fields_come_back_on_any_number_of_ranks_and_are_part_of_the_digest() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("checkpoint.h5");
    let temperature = Field::new("temperature", Kind::Number, Unit::Named("K"), "temperature");
    let director = Field::new("director", Kind::Vector, Unit::One, "direction of an axis");
    let with_fields = |ranks: &dyn Communicator| {
        let mut share = share(40, 12, ranks);
        let of_each = |number: fn(f64) -> f64| -> Vec<f64> {
            share.particles.iter().map(|particle| number(particle.id as f64)).collect()
        };
        let (kelvins, axes) = (of_each(|id| 300.0 + id), of_each(|id| 0.1 * id));
        share.custom.push(temperature, &kelvins);
        share.custom.push(director, &axes.iter().flat_map(|x| [*x, 0.0, -x]).collect::<Vec<f64>>());
        share
    };
    let without = write(&path, &share(40, 12, &OneRank), &provenance(&OneRank), &OneRank).unwrap();
    let digests = run_on_threads(3, |ranks| {
        write(&path, &with_fields(ranks), &provenance(ranks), ranks).unwrap()
    });
    assert!(digests.iter().all(|digest| *digest == digests[0] && *digest != without));
    for ranks in [1, 2, 4] {
        let shares = run_on_threads(ranks, |ranks| read(&path, ranks).unwrap());
        for (found, _, digest) in shares {
            assert_eq!(digest, digests[0]);
            let fields: Vec<_> =
                found.custom.fields.iter().map(|field| (field.name, field.width())).collect();
            assert_eq!(fields, [("director", 3), ("temperature", 1)]);
            for (index, particle) in found.particles.iter().enumerate() {
                let id = particle.id as f64;
                assert_eq!(found.custom.row(index), [0.1 * id, 0.0, -0.1 * id, 300.0 + id]);
            }
        }
    }
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
