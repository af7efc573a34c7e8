//! Studies that take runs from tables.

use super::fakes::{Desk, FakeRunner, number};
use crate::study::folder::StudyFolder;
use crate::study::known::KnownRuns;
use std::collections::BTreeMap;

const SEARCH: &str = "seeds = 3\n[bisection]\nkey = \"cohesion.bond_number\"\nbracket = [1.0, 9.0]\ntolerance = 0.25\nmeasure = \"top\"\nthreshold = 5.0\ndirection = \"falls\"\n";

fn falling(keys: &BTreeMap<String, String>) -> Result<f64, String> {
    Ok(9.3 - number(keys, "cohesion.bond_number") + 0.1 * number(keys, "particles.seed"))
}

/// The table of runs of a desk, written to a file in it.
fn kept_table(desk: &Desk) -> String {
    let tables = desk.tables();
    let end = tables.find("# title").unwrap() + 1;
    let end = tables[end..].find("# title").map_or(tables.len(), |place| end + place);
    tables[..end].to_owned()
}

/// A desk with the same study that has only this table.
fn desk_that_knows(study: &str, table: &str) -> Desk {
    let mut desk = Desk::new(study);
    std::fs::write(desk.path("known.csv"), table).unwrap();
    desk.known = Some("known.csv".to_owned());
    desk
}

#[test]
fn what_is_left_of_a_study_is_done_from_its_table() {
    let whole = Desk::new(SEARCH);
    let runner = FakeRunner::new(falling);
    whole.work(&runner, None);
    let all = runner.started.borrow().len();
    // All rows except the last ones: the search resumes where the table ends.
    let table = kept_table(&whole);
    let rows: Vec<&str> = table.lines().collect();
    let part = rows[..rows.len() - 3].join("\n") + "\n";
    for (table, left) in [(table.clone(), 0), (part, 3)] {
        let desk = desk_that_knows(SEARCH, &table);
        let runner = FakeRunner::new(falling);
        desk.work(&runner, None);
        assert_eq!(runner.started.borrow().len(), left, "of {all}");
        assert_eq!(desk.tables(), whole.tables());
    }
}

#[test]
fn runs_of_another_case_are_made() {
    let whole = Desk::new(SEARCH);
    whole.work(&FakeRunner::new(falling), None);
    let desk = desk_that_knows(SEARCH, &kept_table(&whole));
    let case = super::fakes::CASE.replace("count = 10", "count = 11");
    std::fs::write(desk.path("bed.toml"), case).unwrap();
    let runner = FakeRunner::new(falling);
    desk.work(&runner, None);
    assert!(!runner.started.borrow().is_empty());
}

#[test]
fn a_run_that_is_here_is_taken_before_its_row() {
    let desk = Desk::new("seeds = 1\n");
    desk.work(&FakeRunner::new(falling), None);
    let changed = kept_table(&desk).replace("0123", "4567");
    assert!(changed.contains("4567"));
    let mut desk = desk;
    std::fs::write(desk.path("known.csv"), changed).unwrap();
    desk.known = Some("known.csv".to_owned());
    assert!(!desk.tables().contains("4567"));
}

#[test]
fn tables_that_do_not_fit_are_refused() {
    let desk = Desk::new("seeds = 1\n");
    desk.work(&FakeRunner::new(falling), None);
    let table = kept_table(&desk);
    let refusal = |table: &str| {
        let path = desk.path("known.csv");
        std::fs::write(&path, table).unwrap();
        KnownRuns::read(&[path], &desk.read().unwrap().quantities).unwrap_err()
    };
    let (value, heading) = ("8.4", "bed_top");
    assert!(table.contains(value) && table.contains(heading), "{table}");
    let otherwise = table.replace("last of bed_top", "mean of bed_top");
    assert!(
        refusal(&otherwise)
            .contains("quantity top: last of bed_top: this is no quantity of the table")
    );
    for wrong in ["high", "inf", "-infinity", "nan"] {
        let expected = format!("top: {wrong} is not a finite number");
        assert!(refusal(&table.replace(value, wrong)).contains(&expected), "{wrong}");
    }
    assert!(
        refusal(&table.replace("identity_blake3", "hash")).contains("no column identity_blake3")
    );
    assert!(refusal("").contains("quantity top"));
    // A run that could not be measured is made again.
    std::fs::write(desk.path("known.csv"), table.replace(value, "")).unwrap();
    let known =
        KnownRuns::read(&[desk.path("known.csv")], &desk.read().unwrap().quantities).unwrap();
    let folder = StudyFolder::at(&desk.path("elsewhere")).with_known(known);
    desk.with_session(|session| {
        assert!(folder.known(&session.plan.tasks[0].planned()[0]).is_none());
    });
}
