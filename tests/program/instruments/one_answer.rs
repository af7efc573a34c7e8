//! Instruments change no bit of a run, and their results have the same bits on any number of ranks and after restarts.

use super::{Part, assert_same, case, contents, remove_newest_checkpoint, run};
use crate::launch::{in_repository, talcum};
use std::collections::BTreeMap;
use std::path::Path;
use talcum::case::Case;
use talcum::output::InstrumentResults;

/// A cohesive, vibrated bed with a column gas, without instruments.
fn column_bed() -> String {
    let text = std::fs::read_to_string(in_repository("cases/smoke/rank-equality.toml")).unwrap();
    let text =
        text.replace("count = 400", "count = 200").replace("frequency = 0.16", "frequency = 8.0");
    text.replace("normal_stiffness = 2.0e5", "normal_stiffness = 2.0e4")
}

const INSTRUMENTS: &str = r#"
[measure.coordination]
kind = "coordination"
every = 0.01
average = 0.08
[measure.stress]
kind = "stress"
every = 0.02
average = 0.1
[measure.wave]
kind = "stress"
every = 0.02
average = 0.16
frame = "wave"
wave_speed = 1.5
wavelength = 10.0
layers = 10
[measure.phase]
kind = "stress"
every = 0.02
average = 0.5
frame = "phase"
phases = 5
[measure.wave_by_phase]
kind = "stress"
every = 0.02
average = 0.5
frame = "wave"
wave_speed = 1.5
wavelength = 10.0
phases = 5
layers = 10
[measure.cells]
kind = "stress"
every = 0.02
average = 0.1
cells = [2, 3, 8]
[measure.cycle]
kind = "phase_average"
every = 0.01
phases = 10
cycles = 2
start = 0.05
[measure.agglomerates]
kind = "agglomerates"
every = 0.05
window = 0.15
smallest = 3
persistence = "every_look"
[measure.contacts]
kind = "contacts"
every = 0.03
write = 0.12
[measure.mixing]
kind = "mixing"
every = 0.03
window = 0.15
tracers = "region"
lower_corner = [0.0, 0.0, 0.0]
upper_corner = [5.1, 5.1, 4.0]
cells = [2, 2, 4]
least = 2
[measure.plane]
kind = "probe"
every = 0.01
average = 0.07
at = "plane"
axis = "z"
position = 3.0
[measure.average]
kind = "time_average"
every = 0.01
average = 0.09
"#;

/// A bed with a volume-averaged gas.
fn fluidised_bed() -> String {
    std::fs::read_to_string(in_repository("cases/smoke/fluidised.toml")).unwrap()
}

const INSTRUMENTS_OF_GAS: &str = r#"
[measure.clusters]
kind = "clusters"
every = 2.0e-5
threshold = 0.4
smallest = 2
[measure.average]
kind = "time_average"
every = 1.0e-5
average = 7.0e-5
[measure.point]
kind = "probe"
every = 1.0e-5
average = 4.0e-5
at = "point"
point = [2.4e-4, 2.4e-4, 3.0e-4]
radius = 6.0e-5
[measure.plane]
kind = "probe"
every = 2.0e-5
at = "plane"
axis = "z"
position = 3.0e-4
"#;

/// Runs a case on 1 to 4 ranks and through a restart after a kill; all files of instruments must be the same, and
/// the digest must be that of the case without instruments.
fn check(base: &str, instruments: &str, end: f64) {
    let every = format!("checkpoint.every={}", 0.3 * end);
    let plain = case(&Case::text_with(base, "case.toml", &[every]).unwrap());
    let measured = case(&format!("{}\n{instruments}", plain.text));
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    let expected = run(&plain, &place("plain"), &Part { ranks: 1, resume: false, until: end });
    let whole = Part { ranks: 1, resume: false, until: end };
    assert_eq!(run(&measured, &place("1"), &whole), expected);
    let of_one = contents(&place("1"));
    assert!(of_one.len() > 20 && contents(&place("plain")).is_empty());
    for ranks in 2..=4 {
        let place = place(&ranks.to_string());
        assert_eq!(run(&measured, &place, &Part { ranks, ..whole }), expected);
        assert_same(&contents(&place), &of_one, &format!("{ranks} ranks"));
    }
    // Killed at 0.75 of the run, of which the checkpoint at 0.6 is left.
    let place = place("resumed");
    run(&measured, &place, &Part { ranks: 2, resume: false, until: 0.75 * end });
    remove_newest_checkpoint(&place);
    let rest = Part { ranks: 3, resume: true, until: end };
    assert_eq!(run(&measured, &place, &rest), expected);
    assert_same(&contents(&place), &of_one, "restart");
    // The control: the files have rows, and another run has others.
    for plan in &measured.instruments {
        let results = InstrumentResults::read(&place.join(&plan.file_names()[0])).unwrap();
        assert!(results.times.len() > 1, "{}: {} rows", plan.name, results.times.len());
    }
    let other = case(&measured.text.replacen("seed = ", "seed = 1", 1));
    let place = folder.path().join("other");
    run(&other, &place, &whole);
    assert_ne!(contents(&place), of_one);
}

