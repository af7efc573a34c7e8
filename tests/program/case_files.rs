//! Case files that must be read, and wrong ones that contain the messages they must give: `#^ message` after the line
//! that an error names (at the top, it names the whole file), `#! message` for an error of the initial bed.

use crate::toml_files::toml_files;
use proptest::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use talcum::case::{Amount, BedPart, BedStart, Case};
use talcum::parallel::OneRank;
use talcum::simulation::{self, OutputFolder, RunOptions, start_from_case};

/// The errors that a file announces: (line, words).
fn expected(text: &str) -> Vec<(usize, String)> {
    let mut line = 0;
    let mut expected = Vec::new();
    for (index, content) in text.lines().enumerate() {
        match content.strip_prefix("#^ ") {
            Some(message) => expected.push((line, message.to_owned())),
            None => line = index + 1,
        }
    }
    expected
}

#[test]
fn good_files_are_read_and_give_a_bed() {
    let files = toml_files("tests/cases/good");
    assert!(files.len() >= 8);
    for file in files {
        let case = Case::read(&file, &[]).unwrap_or_else(|errors| panic!("{errors}"));
        let bed = case
            .initial_bed(BedPart::WHOLE)
            .unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        assert!(!bed.particles.is_empty());
        let again = Case::from_text(&case.text, "again", file.parent().unwrap(), &[]);
        assert_eq!(again.unwrap(), case);
        let sizes = bed.size_range().unwrap();
        assert_eq!(case.check_sizes(&sizes), []);
        for stage in &case.stages {
            assert!(stage.models(&sizes).limits.force > 0.0);
        }
    }
}

#[test]
fn wrong_files_give_the_errors_that_they_announce_and_no_others() {
    let files = toml_files("tests/cases/bad");
    assert!(files.len() >= 25);
    let mut wrong = String::new();
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        let bed_words = text.lines().find_map(|line| line.strip_prefix("#! "));
        let mut expected = expected(&text);
        let name = file.display().to_string();
        let message = match (Case::read(&file, &[]), bed_words) {
            (Err(errors), _) => errors.to_string(),
            (Ok(case), Some(message)) => {
                match case.initial_bed(BedPart::WHOLE) {
                    Err(error) if error.to_string().contains(message) => {}
                    Err(error) => wrong += &format!("{name}: {error}\n  instead of {message}\n"),
                    Ok(_) => wrong += &format!("{name}: gives a bed\n"),
                }
                continue;
            }
            (Ok(_), None) => {
                wrong += &format!("{name}: is read\n");
                continue;
            }
        };
        for line in message.lines() {
            let matching = expected.iter().position(|(number, message)| {
                let place = match number {
                    0 => line.strip_prefix(&format!("{name}: ")),
                    _ => line.strip_prefix(&format!("{name}:{number}:")),
                };
                place.is_some_and(|rest| rest.contains(message.as_str()))
            });
            match matching {
                Some(index) => drop(expected.remove(index)),
                None => wrong += &format!("not announced: {line}\n"),
            }
        }
        for (line, message) in expected {
            wrong += &format!("not given: {name}:{line}: {message}\n");
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}

#[test]
fn every_case_of_the_repository_is_read() {
    for file in toml_files("cases") {
        let case = Case::read(&file, &[]).unwrap_or_else(|errors| panic!("{errors}"));
        if matches!(case.particles.start, BedStart::Lattice { .. } | BedStart::Random { .. }) {
            case.initial_bed(BedPart::WHOLE)
                .unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        }
    }
}

/// Beds above this size take longer than a test may.
const LARGEST_BED: u64 = 50_000;

/// A few steps of every case that needs no other run first, with all its outputs.
#[test]
fn every_case_of_the_repository_takes_steps() {
    let mut run = 0;
    for file in toml_files("cases") {
        let case = Case::read(&file, &[]).unwrap_or_else(|errors| panic!("{errors}"));
        let too_large = |amount: &Amount| matches!(amount, Amount::Count(n) if *n > LARGEST_BED);
        match &case.particles.start {
            BedStart::Run { path } if !path.exists() => continue,
            BedStart::Lattice { .. } | BedStart::Random { .. }
                if case.particles.amount.as_ref().is_some_and(too_large) =>
            {
                continue;
            }
            _ => {}
        }
        let name = file.display();
        let folder = tempfile::tempdir().unwrap();
        let initial = start_from_case(&case, None, &OneRank)
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        let options = RunOptions {
            end_time: 20.0 * case.stages[0].physics.time_step,
            folder: OutputFolder { path: folder.path().to_owned(), case_folder: PathBuf::new() },
            stop: &AtomicBool::new(false),
            watch: &mut |_| (),
        };
        let outcome = simulation::run(&case, initial, options, &OneRank)
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!((outcome.steps, outcome.complete), (20, true), "{name}");
        run += 1;
    }
    assert!(run >= 10, "{run}");
}

/// Values that no key expects, or that are near to what it allows.
const STRANGE: [&str; 24] = [
    "nan",
    "inf",
    "-inf",
    "0",
    "-0.0",
    "1",
    "-1",
    "1e-320",
    "1e-30",
    "1e30",
    "1e308",
    "1e999",
    "2.5e-4",
    "9223372036854775807",
    "99999999999999999999",
    "\"\"",
    "\"off\"",
    "\"on\"",
    "true",
    "[]",
    "[1, 1e9, 1e-9]",
    "{}",
    "{ from = 1, to = nan }",
    "1979-05-27",
];

proptest! {
    #[test]
    fn no_text_makes_the_reader_panic(
        file in 0..1000usize, mutations in prop::collection::vec((0..1000usize, 0..30usize), 1..4),
    ) {
        let files = toml_files("tests/cases/good");
        let file = &files[file % files.len()];
        let text = std::fs::read_to_string(file).unwrap();
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        for (line, change) in mutations {
            let index = line % lines.len();
            let line = &mut lines[index];
            match (change, line.split_once('=')) {
                (24, _) => line.clear(),
                (25, _) => line.truncate(line.len() / 2),
                (26, _) => line.insert(line.len() / 3, 'x'),
                (27, _) => *line = line.replace('.', ""),
                (28, _) => *line = format!("{line}\n{line}"),
                (29, _) => *line = line.replace('"', "["),
                (_, Some((key, _))) => *line = format!("{key} = {}", STRANGE[change]),
                _ => {}
            }
        }
        let folder = file.parent().unwrap();
        match Case::from_text(&lines.join("\n"), "mutated.toml", folder, &[]) {
            // A bed of a huge box would only take time.
            Ok(case) if case.domain.bounds.volume() < 1.0e4 => {
                if let Ok(bed) = case.initial_bed(BedPart::WHOLE) {
                    let sizes = bed.size_range().unwrap();
                    case.stages.iter().for_each(|stage| drop(stage.models(&sizes)));
                }
            }
            Ok(_) => {}
            Err(errors) => prop_assert!(!errors.errors.is_empty() && !errors.to_string().is_empty()),
        }
    }

    #[test]
    fn no_override_makes_the_reader_panic(key in "[a-z_.1-3]{0,24}=?", value in 0..24usize, given in ".{0,20}") {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases/good/staged.toml");
        for text in [format!("{key}{}", STRANGE[value]), given, format!("stage.2.{key}=1")] {
            if let Err(errors) = Case::read(&file, &[text]) {
                prop_assert!(!errors.errors.is_empty());
            }
        }
    }
}
