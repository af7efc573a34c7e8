//! Instruments of runs: their files, which have the same bits on any number of ranks and after any restart.

mod fields;
mod known_beds;
mod one_answer;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use talcum::analysis::Digest;
use talcum::case::Case;
use talcum::output::checkpoint;
use talcum::parallel::run_on_threads;
use talcum::simulation::{self, OutputFolder, RunOptions, start_from_case, start_from_checkpoint};

/// The case of a text.
fn case(text: &str) -> Case {
    let case = Case::from_text(text, "case.toml", Path::new(""), &[]);
    case.unwrap_or_else(|errors| panic!("{errors}"))
}

/// A part of a run on thread ranks.
struct Part {
    ranks: usize,
    /// Start from the beginning, or continue from the newest checkpoint in the folder.
    resume: bool,
    until: f64,
}

/// Does a part of a run; its digest at the end.
fn run(case: &Case, folder: &Path, part: &Part) -> Digest {
    let digests = run_on_threads(part.ranks, |ranks| {
        let initial = if part.resume {
            let search = checkpoint::newest_good(folder, ranks).unwrap();
            let (_, checkpoint, _, _) = search.found.unwrap();
            start_from_checkpoint(case, checkpoint, None, true, ranks).unwrap()
        } else {
            start_from_case(case, None, ranks).unwrap()
        };
        let folder = OutputFolder { path: folder.to_owned(), case_folder: folder.to_owned() };
        let (stop, mut watch) = (AtomicBool::new(false), |_: &simulation::Progress| {});
        let options = RunOptions { end_time: part.until, folder, stop: &stop, watch: &mut watch };
        simulation::run(case, initial, options, ranks).unwrap().digest
    });
    digests[0]
}

/// Removes the newest checkpoint: a run that continues from the one before finds rows of a later time.
fn remove_newest_checkpoint(folder: &Path) {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let is_checkpoint = |path: &std::path::PathBuf| {
        path.file_name().unwrap().to_str().unwrap().starts_with("checkpoint-")
    };
    let newest = entries.filter(is_checkpoint).max().unwrap();
    std::fs::remove_file(newest).unwrap();
}

/// Bits of all datasets in the files of instruments, by file and path.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u64>> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if name.starts_with("measure-") && !name.ends_with(".metadata") {
            let file = hdf5::File::open(&path).unwrap();
            add_group(&file, &name, &mut found);
        }
    }
    found
}

fn add_group(group: &hdf5::Group, name: &str, found: &mut BTreeMap<String, Vec<u64>>) {
    for member in group.groups().unwrap() {
        add_group(&member, name, found);
    }
    for dataset in group.datasets().unwrap() {
        let is_number = dataset.dtype().unwrap().is::<f64>();
        let bits: Vec<u64> = if is_number {
            dataset.read_raw::<f64>().unwrap().into_iter().map(f64::to_bits).collect()
        } else {
            dataset.read_raw::<i64>().unwrap().into_iter().map(|x| x as u64).collect()
        };
        found.insert(format!("{name}{}", dataset.name()), bits);
    }
}

/// Says which datasets differ.
fn assert_same(
    found: &BTreeMap<String, Vec<u64>>,
    expected: &BTreeMap<String, Vec<u64>>,
    what: &str,
) {
    let differing: Vec<&String> = expected
        .iter()
        .filter(|(name, bits)| found.get(*name) != Some(bits))
        .map(|it| it.0)
        .collect();
    assert!(differing.is_empty() && found.len() == expected.len(), "{what}: {differing:?}");
}
