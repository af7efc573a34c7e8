//! Which points and tasks a study expands to, and how its runs are named.

use super::fakes::Desk;
use crate::study::setting::Setting;
use crate::study::task::Task;

/// All settings of all runs, and their names.
fn members(study: &str) -> Vec<(String, String)> {
    Desk::new(study).with_session(|session| {
        let members = session.plan.tasks.iter().flat_map(Task::planned);
        let text = |settings: &[Setting]| {
            settings.iter().map(Setting::argument).collect::<Vec<_>>().join(" ")
        };
        members.map(|member| (text(&member.settings), member.name.clone())).collect()
    })
}

const AXES: &str = "[[axis]]\nkey = \"cohesion.bond_number\"\nvalues = [2, 4.0]\n[[axis]]\nkey = \"gas.superficial_velocity\"\nrange = { from = 0.1, to = 0.3, step = 0.1 }\n";

#[test]
fn a_grid_with_seeds() {
    let all = members(&format!("seeds = [7, 9]\n{AXES}"));
    assert_eq!(all.len(), 12);
    let first = "cohesion.bond_number=2 gas.superficial_velocity=0.1 particles.seed=7";
    assert_eq!(all[0].0, first);
    assert_eq!(all[1].0, first.replace("seed=7", "seed=9"));
    // 0.1 + 2 * 0.1 is 0.3, not 0.30000000000000004.
    assert!(all[11].0.contains("bond_number=4.0 gas.superficial_velocity=0.3 "), "{}", all[11].0);
    assert!(all[0].1.starts_with("bond_number=2__superficial_velocity=0.1__seed=7__"));
}

#[test]
fn a_study_without_axes_is_one_run() {
    let all = members("");
    assert_eq!(all.len(), 1);
    assert!(all[0].1.starts_with("run__"), "{}", all[0].1);
}

#[test]
fn keys_move_together_and_single_values_are_not_named() {
    let all = members(
        "[[axis]]\nname = \"powder\"\nkeys = [\"cohesion.bond_number\", \"time.end\"]\nvalues = [[1.5, 4.0], [2.5, 5.0]]\n\
         [[axis]]\nkey = \"gas.superficial_velocity\"\nvalues = [0.2]\n",
    );
    assert_eq!(all.len(), 2);
    assert_eq!(all[1].0, "cohesion.bond_number=2.5 time.end=5.0 gas.superficial_velocity=0.2");
    assert!(all[1].1.starts_with("bond_number=2.5__end=5__"), "{}", all[1].1);
}

#[test]
fn ranges_count_or_step_on_either_scale() {
    let values = |range: &str| {
        let study = format!("[[axis]]\nkey = \"cohesion.bond_number\"\nrange = {range}\n");
        let all = members(&study).into_iter();
        all.map(|(settings, _)| settings.split('=').nth(1).unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(values("{ from = 1, to = 7, step = 3 }"), ["1", "4", "7"]);
    assert_eq!(
        values("{ from = 0.0, to = 1.0, count = 5 }"),
        ["0.0", "0.25", "0.5", "0.75", "1.0"]
    );
    let scale = "{ from = 0.01, to = 100.0, count = 5, scale = \"logarithmic\" }";
    assert_eq!(values(scale), ["0.01", "0.1", "1.0", "10.0", "100.0"]);
    assert_eq!(values("{ from = 3.0, to = 1.0, step = -1.0 }"), ["3.0", "2.0", "1.0"]);
}

#[test]
fn names_do_not_change_when_values_are_added() {
    let short = members(&format!("seeds = 2\n{AXES}"));
    let long = members(&format!("seeds = 3\n{}", AXES.replace("[2, 4.0]", "[1, 2, 4.0]")));
    assert!(short.iter().all(|member| long.contains(member)));
    let mut names: Vec<&String> = long.iter().map(|(_, name)| name).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), long.len());
}

#[test]
fn schedules_are_values_and_sections_are_paths() {
    let desk = Desk::new(
        "[set]\n\"time.end\" = 8.0e0\ngas.superficial_velocity = { from = 0.0, to = 0.2 }\n[set.cohesion]\nbond_number = 3\n",
    );
    let study = desk.read().unwrap();
    let all: Vec<String> = study.common.iter().map(Setting::argument).collect();
    let expected = [
        "time.end=8.0e0",
        "gas.superficial_velocity={ from = 0.0, to = 0.2 }",
        "cohesion.bond_number=3",
    ];
    assert_eq!(all, expected);
    assert_eq!(study.common[2].line, 7);
}

#[test]
fn a_chain_is_one_task_for_each_point_of_the_other_axes() {
    let study = format!("seeds = 2\n{AXES}[continuation]\naxis = \"cohesion.bond_number\"\n");
    Desk::new(&study).with_session(|session| {
        assert_eq!(session.plan.tasks.len(), 6);
        let chain = session.plan.tasks[0].planned();
        assert_eq!(chain.len(), 2);
        assert_eq!(chain[1].predecessor.as_ref(), Some(&chain[0]));
        let request = session.factory.request(&chain[1].settings, Some(&chain[0]), None);
        assert_eq!(request.case, session.folder.continued_case());
        let start = request.settings.last().unwrap();
        assert_eq!(start.key, "particles.start.path");
        assert!(start.value.plain().contains(&chain[0].name));
    });
}

#[test]
fn a_ramp_up_and_down_has_runs_of_their_own() {
    let study = "[[axis]]\nkey = \"cohesion.bond_number\"\nvalues = [2, 4, 2]\n[continuation]\naxis = \"cohesion.bond_number\"\n";
    let all = members(study);
    assert_eq!(all[0].0, all[2].0);
    assert_ne!(all[0].1, all[2].1);
}
