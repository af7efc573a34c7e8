//! Studies run to their ends with simulated runs: order, stops, failures, continuation, searches, tables.

use super::fakes::{Desk, FakeRunner, number};
use std::collections::BTreeMap;

const GRID: &str = "seeds = 2\n[[axis]]\nkey = \"cohesion.bond_number\"\nvalues = [2, 4]\n[[axis]]\nkey = \"gas.superficial_velocity\"\nvalues = [0.1, 0.2]\n[run]\nat_a_time = 3\n";
const SEARCH: &str = "seeds = 3\n[[axis]]\nkey = \"gas.superficial_velocity\"\nvalues = [0.1, 0.2]\n[bisection]\nkey = \"cohesion.bond_number\"\nbracket = [1.0, 9.0]\ntolerance = 0.25\nmeasure = \"top\"\nthreshold = 5.0\ndirection = \"falls\"\n[run]\nat_a_time = 4\n";

type Keys = BTreeMap<String, String>;

#[allow(clippy::unnecessary_wraps, reason = "physics may fail")]
fn falling(keys: &Keys) -> Result<f64, String> {
    let noise = 0.1 * number(keys, "particles.seed");
    Ok(9.0 - number(keys, "cohesion.bond_number")
        + 10.0 * number(keys, "gas.superficial_velocity")
        + noise)
}

/// The tables of a study that is never interrupted.
fn undisturbed(study: &str) -> String {
    let desk = Desk::new(study);
    let outcome = desk.work(&FakeRunner::new(falling), None);
    assert!(!outcome.stopped && outcome.failures.is_empty(), "{outcome:?}");
    desk.tables()
}

#[test]
fn a_grid_runs_so_many_at_a_time_and_is_not_run_again() {
    let desk = Desk::new(GRID);
    let runner = FakeRunner::new(falling);
    desk.work(&runner, None);
    assert_eq!((runner.started.borrow().len(), runner.most_active.get()), (8, 3));
    let again = FakeRunner::new(falling);
    desk.work(&again, None);
    assert_eq!(again.started.borrow().len(), 0);
    let tables = desk.tables();
    assert!(tables.contains("bond_number,superficial_velocity,seed,state,digest"), "{tables}");
    // Point 1: 9 - 2 + 1 + 0.1 and + 0.2, t(1) = 12.706: 8.15 +- 12.706 * 0.0707 / sqrt(2).
    let point = tables.lines().find(|line| line.starts_with("1,2,0.1,2,")).unwrap();
    let numbers: Vec<f64> = point.split(',').skip(4).map(|text| text.parse().unwrap()).collect();
    for (number, expected) in numbers.into_iter().zip([8.15, 0.070_711, 7.514_69, 8.785_31]) {
        assert!((number - expected).abs() < 1.0e-4, "{point}");
    }
}

#[test]
fn a_study_stopped_at_any_look_comes_to_the_same_tables() {
    for study in [GRID, SEARCH] {
        let whole = undisturbed(study);
        for stop_at in [1, 2, 4, 9] {
            let desk = Desk::new(study);
            let outcome = desk.work(&FakeRunner::new(falling), Some(stop_at));
            assert!(outcome.stopped, "{stop_at}");
            let early = desk.tables();
            assert_ne!(early, whole);
            assert!(!desk.work(&FakeRunner::new(falling), None).stopped);
            assert_eq!(desk.tables(), whole, "stopped at look {stop_at}");
        }
    }
}

#[test]
fn a_changed_study_reuses_what_still_fits() {
    let desk = Desk::new(GRID);
    desk.work(&FakeRunner::new(falling), None);
    desk.write(&GRID.replace("[2, 4]", "[4, 6]").replace("seeds = 2", "seeds = 3"));
    let runner = FakeRunner::new(falling);
    desk.work(&runner, None);
    // There are 2 x 2 x 3 runs, of which those with Bond number 4 and seeds 1 and 2 exist.
    assert_eq!(runner.started.borrow().len(), 8);
    // Without the axis of gas velocities the names differ, but 0.1 is the value of the case.
    desk.write("[[axis]]\nkey = \"cohesion.bond_number\"\nvalues = [4, 6]\n");
    let runner = FakeRunner::new(falling);
    desk.work(&runner, None);
    assert_eq!(runner.started.borrow().len(), 0);
}

