//! Meaning of a case file: conversions of dimensionless groups, stages, schedules, overrides.

#![allow(clippy::unwrap_used, reason = "in tests a panic is the report")]

use std::f64::consts::PI;
use std::path::Path;
use talcum::case::{Case, FILE_KEYS, RankLayout};
use talcum::contact::VanDerWaals;
use talcum::domain::{Face, WallShape};
use talcum::gas::{DragLaw, Drive, GasModel};
use talcum::numbers::Schedule;

fn read(name: &str, overrides: &[&str]) -> Result<Case, String> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases/good").join(name);
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    Case::read(&file, &overrides).map_err(|errors| errors.to_string())
}

fn close(a: f64, b: f64) -> bool {
    (a / b - 1.0).abs() < 1.0e-12
}

#[test]
fn groups_become_quantities() {
    let case = read("cohesive-column.toml", &["cohesion.wall_bond_number=40"]).unwrap();
    let stage = &case.stages[0];
    let cohesion: &VanDerWaals = stage.physics.cohesion.as_ref().unwrap().first();
    let now = cohesion.at(0.0);
    // Bo = F / (m g) with m = pi/6, g = 1, for both.
    assert!(close(now.between_particles(0.5, 0.5, 0.0), 20.0 * PI / 6.0));
    assert!(close(now.to_wall(0.5, 0.0), 40.0 * PI / 6.0));
    let gas = stage.physics.gas.column().unwrap();
    assert!(close(gas.viscosity, 1.0 / 55.0));
    assert_eq!(gas.spacing, 1.5);
    let vibration = stage.physics.gravity.vibration.unwrap();
    assert_eq!((vibration.relative_acceleration, vibration.frequency), (3.0, 0.16));
    assert_eq!(case.wall_clock.unwrap().as_secs(), 13_800);
    assert_eq!(case.domain.bounds.faces(2), [Face::Wall, Face::Stop]);
    assert_eq!(case.domain.walls[0].name, "base plate");
}

#[test]
fn rough_and_square_forces_have_the_bond_numbers_that_are_given() {
    let attraction = |name: &str, overrides: &[&str]| {
        let case = read(name, overrides).unwrap();
        case.stages[0].physics.cohesion.as_ref().unwrap().first().at(0.0)
    };
    let weight = PI / 6.0;
    let square = attraction("square-force.toml", &[]);
    for separation in [0.0, 0.0099] {
        assert!(close(square.between_particles(0.5, 0.5, separation), 20.0 * weight));
        assert!(close(square.to_wall(0.5, separation), 1.5));
    }
    assert_eq!(square.between_particles(0.5, 0.5, 0.0101), 0.0);
    let unstated = ["contact.softening=unstated"];
    let rough = attraction("rough-and-softened.toml", &unstated);
    assert!(close(rough.between_particles(0.5, 0.5, 0.0), 20.0 * weight));
    // Beyond the cut-off the asperity, which is smaller, falls faster than a sphere.
    let smooth = attraction("cohesive-column.toml", &[]);
    let at = |it: &talcum::contact::VanDerWaalsNow| it.between_particles(0.5, 0.5, 1.0e-3);
    assert!(at(&rough) > 10.0 * at(&smooth), "the sphere behind the asperity counts there");
}

#[test]
fn softened_particles_keep_the_force_or_the_work() {
    let of = |overrides: &[&str]| {
        let softening = ["contact.softening=keeps_work", "contact.stiffness_reduction=100"];
        let all: Vec<&str> = softening.iter().chain(overrides).copied().collect();
        let case = read("cohesive-column.toml", &all).unwrap();
        case.stages[0].physics.cohesion.as_ref().unwrap().first().at(0.0)
    };
    let (force, weight) =
        (|it: &talcum::contact::VanDerWaalsNow| it.between_particles(0.5, 0.5, 0.0), PI / 6.0);
    let work = |it: &talcum::contact::VanDerWaalsNow| -it.energy_of_particles(0.5, 0.5, 0.0);
    let given = of(&["contact.softening=keeps_force"]);
    assert!(close(force(&given), 20.0 * weight));
    let scaled = of(&[]);
    assert!(close(force(&scaled), 2.0 * weight), "{}", force(&scaled) / weight);
    // The cut-off is found to rounding; energies are differences of numbers a thousand times as large.
    assert!((work(&scaled) / work(&given) - 1.0).abs() < 1.0e-10);
    let hertz = of(&[
        "contact.law=hertz_mindlin",
        "contact.young_modulus=1e7",
        "contact.poisson_ratio=0.3",
    ]);
    assert!(close(force(&hertz), 20.0 * weight * 100.0_f64.powf(-0.4)));
}

#[test]
fn a_rolling_friction_of_0_is_none() {
    let kinds: [&[&str]; 2] = [
        &["contact.rolling=constant_torque"],
        &["contact.rolling=elastic_plastic", "contact.rolling_damping=0.3"],
    ];
    for kind in kinds {
        let rolling = |coefficient: &str| {
            let case = read("cohesive-column.toml", &[kind, &[coefficient]].concat()).unwrap();
            case.stages[0].physics.contact.first().rolling
        };
        assert_eq!(rolling("contact.rolling_friction=0.0"), None);
        assert!(rolling("contact.rolling_friction=0.01").is_some()); // a control
    }
}

