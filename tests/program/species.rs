//! Several species in a case file: their mixed values, rejected cases, files of particles, runs and restarts.

use crate::launch::{checkpoints, in_repository, runs_of};
use std::path::Path;
use talcum::case::{BedPart, Case};
use talcum::contact::{ContactForceLaw, ContactLaw, FrictionCap, LinearSpringDashpot};

fn file() -> String {
    in_repository("tests/cases/good/two-species.toml").display().to_string()
}

fn read(overrides: &[&str]) -> Result<Case, String> {
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    Case::read(Path::new(&file()), &overrides).map_err(|errors| errors.to_string())
}

/// The law of k_n, e and mu, with the Poisson's ratio and the cap of the file.
fn law(stiffness: f64, restitution: f64, friction: f64) -> ContactLaw {
    let tangential = LinearSpringDashpot::tangential_stiffness_of(stiffness, 0.3);
    let cap = FrictionCap::Net;
    LinearSpringDashpot::new(stiffness, tangential, restitution, friction, cap).unwrap().into()
}

fn close(a: f64, b: f64) -> bool {
    (a / b - 1.0).abs() < 1.0e-12
}

#[test]
fn pairs_are_mixed_by_their_rules_unless_the_case_says_otherwise() {
    let case = read(&[]).unwrap();
    let physics = &case.stages[0].physics;
    let of = |pair| &physics.contact.of(pair).law;
    assert_eq!(of([0, 0]), &law(2.0e4, 0.9, 0.2));
    assert_eq!(of([1, 1]), &law(6.0e4, 0.9, 0.8));
    // Springs in series, the restitution of the [[pair]], and a geometric mean.
    let mixed = law(2.0 * 2.0e4 * 6.0e4 / (2.0e4 + 6.0e4), 0.7, f64::sqrt(0.2 * 0.8));
    assert_eq!(of([1, 0]), of([0, 1]));
    assert_eq!(of([0, 1]), &mixed);
    // At walls: the species' own, or that of [contact.wall].
    let at_walls = [0, 1].map(|species| &physics.at_walls[0].of(species).law);
    assert_eq!(at_walls, [&law(2.0e4, 0.9, 0.3), &law(6.0e4, 0.9, 0.5)]);
    let attraction = physics.cohesion_at(0.0).unwrap();
    let force = |pair| attraction.of(pair).between_particles(0.5, 0.5, 0.0);
    assert!(close(force([0, 1]), 2.0 * force([0, 0])) && close(force([1, 1]), 4.0 * force([0, 0])));
    // The control: the same constants for both leave one force.
    let alike = read(&["species.titania.cohesion.hamaker_constant=1.0e-8"]).unwrap();
    let attraction = alike.stages[0].physics.cohesion_at(0.0).unwrap();
    assert!(attraction.values().windows(2).all(|pair| pair[0] == pair[1]));
}

#[test]
fn elastic_laws_take_the_constants_of_both_bodies() {
    let text = std::fs::read_to_string(file()).unwrap();
    let text = text
        .replace(
            "law = \"linear_spring_dashpot\"\nnormal_stiffness = 2.0e4",
            "law = \"hertz_mindlin\"\nyoung_modulus = 1.0e6",
        )
        .replace("friction_cap = \"net\"\n", "")
        .replace("normal_stiffness = 6.0e4", "young_modulus = 3.0e6");
    let case = Case::from_text(&text, "hertz.toml", Path::new(""), &[]).unwrap();
    let stiffness = |pair| case.stages[0].physics.contact.of(pair).law.stiffness(1.0e-3, 0.25);
    // 1/E* adds up: E* of the pair is 2 / (1/E_1 + 1/E_2) of those of equal bodies.
    assert!(close(stiffness([1, 1]) / stiffness([0, 0]), 3.0));
    assert!(close(stiffness([0, 1]) / stiffness([0, 0]), 1.5));
}