#[test]
fn a_changed_case_makes_new_runs() {
    let desk = Desk::new(GRID);
    desk.work(&FakeRunner::new(falling), None);
    let case = super::fakes::CASE.replace("count = 10", "count = 11 # more");
    std::fs::write(desk.path("bed.toml"), case).unwrap();
    let runner = FakeRunner::new(falling);
    desk.work(&runner, None);
    assert_eq!(runner.started.borrow().len(), 8);
}

#[test]
fn results_of_another_case_in_the_folder_of_a_run_are_refused() {
    let desk = Desk::new("");
    desk.work(&FakeRunner::new(falling), None);
    let run = std::fs::read_dir(desk.path("out/runs")).unwrap().next().unwrap().unwrap().path();
    std::fs::write(run.join("case.toml"), "[particles]\ncount = 3\n").unwrap();
    let outcome = desk.work(&FakeRunner::new(falling), None);
    assert!(outcome.failures[0].contains("holds the results of another case"), "{outcome:?}");
}

#[test]
fn a_search_finds_the_threshold_of_every_seed() {
    let tables = undisturbed(SEARCH);
    // The crossing lies at 4 + 10 U + 0.1 seed: 5.1, 5.2, 5.3 for U = 0.1.
    let point = tables.lines().rfind(|line| line.starts_with("1,0.1,3,")).unwrap();
    let numbers: Vec<f64> =
        point.split(',').skip(3).map(|number| number.parse().unwrap()).collect();
    let [critical, _, lower, upper, resolution] = numbers[..] else { panic!("{point}") };
    assert_eq!(resolution, 0.125);
    assert!((critical - 5.2).abs() < 0.125 && lower < 5.2 && 5.2 < upper, "{point}");
    assert!(tables.contains("found"));
}

#[test]
fn a_search_without_a_crossing_is_reported_and_others_continue() {
    fn constant_in_a_slow_gas(keys: &Keys) -> Result<f64, String> {
        if number(keys, "gas.superficial_velocity") < 0.15 { Ok(20.0) } else { falling(keys) }
    }
    let desk = Desk::new(SEARCH);
    let runner = FakeRunner::new(constant_in_a_slow_gas);
    let outcome = desk.work(&runner, None);
    assert_eq!(outcome.failures.len(), 3);
    let message = "[bisection] in line 7: the criterion never changes over the bracket";
    assert!(outcome.failures[0].contains(message), "{outcome:?}");
    let slow = runner.started.borrow().iter().filter(|name| name.contains("=0.1__")).count();
    assert_eq!(slow, 6, "two ends of three seeds");
    let tables = desk.tables();
    assert_eq!(tables.matches("no crossing").count(), 3, "{tables}");
    assert!(tables.contains("\n2,0.2,3,6."), "{tables}");
}

#[test]
fn a_failed_run_says_why_and_is_not_tried_again_unless_asked() {
    fn fails_at_four(keys: &Keys) -> Result<f64, String> {
        match number(keys, "cohesion.bond_number") {
            4.0 => Err("ended with exit code 1: error: too sticky".to_owned()),
            _ => falling(keys),
        }
    }
    let desk = Desk::new(GRID);
    let outcome = desk.work(&FakeRunner::new(fails_at_four), None);
    assert_eq!(outcome.failures.len(), 4);
    assert!(outcome.failures[0].contains("too sticky"), "{outcome:?}");
    let status = desk.with_session(|session| crate::study::status::status(session).unwrap());
    assert!(status.contains("failed    bond_number=4"), "{status}");
    assert!(status.contains("8 runs: 4 done, 0 running, 0 waiting, 4 failed"), "{status}");
    let again = FakeRunner::new(falling);
    assert_eq!(desk.work(&again, None).failures.len(), 4);
    assert_eq!(again.started.borrow().len(), 0);
    desk.with_session(|session| {
        for member in session.plan.tasks.iter().flat_map(|task| task.planned()) {
            session.folder.forget_failure(member).unwrap();
        }
    });
    assert!(desk.work(&again, None).failures.is_empty());
    assert_eq!(desk.tables(), undisturbed(GRID));
}

