//! Fields that only some runs have: agglomerates, rolling springs, custom fields.

use super::{forge, provenance, refusal, share, whole};
use std::path::Path;
use talcum::analysis::Pair;
use talcum::fields::{Field, Kind, Unit};
use talcum::output::checkpoint::{read, write};
use talcum::parallel::{Communicator, OneRank, run_on_threads};

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
