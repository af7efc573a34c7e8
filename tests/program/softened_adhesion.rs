//! `talcum check` prints the contribution of a softened spring to the work of separation, for every contact law, and
//! warns above 0.1.

use crate::launch::talcum;
use std::path::Path;
use talcum::contact::ContactLaw;

/// What `check` prints of a good case with overrides.
fn check(name: &str, overrides: &[&str]) -> String {
    let case = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases/good").join(name);
    let case = case.display().to_string();
    let set = overrides.iter().flat_map(|text| ["--set", text]);
    let arguments: Vec<&str> =
        ["check", &case, "--ranks", "1,1,1"].into_iter().chain(set).collect();
    let ended = talcum(0, &arguments);
    assert_eq!(ended.code(), Some(0), "{ended:?}");
    ended.output
}

const WARNING: &str = "the soft spring adds";

/// The number after a text.
fn number_after(text: &str, before: &str) -> f64 {
    let rest = text.split_once(before).unwrap_or_else(|| panic!("{before}: {text}")).1.trim_start();
    let end = rest.find([' ', ',', ';', '\n']).unwrap_or(rest.len());
    rest[..end].parse().unwrap()
}

#[test]
fn check_prints_the_springs_part_of_moons_law_and_warns_above_a_tenth() {
    // F0 / (4 k delta) with F0 = Bo pi / 6, delta = 8e-6; k_n = 2e5, and ten times that.
    for (bond_number, expected) in [("4", 0.327), ("8", 0.654), ("20", 1.636)] {
        let set = format!("cohesion.bond_number={bond_number}");
        let soft = check("cohesive-column.toml", &[&set]);
        let part = number_after(&soft, "the spring's part ");
        // Three digits, and the range of 1250 cut-offs, beyond which 4e-4 of the surface's work is left out.
        assert!((part / expected - 1.0).abs() < 3.0e-3, "{soft}");
        assert!(soft.contains(WARNING), "{soft}");
        let real = ["contact.softening=keeps_force", "contact.stiffness_reduction=10"];
        let stated = check("cohesive-column.toml", &[&set, real[0], real[1]]);
        let at_real = number_after(&stated, "at the real stiffness ");
        assert!((at_real / (0.1 * expected) - 1.0).abs() < 2.0e-2, "{stated}");
        // (1 + 10 x) / (1 + x) - 1 of the work, x the real part: more than a tenth.
        assert!(stated.contains(WARNING), "{stated}");
        let kept = check("cohesive-column.toml", &[&set, "contact.softening=keeps_work", real[1]]);
        assert!(!kept.contains(WARNING), "{kept}");
    }
    // Negative control: a stiff spring passes.
    let stiff = ["cohesion.bond_number=4", "contact.normal_stiffness=2e6", "time.step=5e-5"];
    let stiff = check("cohesive-column.toml", &stiff);
    assert!(!stiff.contains(WARNING) && stiff.contains("the spring's part 0.033"), "{stiff}");
}

#[test]
fn check_prints_the_work_of_parting_of_every_law_with_adhesion() {
    let cases = [
        ("cohesive-column.toml", "linear_spring_dashpot"),
        ("adhesive-elastic-plastic.toml", "adhesive_elastic_plastic"),
        ("jkr-round-column.toml", "jkr"),
    ];
    let cohesive = |law: &str, keys: &[&str]| {
        let law = format!("contact.law={law}");
        let all: Vec<&str> = std::iter::once(law.as_str()).chain(keys.iter().copied()).collect();
        check("cohesive-column.toml", &all)
    };
    let hertz = ["contact.young_modulus=1e7", "contact.poisson_ratio=0.3", "time.step=2e-5"];
    let hysteretic = [
        "contact.unloading_stiffness=2e5",
        "contact.loading_stiffness=1.5e5",
        "contact.adhesion_stiffness=1e4",
        "contact.wall={ adhesion_stiffness = 0.0 }",
    ];
    let mut outputs =
        vec![cohesive("hertz_mindlin", &hertz), cohesive("linear_hysteretic", &hysteretic)];
    outputs.extend(cases.iter().map(|(name, _)| check(name, &[])));
    // All laws of the registry: the two above and the three cases.
    assert_eq!(outputs.len(), ContactLaw::NAMES.len());
    for output in outputs {
        assert!(number_after(&output, "work of separation") > 0.0, "{output}");
    }
    // Where all of the work depends on the stiffness it is compared with the real particles': E^(2/3) of JKR.
    let softened = ["contact.softening=keeps_force", "contact.stiffness_reduction=1000"];
    let jkr = check("jkr-round-column.toml", &softened);
    assert!((number_after(&jkr, "the stiffness; ") - 100.0).abs() < 0.5, "{jkr}");
    assert!(jkr.contains(WARNING));
    // Negative control: without adhesion there is nothing to print.
    let plain = check("plain.toml", &[]);
    assert!(!plain.contains("work of separation"), "{plain}");
}
