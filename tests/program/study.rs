//! A study with the real program: interrupted or not, it gives the same tables on any ranks; a wrong value is rejected
//! before anything runs.

use crate::faults::Fault;
use crate::launch::{Ended, in_repository, signal, start, talcum, turn_of_mpirun};
use crate::toml_files::study_files;
use std::path::{Path, PathBuf};

/// Exit code of a study that was stopped and can be resumed.
const STOPPED: i32 = 75;

fn data(name: &str) -> PathBuf {
    in_repository("tests/program/study").join(name)
}

fn arguments<'a>(study: &'a Path, output: &'a Path, options: &[&'a str]) -> Vec<&'a str> {
    let mut arguments = vec!["study", study.to_str().unwrap(), "--output"];
    arguments.push(output.to_str().unwrap());
    arguments.extend(options);
    arguments
}

fn run(study: &Path, output: &Path, options: &[&str]) -> Ended {
    talcum(0, &arguments(study, output, options))
}

/// A study of the bed of the docs with these further lines.
fn written(folder: &Path, lines: &str) -> PathBuf {
    let study = folder.join("written.toml");
    let bed = data("bed.toml").display().to_string();
    std::fs::write(&study, format!("title = \"written\"\ncase = {bed:?}\n{lines}")).unwrap();
    study
}

#[track_caller]
fn assert_code(ended: &Ended, code: i32) {
    assert_eq!(ended.code(), Some(code), "{}\n{}", ended.output, ended.errors);
}

/// The study of the docs with short runs: here its beds need not come to rest.
fn short_study(folder: &Path) -> PathBuf {
    let mut text = std::fs::read_to_string(data("study.toml")).unwrap();
    let bed = data("bed.toml").display().to_string();
    let shorter = [
        ("bed.toml", bed.as_str()),
        ("duration = 80.0", "duration = 4.0"),
        ("from = 62.0", "from = 4.0"),
        ("last = 20.0", "last = 2.0"),
    ];
    for (long, short) in shorter {
        assert_eq!(text.matches(long).count(), 1, "{long} in {text}");
        text = text.replace(long, short);
    }
    let study = folder.join("study.toml");
    std::fs::write(&study, text).unwrap();
    study
}

fn tables(output: &Path) -> String {
    let read = |name: &str| std::fs::read_to_string(output.join(name)).unwrap();
    read("runs.csv") + &read("points.csv")
}

/// The tables as HDF5; nothing in the file depends on when or where it was written.
fn hdf5(output: &Path) -> Vec<u8> {
    std::fs::read(output.join("study.h5")).unwrap()
}

/// Starts a study, waits until a run has written a checkpoint without being complete, and sends a signal.
fn interrupt(study: &Path, output: &Path, options: &[&str], name: &str) -> Ended {
    let mut running = start(0, &arguments(study, output, options));
    running.wait_until(|| is_under_way(output));
    signal(name, running.process());
    running.wait()
}

fn is_under_way(output: &Path) -> bool {
    let runs = std::fs::read_dir(output.join("runs")).into_iter().flatten().flatten();
    let under_way = |folder: PathBuf| {
        let entries = std::fs::read_dir(&folder).unwrap().flatten();
        let names: Vec<String> =
            entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        let has_checkpoint = names.iter().any(|name| name.starts_with("checkpoint-"));
        has_checkpoint && !names.iter().any(|name| name == "complete")
    };
    runs.map(|entry| entry.path()).any(under_way)
}

#[test]
fn tables_do_not_depend_on_ranks_and_interruptions() {
    let _turn = turn_of_mpirun();
    let folder = tempfile::tempdir().unwrap();
    let study = short_study(folder.path());
    let (whole, broken) = (folder.path().join("whole"), folder.path().join("broken"));
    assert_code(&run(&study, &whole, &["--at-a-time", "2"]), 0);
    let expected = tables(&whole);
    let expected_hdf5 = hdf5(&whole);
    assert_eq!(expected.matches(",complete,").count(), 8, "{expected}");

    // Stopped gently: all runs have ended when the study ends.
    let on_two = ["--ranks-per-run", "2"];
    assert_code(&interrupt(&study, &broken, &on_two, "INT"), STOPPED);
    let status = run(&study, &broken, &["--status"]);
    assert!(status.output.contains(" 0 running"), "{}", status.output);

    // Killed at once: its run carries on by itself, and the next study waits for it instead of running it twice.
    assert_eq!(interrupt(&study, &broken, &on_two, "KILL").code(), None);
    assert_code(&run(&study, &broken, &on_two), 0);
    assert_eq!(tables(&broken), expected);
    assert!(hdf5(&broken) == expected_hdf5);

    // Nothing is left to do, and what is written again is the same.
    std::fs::remove_file(broken.join("runs.csv")).unwrap();
    let nothing_starts = ["--ranks-per-run", "2", "--launcher", "no-such-program"];
    assert_code(&run(&study, &broken, &nothing_starts), 0);
    assert_eq!(tables(&broken), expected);
}