#[test]
fn classes_and_files_say_the_species() {
    let case = read(&[]).unwrap();
    let bed = case.initial_bed(BedPart::WHOLE).unwrap();
    let ratio = |particle: &talcum::parallel::ParticleRecord| {
        particle.mass / case.particles.mass_of(2.0 * particle.radius)
    };
    let expected = |species: f64| if species == 0.0 { 1.0 } else { 1.9 };
    assert!(bed.particles.iter().all(|it| close(ratio(it), expected(it.species))));
    assert!(bed.particles.iter().any(|it| it.species == 0.0 && it.radius == 0.5));
    assert!(bed.particles.iter().any(|it| it.species == 1.0 && it.radius == 0.4));

    let folder = tempfile::tempdir().unwrap();
    let from_file = |name: &str, contents: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, contents).unwrap();
        let format = if name.ends_with("csv") { "csv" } else { "lammps" };
        let start = format!(
            "particles={{ density = 1.0, diameter = 1.0, start = {{ kind = \"file\", format = {format:?}, path = {path:?} }} }}"
        );
        let case = read(&[&start]).unwrap();
        let bed = case.initial_bed(BedPart::WHOLE).map_err(|error| error.to_string())?;
        Ok::<_, String>(bed.particles.iter().map(|it| (it.species, ratio(it))).collect::<Vec<_>>())
    };
    let rows = "id,x,y,z,species\n1,1,1,1,titania\n2,1,1,3,silica\n";
    let [(one, heavy), (other, light)] = from_file("bed.csv", rows).unwrap()[..] else { panic!() };
    assert!((one, other) == (1.0, 0.0) && close(heavy, 1.9) && close(light, 1.0));
    let dump =
        "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp ff\n0 6\n0 6\n0 30\n";
    let dump = |kind: &str| format!("{dump}ITEM: ATOMS id type x y z\n1 {kind} 1 1 1\n");
    assert!(close(from_file("bed.dump", &dump("2")).unwrap()[0].1, 1.9));
    for (name, contents, words) in [
        (
            "a.csv",
            "id,x,y,z,species\n1,1,1,1,gold\n".to_owned(),
            "a.csv:2: column species: \"gold\" is not a species: known are silica, titania",
        ),
        ("b.csv", "id,x,y,z\n1,1,1,1\n".to_owned(), "b.csv:2: there is no species"),
        (
            "c.dump",
            dump("3"),
            "c.dump:10: column type: \"3\" is not the number of a species, from 1 to 2",
        ),
    ] {
        let error = from_file(name, &contents).unwrap_err();
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn a_mixture_has_one_digest_on_any_ranks_and_through_a_restart() {
    let folder = tempfile::tempdir().unwrap();
    let run = runs_of(&file(), folder.path());
    let digest = run(0, "whole", &[]).digest();
    for ranks in [2, 3] {
        assert_eq!(run(ranks, &format!("{ranks}"), &[]).digest(), digest);
    }
    run(2, "parts", &["--until", "0.5"]).digest();
    assert_eq!(run(3, "parts", &["--resume"]).digest(), digest);
    // The control: another pair of laws is another run.
    let other = run(0, "other", &["--set", "pair.1.contact.restitution=0.4"]);
    assert_ne!(other.digest(), digest);
    // A case of one species cannot go on with a bed of two.
    let newest = checkpoints(&folder.path().join("whole")).pop().unwrap();
    let start = format!(
        "particles={{ density = 1.0, diameter = 1.0, start = {{ kind = \"run\", path = {newest:?} }} }}"
    );
    let plain = in_repository("tests/cases/good/plain.toml").display().to_string();
    let changes = ["--set", &start, "--set", "box.lengths=[6.0, 6.0, 30.0]"];
    let refused = runs_of(&plain, folder.path())(0, "refused", &changes);
    let words = "the bed at the start has 2 species: the case has 1";
    assert!(refused.error().contains(words), "{}", refused.errors);
}

/// A contact of a linear spring lasts pi sqrt(m* / k), m* = m_1 m_2 / (m_1 + m_2).
#[test]
fn check_prints_how_long_contacts_of_the_pairs_last_that_there_are() {
    let text = std::fs::read_to_string(file()).unwrap();
    let text = text.replace("values = [1.0, 0.8, 1.0]", "values = [1.0, 0.6, 0.6]").replace(
        "contact = { normal_stiffness = 6.0e4, friction = 0.8 }",
        "contact = { friction = 0.8 }",
    );
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("case.toml");
    std::fs::write(&case, text).unwrap();
    let ended = crate::launch::talcum(0, &["check", &case.display().to_string()]);
    assert_eq!(ended.code(), Some(0), "{ended:?}");
    let mass =
        |density: f64, diameter: f64| density * std::f64::consts::PI * diameter.powi(3) / 6.0;
    let (silica, titania) = (mass(1.0, 1.0), mass(1.9, 0.6));
    for (name, one, other, restitution) in [
        ("of silica ", silica, silica, 0.9),
        ("of silica and titania", titania, silica, 0.7),
        ("of titania ", titania, titania, 0.9),
    ] {
        let begin = format!("duration of a contact {name}");
        let line = ended.output.lines().find(|line| line.trim_start().starts_with(&begin));
        let line = line.unwrap_or_else(|| panic!("{begin}: {}", ended.output));
        let number = line[line.find(&begin).unwrap() + begin.len()..].split_whitespace().next();
        // The dashpot makes a contact longer by sqrt(1 + (ln e / pi)^2).
        let damping = (1.0 + (f64::ln(restitution) / std::f64::consts::PI).powi(2)).sqrt();
        let reduced = one * other / (one + other);
        let expected = std::f64::consts::PI * (reduced / 2.0e4_f64).sqrt() * damping;
        let printed: f64 = number.unwrap().parse().unwrap();
        // Five digits are printed.
        assert!((printed / expected - 1.0).abs() < 1.0e-4, "{printed} {expected}: {line}");
    }
}