#[test]
fn a_chain_runs_in_its_order_and_ends_where_a_run_fails() {
    fn fails_at_four(keys: &Keys) -> Result<f64, String> {
        let is_continued = keys["particles.start.kind"] == "run";
        assert_eq!(is_continued, number(keys, "cohesion.bond_number") > 2.0);
        if number(keys, "cohesion.bond_number") == 4.0 { Err("no".to_owned()) } else { Ok(1.0) }
    }
    let study = "[[axis]]\nkey = \"cohesion.bond_number\"\nvalues = [2, 3, 4, 5]\n[continuation]\naxis = \"cohesion.bond_number\"\n[run]\nat_a_time = 4\n";
    let desk = Desk::new(study);
    let runner = FakeRunner::new(fails_at_four);
    let outcome = desk.work(&runner, None);
    assert_eq!((runner.started.borrow().len(), runner.most_active.get()), (3, 1));
    assert!(outcome.failures[0].contains("1 more of its chain cannot start"), "{outcome:?}");
}

#[test]
fn a_run_that_is_held_elsewhere_is_left_alone() {
    let desk = Desk::new("");
    desk.with_session(|session| {
        let member = &session.plan.tasks[0].planned()[0];
        let held = session.folder.lock_run(member).unwrap();
        assert!(held.is_some() && session.folder.is_running(member));
        assert!(session.folder.lock_run(member).unwrap().is_none());
    });
    let runner = FakeRunner::new(falling);
    desk.work(&runner, None);
    assert_eq!(runner.started.borrow().len(), 1);
}

#[test]
fn a_summary_of_the_runs_has_the_means_of_the_study() {
    let desk = Desk::new(GRID);
    desk.work(&FakeRunner::new(falling), None);
    let runs = std::fs::read_dir(desk.path("out/runs")).unwrap().flatten();
    let mut results: Vec<_> = runs.map(|entry| entry.path()).collect();
    results.sort();
    let mut options = crate::study::SummaryOptions {
        results,
        columns: vec!["bed_top".to_owned()],
        quantities: Vec::new(),
        statistic: "last".to_owned(),
        from: None,
        to: None,
        last: None,
        points: false,
        confidence: 0.95,
        output: Some(desk.path("summary")),
    };
    crate::study::summary(&options).unwrap();
    let read = |name| std::fs::read_to_string(desk.path("summary").join(name)).unwrap();
    let rows = |text: &str| text.lines().filter(|line| !line.starts_with('#')).count();
    assert_eq!((rows(&read("runs.csv")), rows(&read("points.csv"))), (9, 5));
    let numbers = |line: &str| line.split(',').skip(3).map(str::to_owned).collect::<Vec<_>>();
    let of_study = desk.tables();
    let point = of_study.lines().find(|line| line.starts_with("1,2,0.1,2,")).unwrap();
    let points = read("points.csv");
    let same = points.lines().find(|line| line.starts_with("2,0.1,2,")).unwrap();
    assert_eq!(numbers(same), numbers(point)[1..]);
    options.columns = vec!["bed_tip".to_owned()];
    assert!(crate::study::summary(&options).unwrap_err().to_string().contains("no such column"));
    for (name, message) in [
        ("bed.hight", "of talcum analyse: did you mean bed.height?"),
        ("hight", "no number of talcum analyse"),
        ("waves.state", "is a text"),
    ] {
        options.quantities = vec![name.to_owned()];
        options.columns.clear();
        let refused = crate::study::summary(&options).unwrap_err().to_string();
        assert!(refused.contains(message), "{name}: {refused}");
    }
}