#[test]
fn what_talcum_analyse_measures_stands_in_the_tables_of_a_study() {
    let folder = tempfile::tempdir().unwrap();
    let text = "seeds = 2\nmeasures = [\"bed.height\", \"waves.state\", \"u_mf\"]\n[set]\noutput.profiles = 0.1\n\
                [measure.late]\nsource = \"analysis\"\nquantity = \"bed.height\"\nwindow = { last = 1.0 }\n";
    let study = written(folder.path(), text);
    let output = folder.path().join("out");
    assert_code(&run(&study, &output, &["--at-a-time", "2"]), 0);
    let tables = tables(&output);
    for heading in
        ["bed.height [d],waves.state,u_mf [sqrt(g d)],late [d]", "u_mf_runs", "late_upper [d]"]
    {
        assert!(tables.contains(heading), "{heading}\n{tables}");
    }
    // A bed without a ramp has no U_mf, which is no error; no run gave one.
    let points = std::fs::read_to_string(output.join("points.csv")).unwrap();
    let row = points.lines().last().unwrap();
    assert!(row.contains(",,,,,0,"), "{points}");
    // The window counts: the bed is not as high in the mean as at its end.
    let runs = std::fs::read_to_string(output.join("runs.csv")).unwrap();
    let row: Vec<&str> = runs.lines().last().unwrap().split(',').collect();
    let [.., whole, _, _, late] = row[..] else { panic!("{runs}") };
    let [whole, late] = [whole, late].map(|cell| cell.parse::<f64>().unwrap());
    assert!((10.0..60.0).contains(&whole) && late != whole, "{runs}");
    // A summary of the same runs has the same numbers, and says why there is none.
    let folders = std::fs::read_dir(output.join("runs")).unwrap().flatten();
    let mut folders: Vec<String> = folders.map(|run| run.path().display().to_string()).collect();
    folders.sort();
    let measures = ["--quantity", "bed.height", "--quantity", "u_mf"];
    let options = folders.iter().map(String::as_str).chain(measures);
    let summary = talcum(0, &["summary"].into_iter().chain(options).collect::<Vec<_>>());
    assert_code(&summary, 0);
    let (table, warnings) = (&summary.output, &summary.errors);
    assert!(table.contains(",bed.height [d],u_mf [sqrt(g d)]\n"), "{table}");
    let row: Vec<&str> = table.lines().last().unwrap().split(',').collect();
    let [.., height, u_mf] = row[..] else { panic!("{table}") };
    assert_eq!((height.parse::<f64>().unwrap(), u_mf), (whole, ""), "{table}");
    assert!(warnings.contains("u_mf: "), "{warnings}");
}

#[test]
fn results_of_a_complete_run_that_were_cut_short_or_are_gone_are_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let text = "seeds = 2\nmeasures = [\"bed.height\", \"waves.state\"]\n[set]\noutput.profiles = 0.1\n\
                stage.pour.duration = 0.4\nstage.fluidise.duration = 0.8\n\
                [measure.top]\ncolumn = \"bed_top\"\nstatistic = \"last\"\n";
    let study = written(folder.path(), text);
    let output = folder.path().join("out");
    assert_code(&run(&study, &output, &["--at-a-time", "2"]), 0);
    let first = std::fs::read_dir(output.join("runs")).unwrap().flatten().next().unwrap().path();
    let (series, profiles) = (first.join("series.csv"), first.join("profiles.h5"));
    let whole = std::fs::read(&series).unwrap();
    let last_row =
        whole.len() - 1 - whole[..whole.len() - 1].iter().rposition(|&b| b == b'\n').unwrap();
    for lost in [2000, last_row] {
        std::fs::write(&series, &whole[..whole.len() - lost]).unwrap();
        for options in [&[][..], &["--table"]] {
            let ended = run(&study, &output, options);
            assert_code(&ended, 1);
            let message = "series.csv was cut short: its last row is at time ";
            assert!(ended.errors.contains(message), "{lost}: {}", ended.errors);
        }
    }
    std::fs::write(&series, &whole).unwrap();
    std::fs::rename(&profiles, first.join("elsewhere")).unwrap();
    let ended = run(&study, &output, &[]);
    assert_code(&ended, 1);
    let message = "profiles.h5: is not there, though the run is complete and its case asks for it";
    assert!(ended.errors.contains(message), "{}", ended.errors);
    // The control: with both files as they were nothing is wrong, and nothing is if no row is due at the end.
    std::fs::rename(first.join("elsewhere"), &profiles).unwrap();
    assert_code(&run(&study, &output, &[]), 0);
    let study = written(folder.path(), &text.replace("[set]\n", "[set]\noutput.series = 0.7\n"));
    assert_code(&run(&study, &folder.path().join("between"), &["--at-a-time", "2"]), 0);
}