#[test]
fn groups_become_quantities_in_si_too() {
    let case = read("si.toml", &["cohesion.bond_number=20", "gas.stokes_number=55"]).unwrap();
    let (d, rho, g) = (5.0e-5_f64, 900.0, 9.81);
    let now = case.stages[0].physics.cohesion.as_ref().unwrap().first().at(0.0);
    let weight = rho * PI / 6.0 * d.powi(3) * g;
    // The full expression tends to the near-contact one as s/r falls, here 2e-5.
    assert!((now.between_particles(0.5 * d, 0.5 * d, 0.0) / weight / 20.0 - 1.0).abs() < 1.0e-4);
    let viscosity = case.stages[0].physics.gas.column().unwrap().viscosity;
    assert!(close(rho * g.sqrt() * d.powf(1.5) / viscosity, 55.0));
    assert_eq!(case.domain.walls.len(), 6);
    let WallShape::Plane { normal, .. } = case.domain.walls[5].shape else { panic!("a plane") };
    assert!(close(normal.norm(), 1.0));
}

#[test]
fn stages_change_what_they_name_and_keep_the_rest() {
    let case = read("staged.toml", &[]).unwrap();
    let [settle, ramp, cohesive] = case.stages.as_slice() else { panic!("three stages") };
    assert_eq!([settle.start, settle.end, ramp.end, cohesive.end], [0.0, 1.0, 3.0, 6.0]);
    assert!(settle.physics.gas == GasModel::None && settle.physics.cohesion.is_none());
    assert!(ramp.physics.cohesion.is_none());
    let ramped = Schedule::Ramp { from: 0.0, to: 0.04, start: 1.0, end: 3.0 };
    for stage in [ramp, cohesive] {
        assert_eq!(stage.physics.gas.column().unwrap().drive, Drive::Velocity(ramped.clone()));
    }
    let cohesion = cohesive.physics.cohesion.as_ref().unwrap().first();
    let steps = Schedule::Steps { values: vec![1.0e-10, 2.0e-10], start: 3.0, every: 1.5 };
    assert_eq!(cohesion.hamaker_constant, steps);
    assert_eq!(cohesion.wall_hamaker_constant, Schedule::Constant(0.0));
    let vibration = cohesive.physics.gravity.vibration.unwrap();
    assert_eq!(vibration.start, 3.0);
    assert!(close(vibration.relative_acceleration, 0.1 * (0.4 * PI).powi(2)));
    assert_eq!(case.end_time(), 6.0);
    let at = |time| case.stage_at(time).name.as_str();
    assert_eq!([at(0.0), at(0.9), at(1.0), at(9.0)], ["settle", "settle", "ramp", "cohesive"]);
}

#[test]
fn a_step_belongs_to_the_stage_of_its_middle() {
    let case = read("staged.toml", &[]).unwrap();
    // The time of a run is a sum of steps, which rounding can leave just below the start of a stage at 1.
    let step = case.stages[0].physics.time_step;
    for time in [1.0 - f64::EPSILON, 1.0 - 0.4 * step, 1.0 + 0.4 * step] {
        assert_eq!(case.stage_at(time).name, "ramp", "{time}");
    }
    assert_eq!(case.stage_at(1.0 - step).name, "settle");
}

#[test]
fn another_word_drops_the_keys_that_only_the_old_one_has() {
    let overrides = [
        "gas.voidage_exponent=2.7",
        "stage.cohesive.gas.drag=gidaspow",
        "stage.cohesive.gas.drag_switch=sharp",
        "stage.cohesive.gas.density=1.2",
    ];
    let case = read("staged.toml", &overrides).unwrap();
    let [_, ramp, cohesive] = case.stages.as_slice() else { panic!("three stages") };
    assert!(matches!(ramp.physics.gas.column().unwrap().drag, DragLaw::WenYuCreeping(_)));
    assert!(matches!(cohesive.physics.gas.column().unwrap().drag, DragLaw::Gidaspow(_)));
    let law = ["contact.law=hertz_mindlin", "contact.young_modulus=1e7"];
    let case = read("plain.toml", &law).unwrap();
    assert!(!case.text.contains("normal_stiffness") && case.text.contains("restitution"));
    // Negative control: a key that is set together with the new word must be right.
    let error = read("plain.toml", &[law[0], law[1], "contact.friction_cap=net"]).unwrap_err();
    assert!(error.contains("law \"hertz_mindlin\" has no use for it"), "{error}");
}

