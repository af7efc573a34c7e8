//! Without a terminal `talcum watch` prints one report and ends; anything that it cannot show is an error that names
//! it.

use super::made;
use crate::launch::{smoke, start, talcum};
use std::fs;
use std::io::Write;
use std::path::Path;

fn shown(folder: &Path) -> String {
    folder.display().to_string()
}

/// The text behind a name in the report.
fn entry<'r>(report: &'r str, name: &str) -> Option<&'r str> {
    report.lines().find_map(|line| line.trim_start().strip_prefix(name).map(str::trim_start))
}

#[test]
fn one_report_has_title_state_progress_and_the_newest_numbers() {
    let made = made(20);
    for arguments in
        [&["watch", &shown(made.path())][..], &["watch", &shown(made.path()), "--once"]]
    {
        let ended = talcum(0, arguments);
        assert_eq!((ended.code(), ended.errors.as_str()), (Some(0), ""), "{ended:?}");
        let report = &ended.output;
        assert_eq!(report.lines().next(), Some("Made by hand"));
        assert_eq!(
            entry(report, "state"),
            Some("stopped before its end; `talcum run --resume` continues it")
        );
        assert_eq!(entry(report, "progress"), Some("time 20 of 1000 sqrt(d/g), 2 %"));
        assert_eq!(entry(report, "bed_top"), Some("50 d, so far between 40 and 50"));
        assert!(
            entry(report, "grid_pressure_drop").is_some_and(|value| value.starts_with("0.98,"))
        );
        // Nothing to warn of, and columns of zeros are not shown.
        assert_eq!((entry(report, "warning"), entry(report, "coordination_number")), (None, None));
    }
    let chosen = talcum(0, &["watch", &shown(made.path()), "--columns", "particles,departed"]);
    assert_eq!(entry(&chosen.output, "particles"), Some("500, so far between 500 and 500"));
    assert_eq!(entry(&chosen.output, "departed"), Some("0, so far between 0 and 0"));
    assert_eq!(entry(&chosen.output, "bed_top"), None);
}

#[test]
fn a_line_that_is_being_written_and_damaged_neighbours_are_no_error() {
    let made = made(20);
    let open =
        |name: &str| fs::File::options().append(true).create(true).open(made.path().join(name));
    open("series.csv").unwrap().write_all(b"21,0.1").unwrap();
    open("profiles.h5").unwrap().write_all(b"not HDF5 yet").unwrap();
    open("checkpoint-000000000001.h5.partial").unwrap().write_all(b"half").unwrap();
    let ended = talcum(0, &["watch", &shown(made.path())]);
    assert_eq!(ended.code(), Some(0), "{ended:?}");
    assert!(ended.output.contains("time 20 of 1000"), "{}", ended.output);
    assert_eq!(entry(&ended.output, "warning"), None);
    // Negative control: a whole line that is no row is reported, and so is a file that a run set aside.
    open("series.csv").unwrap().write_all(b",x\n").unwrap();
    open("profiles.h5.unreadable-1").unwrap().write_all(b"").unwrap();
    let ended = talcum(0, &["watch", &shown(made.path())]);
    assert_eq!(ended.code(), Some(0), "{ended:?}");
    assert!(ended.output.contains("is not a row of numbers"), "{}", ended.output);
    assert!(ended.output.contains("set aside: profiles.h5.unreadable-1"), "{}", ended.output);
}

#[test]
fn a_folder_without_results_waits_and_one_of_something_else_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let ended = talcum(0, &["watch", &shown(folder.path())]);
    assert_eq!(ended.code(), Some(0), "{ended:?}");
    assert_eq!(entry(&ended.output, "state"), Some("waiting: nothing has been written yet"));
    assert_eq!(entry(&ended.output, "progress"), Some("no results yet"));
    fs::write(folder.path().join("notes.txt"), "").unwrap();
    let ended = talcum(0, &["watch", &shown(folder.path())]);
    assert_eq!(ended.code(), Some(1), "{ended:?}");
    assert!(ended.error().contains("holds no case.toml"), "{}", ended.errors);
    for nowhere in [folder.path().join("nowhere"), folder.path().join("notes.txt")] {
        let ended = talcum(0, &["watch", &shown(&nowhere)]);
        assert_eq!((ended.code(), ended.output.as_str()), (Some(1), ""), "{ended:?}");
        assert!(ended.error().contains(&shown(&nowhere)), "{}", ended.errors);
        assert!(ended.error().contains("name the folder of results of a run"), "{}", ended.errors);
    }
}

#[test]
fn an_unknown_column_is_refused_with_those_there_are() {
    let made = made(2);
    let ended = talcum(0, &["watch", &shown(made.path()), "--columns", "bed_top,bed_tip"]);
    assert_eq!((ended.code(), ended.output.as_str()), (Some(1), ""), "{ended:?}");
    assert!(
        ended.error().contains("--columns bed_tip: series.csv has no such column"),
        "{}",
        ended.errors
    );
    assert!(ended.error().contains("grid_pressure_drop, plenum_pressure"), "{}", ended.errors);
}

#[test]
fn a_run_is_seen_to_continue_and_to_be_complete_with_its_digest() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("results");
    let mut run = start(0, &["run", &smoke("si"), "--output", &shown(&output)]);
    run.wait_until(|| output.join("series.csv").exists());
    let during = talcum(0, &["watch", &shown(&output)]);
    assert_eq!(during.code(), Some(0), "{during:?}");
    let state = entry(&during.output, "state").unwrap().to_owned();
    let process = run.process();
    // It may have come to its end meanwhile.
    assert!(
        state.starts_with(&format!("running: process {process} ")) || state.starts_with("complete"),
        "{state}"
    );
    let digest = run.wait().digest();
    let after = talcum(0, &["watch", &shown(&output)]);
    assert_eq!(entry(&after.output, "state"), Some(format!("complete, digest {digest}").as_str()));
    assert!(after.output.contains("100 %"), "{}", after.output);
}
