//! Runs that begin with the ends of another study.

use super::fakes::{CASE, Desk, FakeRunner, Physics, number};

/// A desk whose study begins with the ends of `poured.toml`, which has the seeds 1 and 2.
fn desk(study: &str) -> Desk {
    let desk = Desk::new("");
    let measure = "[measure.top]\ncolumn = \"bed_top\"\nstatistic = \"last\"\n";
    let poured = format!("title = \"p\"\ncase = \"bed.toml\"\nseeds = 2\n{measure}");
    std::fs::write(desk.path("poured.toml"), poured).unwrap();
    let branch = CASE.replace("kind = \"lattice\"", "kind = \"run\"\npath = \"poured.h5\"");
    std::fs::write(desk.path("branch.toml"), branch).unwrap();
    let results = desk.path("poured").display().to_string();
    let start = format!("[start]\nstudy = \"poured.toml\"\nresults = {results:?}\n");
    let text = format!("title = \"t\"\ncase = \"branch.toml\"\n{study}{start}{measure}");
    std::fs::write(desk.path("study.toml"), text).unwrap();
    desk
}

const AXIS: &str = "seeds = 2\n[[axis]]\nkey = \"cohesion.bond_number\"\nvalues = [2, 4]\n";
const HEIGHT: Physics = |keys| Ok(number(keys, "cohesion.bond_number"));

#[test]
fn each_run_begins_with_the_end_of_the_same_seed() {
    let desk = desk(AXIS);
    let refusal = desk.refusal();
    assert!(
        refusal.contains("study.toml:7: start.study: ") && refusal.contains("is not complete"),
        "{refusal}"
    );

    desk.work_on("poured.toml", "poured", &FakeRunner::new(HEIGHT));
    assert_eq!(desk.refusal(), "");
    desk.work(&FakeRunner::new(HEIGHT), None);
    let tables = desk.tables();
    let row = tables.lines().find(|line| line.contains(",4,2,complete,")).unwrap();
    let began = row.split(',').nth(6).unwrap();
    assert!(began.starts_with("seed=2__"), "{tables}");
    let run = desk.path("out/runs").join(row.split(',').next().unwrap());
    let case = std::fs::read_to_string(run.join("case.toml")).unwrap();
    let expected = format!("poured/runs/{began}/checkpoint-000000000001.h5");
    assert!(case.contains(&expected), "{case}");
    assert!(case.contains("begins with the end of seed=2__"), "{case}");
    // Complete runs are recognised again, and the place of the other study does not affect any result.
    let again = FakeRunner::new(HEIGHT);
    desk.work(&again, None);
    assert_eq!(again.started.borrow().len(), 0);
}

#[test]
fn another_bed_is_another_run() {
    let desk = desk(AXIS);
    let names = || desk.with_session(|session| session.plan.tasks[0].name.clone());
    let before = names();
    let bed = CASE.replace("count = 10", "count = 11");
    std::fs::write(desk.path("bed.toml"), bed).unwrap();
    assert_ne!(names(), before);
}

#[test]
fn seeds_that_the_other_study_lacks_are_refused() {
    let desk = desk(&AXIS.replace("seeds = 2", "seeds = [1, 7]"));
    let refusal = desk.refusal();
    assert!(refusal.contains("start.study: ") && refusal.contains("has no seed 7"), "{refusal}");
}

#[test]
fn the_other_study_has_one_run_for_each_seed() {
    let desk = desk(AXIS);
    let poured = std::fs::read_to_string(desk.path("poured.toml")).unwrap();
    let text = poured.replace("seeds = 2\n", AXIS);
    std::fs::write(desk.path("poured.toml"), text).unwrap();
    let refusal = desk.refusal();
    assert!(refusal.contains("must have one run for each seed"), "{refusal}");
    std::fs::write(desk.path("poured.toml"), "title = 3\n").unwrap();
    assert!(desk.refusal().contains("start.study: is refused: "), "{}", desk.refusal());
}