#[test]
fn a_key_that_was_renamed_is_refused_with_its_present_name() {
    let name = "adhesive-elastic-plastic.toml";
    let error = read(name, &["contact.bond_number=4"]).unwrap_err();
    let expected =
        "--set contact.bond_number=4: contact.bond_number = 4: is now contact.adhesion_over_weight";
    assert!(error.ends_with(expected) && error.lines().count() == 1, "{error}");
    // The present name takes the place of the former one, in a checkpoint too, whose text nobody can edit.
    let bad = "../bad/renamed-keys.toml";
    let set = ["contact.adhesion_over_weight=20", "contact.wall.adhesion_over_weight=0"];
    let of = |case: Case| case.stages[0].physics.contact.first().law.clone();
    assert_eq!(of(read(bad, &set).unwrap()), of(read(name, &[]).unwrap()));
    // Negative control.
    assert!(read(bad, &set[..1]).unwrap_err().contains("contact.wall.bond_number = 0: is now"));
}

#[test]
fn the_grid_of_a_periodic_box_divides_it() {
    let case = read("periodic-box.toml", &[]).unwrap();
    assert!(close(case.stages[0].physics.gas.column().unwrap().spacing, 18.0 / 13.0));
    assert!(case.notes.iter().any(|note| note.contains("gas.spacing = 1.4 becomes 1.38")));
    assert!(case.notes.iter().any(|note| note.contains("gas.lateral_drag is not given: false")));
}

#[test]
fn overrides_change_the_case_and_its_text() {
    let overrides = ["stage.ramp.duration=5", "parallel.axis=x", "stage.2.gas=\"off\""];
    let case = read("staged.toml", &overrides).unwrap();
    assert_eq!(case.end_time(), 9.0);
    assert_eq!(case.parallel.layout, RankLayout::Slabs(0));
    assert_eq!(case.stages[1].physics.gas, GasModel::None);
    let again = Case::from_text(&case.text, "again", Path::new("."), &[]).unwrap();
    assert_eq!(again.stages, case.stages);
    let error = read("staged.toml", &["contact.restitution=1.4", "time.end=9"]).unwrap_err();
    let lines: Vec<&str> = error.lines().collect();
    assert_eq!(lines.len(), 2);
    let expected = "good/staged.toml, --set contact.restitution=1.4: contact.restitution = 1.4: must be above 0 and at most 1";
    assert!(lines[0].ends_with(expected), "{error}");
}

#[test]
fn a_file_that_cannot_be_read_is_an_error() {
    let error = Case::read(Path::new("nowhere/case.toml"), &[]).unwrap_err().to_string();
    assert!(error.starts_with("nowhere/case.toml: cannot be read: "), "{error}");
}

/// The words that a key of `[gas]` may have, from the schema: a new one is tested without another line here.
fn words_of_gas(key: &str) -> Vec<String> {
    let schema: serde_json::Value = serde_json::from_str(&FILE_KEYS.json_schema()).unwrap();
    let words = &schema["definitions"]["gas"]["properties"][key]["enum"];
    words.as_array().unwrap().iter().map(|word| word.as_str().unwrap().to_owned()).collect()
}

#[test]
fn every_drag_law_can_be_chosen() {
    let laws = words_of_gas("drag");
    assert!(laws.len() >= 7);
    for law in laws {
        let chosen = format!("gas.drag={law}");
        let mut overrides = vec![chosen.as_str()];
        overrides.extend((law != "wen_yu_creeping").then_some("gas.density=0.001"));
        overrides.extend((law == "gidaspow").then_some("gas.drag_switch=sharp"));
        overrides.extend((law == "di_felice").then_some("gas.single_sphere=dallavalle"));
        let case = read("staged.toml", &overrides).unwrap_or_else(|error| panic!("{law}: {error}"));
        let drag = format!("{:?}", case.stages[1].physics.gas.column().unwrap().drag);
        let name = drag.split(['(', ' ']).next().unwrap().to_lowercase();
        assert_eq!(name, law.replace('_', ""), "{drag}");
    }
}

#[test]
fn classes_have_their_densities() {
    let classes = "particles.diameter={ values = [1.0, 1.0], fractions = [0.5, 0.5], densities = [1.0, 3.0] }";
    let case = read("cohesive-column.toml", &[classes, "particles.seed=1"]).unwrap();
    let particles = &case.particles;
    assert!(close(particles.mean_density(), 2.0));
    let masses = (0..1000).map(|id| particles.mass_of_particle(id, 1.0));
    let classes: Vec<usize> =
        masses.clone().map(|mass| particles.class_number(1.0, mass, 0).unwrap()).collect();
    assert!(
        masses
            .zip(&classes)
            .all(|(mass, &class)| mass == particles.mass_of(1.0) * [1.0, 3.0][class])
    );
    // 4 standard deviations of the number of heavy ones.
    let heavy = classes.iter().sum::<usize>();
    assert!(heavy.abs_diff(500) < 64, "{heavy}");
    // Contacts of the light ones are the shortest, and the heaviest decide the limits.
    assert_eq!(case.size_range().unwrap().largest_mass, 3.0 * particles.mass_of(1.0));
    // The control: without densities, all weigh the same.
    let plain = read("cohesive-column.toml", &[]).unwrap();
    assert!((0..9).all(|id| plain.particles.mass_of_particle(id, 1.0) == particles.mass_of(1.0)));
}
