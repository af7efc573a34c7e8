//! Parcels instead of particles: the forces on them, the properties that they keep, and the cases that are rejected.

use crate::launch::{checkpoints, in_repository, runs_of, talcum};
use std::path::Path;
use talcum::case::Case;
use talcum::output::checkpoint;
use talcum::parallel::{OneRank, ParticleRecord};

/// l of the file.
const FACTOR: f64 = 4.0;

/// The particles of the file in a box of l times smaller edges, where lengths and times are 1 / l: accelerations are l times as
/// large, and so are viscosity and gas density, so that drag over weight and Reynolds number stay.
const UNDER_LARGER_ACCELERATIONS: [&str; 12] = [
    "coarse_graining.factor=1.0",
    "box.lengths=[5.0e-4, 5.0e-4, 3.0e-3]",
    "particles.count=100",
    "gravity.magnitude=9.81",
    "vibration.frequency=200.0",
    "gas.viscosity=1.8e-5",
    "gas.density=1.2",
    "gas.spacing=1.5e-4",
    "time.step=1.0e-6",
    "time.end=0.01",
    "output.series=1.0e-3",
    "title=particles",
];

/// The same where times and velocities are 1 / l^(1/2): accelerations stay.
const AT_LOWER_VELOCITIES: [&str; 13] = [
    "coarse_graining.factor=1.0",
    "box.lengths=[5.0e-4, 5.0e-4, 3.0e-3]",
    "particles.count=100",
    "particles.start.velocity.granular_temperature=2.5e-4",
    "vibration.frequency=100.0",
    "gas.viscosity=9.0e-6",
    "gas.density=1.2",
    "gas.spacing=1.5e-4",
    "gas.superficial_velocity=0.005",
    "time.step=2.0e-6",
    "time.end=0.02",
    "output.series=2.0e-3",
    "title=particles",
];

/// Another way to adhere.
const VAN_DER_WAALS: [&str; 2] = [
    "contact={ law = \"linear_spring_dashpot\", normal_stiffness = 20.0, poisson_ratio = 0.3, restitution = 0.8, friction = 0.4, friction_cap = \"net\", rolling = \"constant_torque\", rolling_friction = 0.1 }",
    "cohesion={ expression = \"rough\", asperity_radius = 1.0e-7, hamaker_constant = 3.0e-19, wall_hamaker_constant = 1.0e-19, cut_off = 4.0e-10, range = 1.0e-6 }",
];

const JKR: &str = "contact={ law = \"jkr\", young_modulus = 5.0e5, poisson_ratio = 0.3, surface_energy = 2.0e-4, restitution = 0.8, friction = 0.4, wall = { surface_energy = 1.0e-4 } }";

fn file() -> String {
    in_repository("tests/cases/good/parcels.toml").display().to_string()
}

/// The particles at the end of a run of the file with changes.
fn end_of(changes: &[&str]) -> Vec<ParticleRecord> {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().display().to_string();
    let file = file();
    let set = changes.iter().flat_map(|change| ["--set", change]);
    let arguments: Vec<&str> =
        ["run", &file, "--output", &output, "--force"].into_iter().chain(set).collect();
    talcum(0, &arguments).digest();
    let last = checkpoints(folder.path()).pop().unwrap();
    checkpoint::read(&last, &OneRank).unwrap().0.particles
}

/// Places, velocities and spins, in units of a length and a time.
fn scaled(particles: &[ParticleRecord], length: f64, time: f64) -> Vec<[[f64; 3]; 3]> {
    let scaled = |it: &ParticleRecord| {
        [
            it.position.map(|x| x / length),
            it.velocity.map(|v| v * time / length),
            it.angular_velocity.map(|w| w * time),
        ]
    };
    particles.iter().map(scaled).collect()
}

/// All that acts is scaled alike: contacts, rolling, adhesion, walls, weight, drag. With l a power of 4 not even the rounding differs.
#[test]
fn parcels_do_what_particles_do_in_a_smaller_box() {
    let rules: [(&str, &[&str], f64); 2] = [
        ("strength", &UNDER_LARGER_ACCELERATIONS, FACTOR),
        ("bond_number", &AT_LOWER_VELOCITIES, FACTOR.sqrt()),
    ];
    for changes in [&[][..], &VAN_DER_WAALS[..], &[JKR][..]] {
        for (number, (_, in_small_box, time)) in rules.into_iter().enumerate() {
            let particles = scaled(&end_of(&[in_small_box, changes].concat()), 1.0, 1.0);
            assert_eq!(particles.len(), 100);
            let parcels = rules.map(|(keeps, _, _)| {
                let keeps = format!("coarse_graining.keeps={keeps}");
                scaled(&end_of(&[&[keeps.as_str()], changes].concat()), FACTOR, time)
            });
            assert!(parcels[number] == particles, "{changes:?} {in_small_box:?}");
            // The control: the other rule.
            assert!(parcels[1 - number] != particles, "{changes:?} {in_small_box:?}");
            // They have moved: by more than a diameter somewhere.
            let start = end_of(&[in_small_box, changes, &["time.end=2.0e-6"]].concat());
            let moved = |(a, b): (&[[f64; 3]; 3], &ParticleRecord)| (a[0][2] - b.position[2]).abs();
            let furthest = particles.iter().zip(&start).map(moved).fold(0.0, f64::max);
            assert!(furthest > 1.0e-4, "{furthest}");
        }
    }
}

