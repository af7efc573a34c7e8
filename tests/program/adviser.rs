//! Advice of `talcum check`: numbers by which a user recognises whether a bed is as intended, and warnings, each
//! compared with a case without it.

use crate::launch::{Ended, in_repository, smoke, talcum};

/// Checks a smoke case with these keys changed.
fn check(name: &str, changes: &[&str]) -> Ended {
    let case = smoke(name);
    let set = changes.iter().flat_map(|&change| ["--set", change]);
    talcum(0, &["check", &case].into_iter().chain(set).collect::<Vec<_>>())
}

/// Whether a case is warned of in these words.
fn warns(ended: &Ended, words: &str) -> bool {
    let mut warnings = ended.output.lines().filter(|line| line.trim_start().starts_with("warning"));
    warnings.any(|line| line.contains(words))
}

/// A warning that these changes bring, and the case without them does not.
fn warned_only_with(name: &str, changes: &[&str], words: &str) {
    let usual = check(name, &[]);
    assert_eq!(usual.code(), Some(0), "{usual:?}");
    assert!(!warns(&usual, words), "{}", usual.output);
    let changed = check(name, changes);
    assert!(warns(&changed, words), "{}\n{}", changed.output, changed.errors);
}

#[test]
fn numbers_of_the_bed_and_the_gas_are_printed_with_their_units() {
    let output = check("fluidised", &[]).output;
    for expected in [
        "the bed at rest",
        "density of solid over gas",
        "Archimedes number",
        "Stokes number",
        "terminal velocity of a particle",
        "superficial velocity",
        "Reynolds number at U_mf",
        "overlap under the bed's weight",
        "overlap of an impact",
        " m/s at phi 0.60",
    ] {
        assert!(output.contains(expected), "{expected}: {output}");
    }
    let output = check("rank-equality", &[]).output;
    for expected in
        ["pull-off force ", "work of separation ", "impacts stick ", " sqrt(g d) at phi 0.60"]
    {
        assert!(output.contains(expected), "{expected}: {output}");
    }
}

#[test]
fn a_box_in_another_unit_than_the_diameter_is_warned_of() {
    let changes = ["box.lengths=[5000.0, 5000.0, 60.0]", "gas.spacing=1.5"];
    warned_only_with("rank-equality", &changes, "in the same unit?");
}

#[test]
fn a_bed_of_few_cells_is_warned_of() {
    let words = "cells of the gas high";
    // 0.85 cells of a bed 1.8 cells high, and 0.85 sqrt(1 + (3/4 4/3)^2) of them with a filter of four thirds of a cell.
    let unfiltered = check("fluidised", &[]);
    assert!(warns(&unfiltered, words) && unfiltered.output.contains("takes some 47 %"));
    assert!(check("fluidised", &["gas.filter_width=1.6e-4"]).output.contains("takes some 66 %"));
    assert!(!warns(&check("fluidised", &["gas.cells=[4, 4, 60]"]), words));
    // Finer cells for the drag alone take less, and are advised; not where they are given.
    let advice = "gas.local_voidage =";
    assert!(warns(&unfiltered, advice));
    let local = check("fluidised", &["gas.local_voidage=4"]);
    assert!(!warns(&local, "takes some 47 %") && !warns(&local, advice), "{}", local.output);
}

#[test]
fn cells_of_single_layers_are_warned_of() {
    warned_only_with("fluidised", &["gas.local_voidage=8"], "see single layers");
}

/// 16 % of a powder of 40 um in cells of 3 diameters (docs/verification.md).
#[test]
fn cells_in_which_a_lone_particle_falls_too_fast_are_warned_of() {
    let words = "gas.undisturbed_velocity corrects this";
    // The case has a fifth of the law's drag.
    warned_only_with("fluidised", &["gas.drag_factor=1.0"], words);
    let with = check("fluidised", &["gas.drag_factor=1.0", "gas.undisturbed_velocity=true"]);
    assert_eq!(with.code(), Some(0), "{with:?}");
    assert!(!warns(&with, words), "{}", with.output);
}

/// Drag from agglomerates refuses the key that would be advised.
#[test]
fn nothing_is_said_of_a_lone_particle_where_drag_follows_from_agglomerates() {
    let case = in_repository("tests/cases/good/agglomerate-drag.toml").display().to_string();
    let check = |more: &[&str]| {
        let arguments = ["check", &case, "--set", "parallel.ranks=[1, 1, 1]"];
        talcum(0, &[&arguments[..], more].concat())
    };
    let words = "gas.undisturbed_velocity corrects this";
    let one_factor = check(&["--set", "gas.drag_factor=1.0"]);
    assert!(warns(&one_factor, words), "{one_factor:?}");
    let of_agglomerates = check(&[]);
    assert_eq!(of_agglomerates.code(), Some(0), "{of_agglomerates:?}");
    assert!(!warns(&of_agglomerates, words), "{}", of_agglomerates.output);
    assert!(!of_agglomerates.output.contains("fall of a lone particle"));
}

#[test]
fn a_gas_as_dense_as_a_liquid_is_warned_of() {
    warned_only_with("fluidised", &["gas.density=1200.0"], "is its density right?");
}

#[test]
fn a_gas_in_which_particles_fly_is_warned_of() {
    warned_only_with("rank-equality", &["gas.superficial_velocity=120.0"], "single particle falls");
}

#[test]
fn springs_that_are_pressed_flat_are_warned_of() {
    warned_only_with("rank-equality", &["contact.normal_stiffness=5.0e2"], "more than 0.05");
}

/// The plate would begin at its largest acceleration; at four times the frequency a cycle is over when it begins.
#[test]
fn a_vibration_that_begins_in_the_middle_of_a_cycle_is_warned_of() {
    let later = |frequency| {
        let (off, on) = ("stage.settle.vibration=\"off\"", "stage.gas on.vibration=\"on\"");
        ["vibration.gamma=2.0", frequency, off, on]
    };
    let words = "begins at phase 0.250 of a cycle, so that the effective gravity jumps to 3.000 g";
    warned_only_with("staged", &later("vibration.frequency=0.25"), words);
    let whole = check("staged", &later("vibration.frequency=1.0"));
    assert_eq!(whole.code(), Some(0), "{whole:?}");
    assert!(!warns(&whole, "begins at phase"), "{}", whole.output);
}

/// A jet: the mean of the inflow keeps the Courant rule, the fastest cell does not.
#[test]
fn the_fastest_cell_of_an_inlet_counts_for_the_gas_step() {
    let profile = |fast: &str| format!("gas.inlet_profile=[{fast}{}]", ", 0.0".repeat(15));
    let words = "the gas step is too long";
    warned_only_with("fluidised", &[&profile("400.0")], words);
    assert!(!warns(&check("fluidised", &[&profile("1.0")]), words));
}

/// The first steps have no gas at all.
#[test]
fn a_later_stage_that_stops_at_once_is_warned_of() {
    let changes = ["stage.vibrate.gas.superficial_velocity=1.0e9"];
    warned_only_with("staged", &changes, "stage \"vibrate\", tried in a dense bed: ");
}