#[test]
fn a_quantity_that_no_run_of_the_case_can_give_is_refused_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out");
    for (measure, reason) in [
        (
            "waves.speed",
            "there is no profiles.h5: the key output.profiles of the case would give it",
        ),
        ("cycle.lift", "the plate vibrates in no stage"),
    ] {
        let study = written(folder.path(), &format!("measures = [{measure:?}]\n"));
        let refused = run(&study, &output, &[]);
        assert_code(&refused, 1);
        let message = format!("measure.{measure}: no run can give it: {reason}");
        assert!(refused.errors.contains(&message), "{}", refused.errors);
        assert!(refused.errors.contains("written.toml:3: "), "{}", refused.errors);
    }
    assert!(!output.join("runs").exists());
    // The control: with the key it has a value.
    let text = "measures = [\"waves.speed\"]\n[set]\noutput.profiles = 0.1\n";
    let study = written(folder.path(), text);
    assert_code(&run(&study, &output, &[]), 0);
}

#[test]
fn a_search_may_name_its_own_quantity_and_counts_as_failed_if_it_has_none() {
    let folder = tempfile::tempdir().unwrap();
    let search = "[set]\noutput.profiles = 0.1\n[bisection]\nkey = \"gas.superficial_velocity\"\n\
                  bracket = [0.01, 0.02]\ntolerance = 0.005\nmeasure = \"bed.height\"\n\
                  threshold = 1000.0\ndirection = \"rises\"\n";
    let study = written(folder.path(), search);
    let output = folder.path().join("out");
    let ended = run(&study, &output, &[]);
    assert_code(&ended, 1);
    let message = "[bisection] in line 5: the criterion never changes over the bracket";
    assert!(ended.errors.contains(message), "{}", ended.errors);
    let status = run(&study, &output, &["--status"]);
    let counted = "2 done, 0 running, 0 waiting, 0 failed; 1 of the searches without a result";
    assert!(status.output.contains(counted), "{}", status.output);
}

#[test]
fn a_bad_value_is_refused_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(data("study.toml")).unwrap();
    let text = text.replace("bed.toml", &data("bed.toml").display().to_string());
    let study = folder.path().join("bad.toml");
    std::fs::write(&study, text.replace("[0.0, 8.0]", "[-1.0, 8.0]")).unwrap();
    let output = folder.path().join("out");
    let refused = run(&study, &output, &[]);
    assert_code(&refused, 1);
    let message = refused.error();
    assert!(message.contains("bad.toml:8: cohesion.bond_number = -1.0: must be"), "{message}");
    assert!(!output.join("runs").exists());
}

#[test]
fn the_case_and_the_study_are_those_of_the_docs() {
    let docs = std::fs::read_to_string(in_repository("docs/study.md")).unwrap();
    for name in ["bed.toml", "study.toml"] {
        let text = std::fs::read_to_string(data(name)).unwrap();
        assert!(docs.contains(&format!("```toml\n{text}```")), "{name}");
    }
}