fn read(overrides: &[&str]) -> Result<Case, String> {
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    Case::read(Path::new(&file()), &overrides).map_err(|errors| errors.to_string())
}

/// Force of adhesion and work of separation of two bodies, and their diameter and mass.
struct Adhesion {
    force: f64,
    work: f64,
    diameter: f64,
    mass: f64,
}

fn adhesion_of(case: &Case) -> Adhesion {
    let law = case.stages[0].physics.cohesion_at(0.0).unwrap();
    let (law, diameter) = (law.of([0, 0]), case.particles.reference_diameter);
    let radius = 0.5 * diameter;
    Adhesion {
        force: law.between_particles(radius, radius, 0.0),
        work: -law.energy_of_particles(radius, radius, 0.0),
        diameter,
        mass: case.particles.reference_mass(0),
    }
}

#[test]
fn each_rule_keeps_what_it_says() {
    let case = |change: &str| read(&[&VAN_DER_WAALS[..], &[change]].concat()).unwrap();
    let single = case("coarse_graining.factor=1.0");
    let strength = case("coarse_graining.keeps=strength");
    let bond_number = case("coarse_graining.keeps=bond_number");
    // Rounding of some ten operations.
    let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1.0e-13;
    let ratio =
        |of: fn(&Adhesion) -> f64, case: &Case| of(&adhesion_of(case)) / of(&adhesion_of(&single));
    let tensile_strength = |it: &Adhesion| it.force / it.diameter.powi(2);
    let squared_speed_of_sticking = |it: &Adhesion| it.work / it.mass;
    let bond = |it: &Adhesion| it.force / it.mass;
    let work_over_weight = |it: &Adhesion| it.work / (it.mass * it.diameter);
    assert!(close(ratio(tensile_strength, &strength), 1.0));
    assert!(close(ratio(squared_speed_of_sticking, &strength), 1.0));
    assert!(close(ratio(bond, &strength), 1.0 / FACTOR));
    assert!(close(ratio(bond, &bond_number), 1.0));
    assert!(close(ratio(work_over_weight, &bond_number), 1.0));
    assert!(close(ratio(tensile_strength, &bond_number), FACTOR));
    assert!(close(ratio(squared_speed_of_sticking, &bond_number), FACTOR));
    // The gas carries a bed of parcels where it carries the bed of their particles.
    let velocity = |case: &Case| case.minimum_fluidisation(&case.stages[0], 0.6).unwrap();
    assert!(close(velocity(&strength), velocity(&single)));
}

#[test]
fn parcels_have_one_digest_on_any_ranks_and_begin_with_parcels_only() {
    let folder = tempfile::tempdir().unwrap();
    let run = runs_of(&file(), folder.path());
    let digest = run(0, "whole", &[]).digest();
    assert_eq!(run(2, "two", &[]).digest(), digest);
    run(2, "parts", &["--until", "0.02"]).digest();
    let refused = run(0, "parts", &["--resume", "--set", "coarse_graining.factor=2.0"]);
    let words = "coarse_graining.factor: 4.0 -> 2.0: cannot change when a run is continued";
    assert!(refused.error().contains(words), "{}", refused.errors);
    assert_eq!(run(3, "parts", &["--resume"]).digest(), digest);
    let newest = checkpoints(&folder.path().join("whole")).pop().unwrap();
    let start = format!(
        "particles={{ density = 1500.0, diameter = 1.0e-4, start = {{ kind = \"run\", path = {newest:?} }} }}"
    );
    run(0, "next", &["--set", &start]).digest();
    let of_others = ["--set", &start, "--set", "coarse_graining.factor=2.0"];
    let refused = run(0, "others", &of_others);
    let words = "coarse_graining.factor: 4.0 -> 2.0: must be the same as in the run that this one starts from";
    assert!(refused.error().contains(words), "{}", refused.errors);
}

#[test]
fn check_describes_parcels_and_their_particles() {
    let check = |changes: &[&str]| {
        let file = file();
        let set = changes.iter().flat_map(|change| ["--set", change]);
        let arguments: Vec<&str> = ["check", &file].into_iter().chain(set).collect();
        talcum(0, &arguments).output
    };
    let parcels = check(&[]);
    assert!(parcels.contains("parcels: 64 particles of diameter 1.0000e-4 m in each"), "{parcels}");
    // Groups of the gas are those of the particles.
    let single = check(&["coarse_graining.factor=1.0", "particles.count=100"]);
    for group in
        ["Archimedes number", "Stokes number", "U_mf of the force balance", "terminal velocity"]
    {
        let line = |text: &str| {
            let line = text.lines().find(|line| line.contains(group)).map(str::to_owned);
            line.unwrap_or_else(|| panic!("{group}: {text}"))
        };
        assert_eq!(line(&parcels), line(&single));
    }
}