#[test]
fn instruments_of_particles_are_the_same_on_any_ranks_and_through_restarts() {
    check(&column_bed(), INSTRUMENTS, 1.2);
}

#[test]
fn instruments_of_a_gas_are_the_same_on_any_ranks_and_through_restarts() {
    check(&fluidised_bed(), INSTRUMENTS_OF_GAS, 3.0e-4);
}

#[test]
fn the_program_gives_the_same_results_under_mpirun() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name).display().to_string();
    let path = folder.path().join("case.toml");
    std::fs::write(&path, format!("{}{INSTRUMENTS}", column_bed())).unwrap();
    let path = path.display().to_string();
    let one = talcum(0, &["run", &path, "--output", &place("one"), "--until", "0.6"]);
    let three = talcum(3, &["run", &path, "--output", &place("three"), "--until", "0.6"]);
    assert_eq!(one.digest(), three.digest());
    assert_same(
        &contents(&folder.path().join("three")),
        &contents(&folder.path().join("one")),
        "mpirun",
    );
    // Results of an earlier run, with those of instruments, are refused, and removed with --force.
    let again = talcum(0, &["run", &path, "--output", &place("one"), "--until", "0.6"]);
    assert_ne!(again.code(), Some(0));
    let without = folder.path().join("without.toml");
    std::fs::write(&without, column_bed()).unwrap();
    let without = without.display().to_string();
    let arguments = ["run", &without, "--output", &place("one"), "--until", "0.01", "--force"];
    talcum(0, &arguments).digest();
    assert!(contents(&folder.path().join("one")).is_empty());
}

/// Number of particles of each agglomerate at each time of the snapshots, by time, then label.
fn members_in_snapshots(folder: &Path) -> Vec<(f64, BTreeMap<i64, usize>)> {
    let file = hdf5::File::open(folder.join("particles.vtkhdf")).unwrap();
    let times: Vec<f64> = file.dataset("VTKHDF/Steps/Values").unwrap().read_raw().unwrap();
    let counts: Vec<i64> = file.dataset("VTKHDF/NumberOfPoints").unwrap().read_raw().unwrap();
    let labels: Vec<i64> =
        file.dataset("VTKHDF/PointData/agglomerate").unwrap().read_raw().unwrap();
    let mut rest = &labels[..];
    let of_time = |(time, count): (f64, i64)| {
        let (here, after) = rest.split_at(count as usize);
        rest = after;
        let mut members = BTreeMap::new();
        here.iter().filter(|&&label| label >= 0).for_each(|&label| {
            *members.entry(label).or_insert(0) += 1;
        });
        (time, members)
    };
    times.into_iter().zip(counts).map(of_time).collect()
}

#[test]
fn snapshots_show_the_agglomerates_of_the_last_sample() {
    let set = ["output.particles=0.3", "output.agglomerates=agglomerates", "checkpoint.every=0.3"];
    let text = format!("{}{INSTRUMENTS}", column_bed());
    let text = Case::text_with(&text, "case.toml", &set.map(str::to_owned)).unwrap();
    let case = case(&text);
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    run(&case, &place("whole"), &Part { ranks: 1, resume: false, until: 1.2 });
    let whole = members_in_snapshots(&place("whole"));
    assert_eq!(whole.len(), 5);
    // The table of the instrument says the same at these times.
    let table = hdf5::File::open(place("whole").join("measure-agglomerates.h5")).unwrap();
    let column = |name: &str| -> Vec<f64> {
        table.dataset(&format!("agglomerates/{name}")).unwrap().read_raw().unwrap()
    };
    let (times, labels, members) = (column("time"), column("label"), column("members"));
    let mut largest = 0;
    for (time, found) in &whole[1..] {
        let rows = (0..times.len()).filter(|&row| (times[row] - time).abs() < 1.0e-9);
        let expected: BTreeMap<i64, usize> =
            rows.map(|row| (labels[row] as i64, members[row] as usize)).collect();
        assert_eq!(*found, expected, "{time}");
        largest = largest.max(expected.values().copied().max().unwrap_or(0));
    }
    assert!(largest >= 3, "there are agglomerates to show");
    // Nothing is known before the second sample.
    assert!(whole[0].1.is_empty());
    run(&case, &place("parts"), &Part { ranks: 2, resume: false, until: 0.95 });
    remove_newest_checkpoint(&place("parts"));
    run(&case, &place("parts"), &Part { ranks: 3, resume: true, until: 1.2 });
    assert_eq!(members_in_snapshots(&place("parts")), whole);
}