#[test]
fn numbers_of_instruments_stand_in_the_tables_of_a_study() {
    let folder = tempfile::tempdir().unwrap();
    let study = folder.path().join("measured.toml");
    let bed = std::fs::read_to_string(data("bed.toml")).unwrap();
    let measures = "[measure.touching]\nkind = \"coordination\"\nevery = 0.25\n\
                    [measure.sets]\nkind = \"agglomerates\"\nevery = 0.25\nwindow = 1.0\nsmallest = 400\n";
    std::fs::write(folder.path().join("bed.toml"), format!("{bed}\n{measures}")).unwrap();
    let of_case = |name: &str, measure: &str, column: &str, window: &str| {
        format!(
            "[measure.{name}]\nsource = \"case\"\nmeasure = \"{measure}\"\ncolumn = \"{column}\"\n\
             statistic = \"mean\"\nwindow = {window}\n"
        )
    };
    let measures = of_case("contacts", "touching", "coordination_number", "{ last = 1.0 }")
        + &of_case("agglomerates", "sets", "diameter", "{ from = 0.5 }");
    let head = "title = \"measured\"\ncase = \"bed.toml\"\n";
    std::fs::write(&study, format!("{head}{measures}")).unwrap();
    let output = folder.path().join("out");
    assert_code(&run(&study, &output, &[]), 0);
    let runs = std::fs::read_to_string(output.join("runs.csv")).unwrap();
    let row: Vec<&str> = runs.lines().last().unwrap().split(',').collect();
    let [.., contacts, diameter] = row[..] else { panic!("{runs}") };
    // A bed of 500 particles that settles: some touch, none of its agglomerates has 400 members.
    assert!((0.1..6.0).contains(&contacts.parse::<f64>().unwrap()), "{runs}");
    assert_eq!(diameter, "", "{runs}");

    let wrong = std::fs::read_to_string(&study).unwrap().replace("= \"sets\"", "= \"set\"");
    std::fs::write(&study, wrong).unwrap();
    let refused = run(&study, &folder.path().join("other"), &[]);
    let refused = refused.error();
    assert!(refused.contains("the case has no [measure.set]: did you mean sets?"), "{refused}");
}

#[test]
fn every_study_of_the_repository_is_read_and_expanded() {
    let files: Vec<PathBuf> =
        ["liu2016", "moon2006", "parcels"].into_iter().flat_map(studies_of).collect();
    assert!(files.len() >= 4);
    for file in files {
        let folder = tempfile::tempdir().unwrap();
        let listed = run(&file, folder.path(), &["--only-list"]);
        assert_code(&listed, 0);
        assert!(listed.output.contains("   1  not complete  "), "{}", listed.output);
    }
}

/// Whoever adds a seed to a study of the repository can continue from its kept table, because neither the case nor its quantities
/// has changed since.
#[test]
fn kept_tables_of_runs_are_known_to_their_studies() {
    let mut kept = 0;
    for study in ["liu2016", "moon2006", "parcels"].into_iter().flat_map(studies_of) {
        let results = study.parent().unwrap().with_file_name("results");
        let name = study.file_stem().unwrap().to_str().unwrap();
        // The complete runs of a study that is not complete.
        let places = [results.join("begun"), results].map(|it| it.join(format!("{name}-runs.csv")));
        let Some(table) = places.into_iter().find(|table| table.exists()) else { continue };
        let text = std::fs::read_to_string(&table).unwrap();
        let rows = text.lines().filter(|line| line.contains(",complete,")).count();
        let folder = tempfile::tempdir().unwrap();
        let known = ["--known", table.to_str().unwrap(), "--status"];
        let status = run(&study, folder.path(), &known);
        assert_code(&status, 0);
        assert!(status.output.contains(&format!(": {rows} done,")), "{name}: {}", status.output);
        // The control: without the table nothing is done.
        let status = run(&study, folder.path(), &["--status"]);
        assert!(status.output.contains(": 0 done,"), "{name}: {}", status.output);
        kept += 1;
    }
    assert!(kept >= 10);
}

fn studies_of(name: &str) -> Vec<PathBuf> {
    study_files(&format!("cases/{name}"))
}

/// The refusal reaches the user.
#[test]
fn a_table_of_another_study_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let table = in_repository("cases/moon2006/results/fig7-runs.csv");
    let study = in_repository("cases/moon2006/studies/fig3.toml");
    let refused = run(&study, folder.path(), &["--known", table.to_str().unwrap(), "--status"]);
    assert_code(&refused, 1);
    assert!(refused.error().contains("fig7-runs.csv: quantity "), "{}", refused.errors);
    assert!(refused.error().contains("this is no quantity of the table"), "{}", refused.errors);
}

#[test]
fn a_study_resumes_after_a_run_was_killed_while_it_wrote_its_case() {
    let folder = tempfile::tempdir().unwrap();
    let study = written(
        folder.path(),
        "seeds = 1\n[set]\nstage.fluidise.duration = 0.4\n\
         [measure.top]\ncolumn = \"bed_top\"\nstatistic = \"last\"\n",
    );
    let output = folder.path().join("out");
    let fault = Fault { call: "write", file: "/case.toml", from: 1, count: Some(1), rank: 0 };
    let killed = fault.kill(&arguments(&study, &output, &[]));
    assert_code(&killed, 1);
    // The case stands under its name as a whole, or not at all.
    let run_folder = std::fs::read_dir(output.join("runs")).unwrap().flatten().next().unwrap();
    assert!(!run_folder.path().join("case.toml").exists());
    assert_code(&run(&study, &output, &["--retry"]), 0);
}
