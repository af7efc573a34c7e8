//! Initial beds: numbers, positions and sizes of particles, and the absence of contacts.

use std::path::Path;
use talcum::case::{BedPart, BedStart, Case, InitialBed};
use talcum::parallel::ParticleRecord;

fn bed(name: &str, overrides: &[&str]) -> (Case, InitialBed) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases/good").join(name);
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    let case = Case::read(&file, &overrides).unwrap_or_else(|errors| panic!("{errors}"));
    let bed = case.initial_bed(BedPart::WHOLE).unwrap_or_else(|error| panic!("{name}: {error}"));
    (case, bed)
}

/// Distance of surfaces of the nearest pair, images included, and of the particle nearest to a wall.
fn least_gaps(case: &Case, particles: &[ParticleRecord]) -> [f64; 2] {
    let bounds = &case.domain.bounds;
    let mut gaps = [f64::INFINITY; 2];
    for (index, first) in particles.iter().enumerate() {
        let position = nalgebra::Vector3::from(first.position);
        for second in &particles[..index] {
            let mut distance = position - nalgebra::Vector3::from(second.position);
            for axis in (0..3).filter(|&axis| bounds.is_periodic(axis)) {
                let length = bounds.lengths()[axis];
                distance[axis] -= length * (distance[axis] / length).round();
            }
            gaps[0] = gaps[0].min(distance.norm() - first.radius - second.radius);
        }
        for wall in &case.domain.walls {
            gaps[1] = gaps[1].min(wall.height_of(&position) - first.radius);
        }
    }
    gaps
}

#[test]
fn nothing_touches_at_the_start() {
    for name in ["jittered-lattice", "si", "periodic-box", "sizes-normal", "sizes-uniform", "plain"]
    {
        let (case, bed) = bed(&format!("{name}.toml"), &[]);
        let [pair, wall] = least_gaps(&case, &bed.particles);
        assert!(pair > 0.0 && wall >= 0.0, "{name}: {pair} {wall}");
        for (id, particle) in bed.particles.iter().enumerate() {
            assert_eq!(particle.id, id as u64);
            for axis in 0..3 {
                let x = particle.position[axis];
                assert_eq!(case.domain.bounds.position_quantum().round(x), x);
                assert!((0.0..=case.domain.bounds.lengths()[axis]).contains(&x));
            }
        }
    }
}

#[test]
fn a_lattice_is_stretched_to_divide_its_box() {
    let (_, bed) = bed("plain.toml", &["particles.fill_height=3.4"]);
    // 4 x 4 sites of 1.25 across 5, three layers of 1.1 below 3.4.
    assert_eq!(bed.particles.len(), 48);
    let last = bed.particles[47].position;
    assert!((last[0] - 4.375).abs() < 1.0e-12 && (last[2] - 2.75).abs() < 1.0e-12);
    assert_eq!(bed.particles[0].mass, std::f64::consts::PI / 6.0);
}

#[test]
fn a_random_bed_has_its_solids_fraction_and_temperature() {
    let (case, bed) = bed("periodic-box.toml", &[]);
    assert_eq!(bed.particles.len(), 900);
    let height = 900.0 * std::f64::consts::PI / 6.0 / (0.3 * 100.0);
    assert!(bed.particles.iter().all(|particle| particle.position[2] <= height));
    let square: f64 = bed.particles.iter().flat_map(|p| p.velocity).map(|v| v * v).sum();
    // 4 standard deviations of the variance of 2700 normal numbers.
    let error = square / 2700.0 / 0.1 - 1.0;
    assert!(error.abs() < 4.0 * (2.0_f64 / 2700.0).sqrt(), "{error}");
    assert!(matches!(case.particles.start, BedStart::Random { .. }));
}

#[test]
fn particles_depend_on_seed_and_id_alone() {
    let (_, short) = bed("jittered-lattice.toml", &["particles.count=20"]);
    let (_, long) = bed("jittered-lattice.toml", &[]);
    assert_eq!(short.particles, long.particles[..20]);
    let (_, other) = bed("jittered-lattice.toml", &["particles.seed=8"]);
    assert_ne!(long.particles[0].position, other.particles[0].position);
}

#[test]
fn parts_of_a_bed_make_up_the_whole() {
    let lattices = ["jittered-lattice", "hertz-and-rolling", "adhesive-si"]; // the last two with inner walls
    for name in lattices.into_iter().chain(["jkr-round-column", "sizes-normal", "csv-file"]) {
        let (case, whole) = bed(&format!("{name}.toml"), &[]);
        let part = |number| case.initial_bed(BedPart { number, of: 3 }).unwrap().particles;
        let parts = [0, 1, 2].map(part);
        for (place, particle) in whole.particles.iter().enumerate() {
            assert_eq!(parts[place % 3].get(place / 3), Some(particle), "{name}");
        }
        assert_eq!(parts.map(|part| part.len()).iter().sum::<usize>(), whole.particles.len());
    }
}

#[test]
fn files_keep_ids_velocities_and_sizes() {
    let (_, bed) = bed("csv-file.toml", &[]);
    let ids: Vec<u64> = bed.particles.iter().map(|particle| particle.id).collect();
    assert_eq!(ids, [2, 4, 9]);
    let four = bed.particles[1];
    assert_eq!((four.velocity, four.angular_velocity), ([0.1, 0.0, 0.0], [0.0, 0.0, 0.2]));
    assert_eq!(four.position, [1.0, 1.0, 1.5]);
    let sizes = bed.size_range().unwrap();
    assert_eq!([sizes.smallest_diameter, sizes.largest_diameter], [1.0, 1.2]);
}

#[test]
fn the_end_of_another_run_is_left_to_its_reader() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases/bad/start-run.toml");
    let text = std::fs::read_to_string(file).unwrap().replace("velocity =", "#");
    let case = Case::from_text(&text, "run.toml", Path::new("here"), &[]).unwrap();
    assert_eq!(case.particles.start, BedStart::Run { path: Path::new("here").join("end.h5") });
    let error = case.initial_bed(BedPart::WHOLE).unwrap_err().to_string();
    assert!(error.contains("the end of another run"), "{error}");
    assert!(case.size_range().is_none());
}
