//! Instruments of whole runs with beds made by hand, for which the results are known.

use super::{Part, run};
use std::collections::HashMap;
use std::f64::consts::PI;
use std::fmt::Write;
use std::path::Path;
use talcum::case::Case;
use talcum::output::InstrumentResults;

/// What the cases share: particles of diameter 1 and density 1, the rows of `bed.csv`.
const PARTICLES: &str = r#"
title = "A bed made by hand"
units = "dimensionless"
[particles]
diameter = 1.0
density = 1.0
[particles.start]
kind = "file"
path = "bed.csv"
format = "csv"
[contact]
law = "linear_spring_dashpot"
normal_stiffness = 1.0e4
poisson_ratio = 0.3
restitution = 0.1
friction = 0.1
"#;

/// Runs a case with these particles and sections on so many ranks; `read` takes the file of its instrument `known`.
fn measured<T>(bed: &str, sections: &str, ranks: usize, read: impl FnOnce(&Path) -> T) -> T {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("bed.csv"), bed).unwrap();
    let text = format!("{PARTICLES}{sections}");
    let case = Case::from_text(&text, "case.toml", folder.path(), &[]);
    let case = case.unwrap_or_else(|errors| panic!("{errors}"));
    let until = case.end_time();
    run(&case, folder.path(), &Part { ranks, resume: false, until });
    read(&folder.path().join("measure-known.h5"))
}

/// The last value of a column.
#[track_caller]
fn last(results: &InstrumentResults, name: &str) -> f64 {
    let column = results.columns.iter().find(|column| column.name == name).unwrap();
    *column.values.last().unwrap()
}

/// Two blocks of particles on a cubic lattice in a periodic box of 8^3 cells with edges of 2 d: one of 3^3 cells that
/// rises at 1, and one of 2^3 cells across a face of the box that falls at 2.
fn two_blocks() -> String {
    let mut text = "id,x,y,z,vx,vy,vz\n".to_owned();
    let mut id = 0;
    let mut block = |lowest: [i32; 3], edge: i32, velocity: f64| {
        for site in 0..edge.pow(3) {
            let offsets = [site % edge, site / edge % edge, site / edge / edge];
            let [x, y, z] =
                [0, 1, 2].map(|k| f64::from((lowest[k] + offsets[k]).rem_euclid(16)) + 0.5);
            writeln!(text, "{id},{x},{y},{z},0,0,{velocity}").unwrap();
            id += 1;
        }
    };
    block([4, 4, 4], 6, 1.0);
    block([14, 4, 12], 4, -2.0);
    text
}

fn clusters(threshold: f64, smallest: u64, ranks: usize) -> InstrumentResults {
    let sections = format!(
        r#"
[box]
lengths = [16.0, 16.0, 16.0]
x = "periodic"
y = "periodic"
z = "periodic"
[gravity]
magnitude = 0.0
[gas]
kind = "volume_averaged"
cells = [8, 8, 8]
density = 1.0e-3
viscosity = 1.0e-6
drag = "wen_yu"
substeps = 1
[time]
step = 1.0e-5
end = 2.0e-5
[output]
series = 1.0e-5
[measure.known]
kind = "clusters"
every = 1.0e-5
threshold = {threshold}
smallest = {smallest}
"#
    );
    measured(&two_blocks(), &sections, ranks, |file| InstrumentResults::read(file).unwrap())
}

#[test]
fn clusters_of_two_blocks_are_found_with_their_volumes_and_velocities() {
    // With hat weights a row of particles half a diameter from a cell's face gives a quarter to the next cell: in a block
    // of n cells along an edge, the part (n - 1/4) / n of each direction lies in its own cells.
    let inside = |n: f64| 8.0 * n.powi(3) * ((n - 0.25) / n).powi(3);
    let (large, small) = (inside(3.0), inside(2.0));
    let all = 216.0 + 64.0;
    // One step of a gas of a thousandth of the solids' density changes velocities by less than 1e-6, and moves particles by
    // 4e-5 of a cell at most.
    let tolerance = 1.0e-4;
    for ranks in [1, 2] {
        // A corner cell of a block has 0.52 * (7/8)^3 = 0.35, the cells beside it 0.52 / 8 = 0.07.
        let found = clusters(0.2, 4, ranks);
        let expected = [
            ("clusters", 2.0),
            ("volume_fraction", 35.0 / 512.0),
            ("solids_part", (large + small) / all),
            ("largest", 27.0 * 8.0),
            ("mean_volume", 17.5 * 8.0),
            ("solids_fraction", (large + small) * PI / 6.0 / (35.0 * 8.0)),
            ("vertical_velocity", (large - 2.0 * small) / (large + small)),
            ("velocity_outside", ((216.0 - large) - 2.0 * (64.0 - small)) / (all - large - small)),
        ];
        for (name, value) in expected {
            let got = last(&found, name);
            assert!(
                (got - value).abs() < tolerance * value.abs().max(1.0),
                "{name}: {got}, {value}"
            );
        }
    }
    // Controls: blocks of fewer cells than asked for, and cells less dense than asked for, are none.
    assert_eq!(last(&clusters(0.2, 9, 1), "clusters"), 1.0);
    assert_eq!(last(&clusters(0.53, 1, 1), "clusters"), 0.0);
    // Above the solids fraction of edges and corners only the middle cells are left: 7 of 27 with at least 0.45.
    let dense = clusters(0.45, 1, 1);
    assert_eq!((last(&dense, "clusters"), last(&dense, "largest")), (1.0, 7.0 * 8.0));
}

/// One particle that rests on a plate, which vibrates with Gamma 0.5 at f 0.16.
const ON_A_PLATE: &str = r#"
[box]
lengths = [4.0, 4.0, 8.0]
x = "periodic"
y = "periodic"
z = "wall"
[gravity]
magnitude = 1.0
[vibration]
gamma = 0.5
frequency = 0.16
[time]
step = 1.25e-3
end = 31.2625
[output]
series = 1.0
[measure.known]
kind = "phase_average"
every = 0.0125
cycles = 2
phases = 20
"#;

#[test]
fn the_stress_below_a_resting_particle_follows_the_plate() {
    let columns = |path: &Path| -> HashMap<String, Vec<f64>> {
        let file = hdf5::File::open(path).unwrap();
        let rows = file.dataset("results/time").unwrap().size();
        let names = file.group("results").unwrap().member_names().unwrap();
        let last_row = |name: &String| {
            let all: Vec<f64> =
                file.dataset(&format!("results/{name}")).unwrap().read_raw().unwrap();
            all[all.len() - all.len() / rows..].to_vec()
        };
        names.iter().map(|name| (name.clone(), last_row(name))).collect()
    };
    let row = measured("id,x,y,z\n0,2,2,0.5\n", ON_A_PLATE, 1, columns);
    let column = |name: &str| &row[name];
    let stress = column("plate_stress");
    assert_eq!(stress.len(), 20);
    // The particle moves with the plate, whose stress is 1 + Gamma sin(2 pi f t); a bin of 1/20 of the cycle holds 25 looks about
    // its middle, over which the mean of the sine is sin(pi/20) / (pi/20) of it. What is left is the acceleration of the particle
    // on its spring, Gamma (2 pi f)^2 m / k_n = 3e-5, and half a step between force and velocity, 3e-4.
    let mean_of_bin = (PI / 20.0).sin() / (PI / 20.0);
    let phase = |bin: usize| 2.0 * PI * bin as f64 / 20.0;
    let worst = |shift: f64| {
        let expected = |bin: usize| 1.0 + 0.5 * mean_of_bin * (phase(bin) + shift).sin();
        stress.iter().enumerate().map(|(b, s)| (s - expected(b)).abs()).fold(0.0, f64::max)
    };
    assert!(worst(0.0) < 1.0e-3, "{} {stress:?}", worst(0.0));
    // Control: a twentieth of a cycle off would be seen.
    assert!(worst(2.0 * PI / 20.0) > 0.1);
    // Every cycle is like the one before, and the plate bears the weight in the mean.
    let [mean, error] =
        ["plate_stress_mean", "plate_stress_mean_error"].map(|name| column(name)[0]);
    assert!((mean - 1.0).abs() < 1.0e-3 && error < 1.0e-3, "{mean} {error}");
    let lift = column("bed_bottom");
    assert!(lift.iter().all(|lift| lift.abs() < 1.0), "{lift:?}");
}

/// Sixteen particles side by side that rise at 1 through a periodic box 4 d wide and 10 d high, from a height of 2.5 d.
fn sheet() -> String {
    let mut text = "id,x,y,z,vx,vy,vz\n".to_owned();
    for site in 0..16 {
        let (x, y) = (f64::from(site % 4) + 0.5, f64::from(site / 4) + 0.5);
        writeln!(text, "{site},{x},{y},2.5,0,0,1").unwrap();
    }
    text
}

/// The same for twelve periods of a look, and an instrument with these keys.
fn with_sheet<T>(keys: &str, read: impl FnOnce(&Path) -> T) -> T {
    let sections = format!(
        r#"
[box]
lengths = [4.0, 4.0, 10.0]
x = "periodic"
y = "periodic"
z = "periodic"
[gravity]
magnitude = 0.0
[time]
step = 1.0e-3
end = 12.0
[output]
series = 1.0
[measure.known]
every = 0.125
{keys}
"#
    );
    measured(&sheet(), &sections, 2, read)
}

/// Solids fraction of each phase and layer of the sheet in a frame.
fn rising_sheet(frame: &str) -> Vec<f64> {
    let keys = format!(
        "kind = \"stress\"\naverage = 12.0\nlayers = 10\nphases = 4\nfrequency = 0.25\n{frame}"
    );
    with_sheet(&keys, |file| {
        let file = hdf5::File::open(file).unwrap();
        let dataset = file.dataset("results/solids_fraction").unwrap();
        assert_eq!(dataset.shape()[1..], [4, 10]);
        dataset.read_raw::<f64>().unwrap()[..40].to_vec()
    })
}

/// Solids fraction of cells of 2 x 4 x 2 d in a frame, x fastest.
fn sheet_on_cells(frame: &str) -> Vec<f64> {
    let keys = format!("kind = \"stress\"\naverage = 12.0\ncells = [2, 1, 5]\n{frame}");
    with_sheet(&keys, |file| {
        let image = hdf5::File::open(file.with_extension("vtkhdf")).unwrap();
        let dataset = image.dataset("VTKHDF/CellData/solids_fraction").unwrap();
        dataset.read_raw::<f64>().unwrap()[..10].to_vec()
    })
}

#[test]
fn cells_move_with_the_wave_too() {
    let in_frame = sheet_on_cells("frame = \"wave\"\nwave_speed = 1.0\nwavelength = 10.0");
    // Eight spheres in each of the two cells of the second layer, of 16 d^3; the others are empty.
    for (cell, &fraction) in in_frame.iter().enumerate() {
        let expected = if cell / 2 == 1 { 8.0 * PI / 6.0 / 16.0 } else { 0.0 };
        // Positions are rounded to their quantum at each of 12,000 steps.
        assert!((fraction - expected).abs() < 1.0e-6, "{in_frame:?}");
    }
    // Two waves in the box are laid over one another: there is one sheet for both.
    let halved = sheet_on_cells("frame = \"wave\"\nwave_speed = 1.0\nwavelength = 5.0");
    let total = |fractions: &[f64], height: f64| fractions.iter().sum::<f64>() * 8.0 * height;
    assert!((total(&in_frame, 2.0) - 16.0 * PI / 6.0).abs() < 1.0e-9, "{in_frame:?}");
    assert!((total(&halved, 1.0) - 8.0 * PI / 6.0).abs() < 1.0e-9, "{halved:?}");
    // The control: cells at rest see the sheet in all layers.
    assert!(sheet_on_cells("").iter().all(|&fraction| fraction > 0.01));
}

#[test]
fn what_moves_with_the_wave_is_at_rest_in_its_frame_at_every_phase() {
    let spread = |fractions: &[f64]| {
        let of_layer = |layer: usize| {
            let values = (0..4).map(|phase| fractions[10 * phase + layer]);
            values.clone().fold(0.0, f64::max) - values.fold(f64::INFINITY, f64::min)
        };
        (0..10).map(of_layer).fold(0.0, f64::max)
    };
    let in_frame = rising_sheet("frame = \"wave\"\nwave_speed = 1.0\nwavelength = 10.0");
    // Positions are rounded to their quantum at each of 12,000 steps.
    assert!(spread(&in_frame) < 1.0e-6, "{in_frame:?}");
    // All of the sheet, a layer thick, is there: 16 spheres over a cross-section of 16.
    let total: f64 = in_frame[..10].iter().sum();
    assert!((total - PI / 6.0).abs() < 1.0e-9, "{total}");
    // The control: at rest in the box each phase of a cycle of 4 sees the sheet elsewhere.
    assert!(spread(&rising_sheet("frame = \"phase\"")) > 0.05);
}

/// All values of a column.
#[track_caller]
fn all<'a>(results: &'a InstrumentResults, name: &str) -> &'a [f64] {
    &results.columns.iter().find(|column| column.name == name).unwrap().values
}

#[test]
fn a_probe_at_a_point_sees_the_particles_that_pass() {
    // Four particles of the sheet pass the point at a distance of sqrt(1/2) d, the next ones at 1.58 d.
    let probe = |radius: f64| {
        let keys =
            format!("kind = \"probe\"\nat = \"point\"\npoint = [2.0, 2.0, 5.0]\nradius = {radius}");
        with_sheet(&keys, |file| InstrumentResults::read(file).unwrap())
    };
    let found = probe(1.2);
    let near = (1.2_f64 * 1.2 - 0.5).sqrt();
    let [fraction, velocity] =
        ["solids_fraction", "solids_velocity_z"].map(|name| all(&found, name));
    for (look, &time) in found.times.iter().enumerate() {
        // The box is 10 d high and periodic.
        let height = (2.5 + time - 5.0 + 5.0).rem_euclid(10.0) - 5.0;
        let passes = height.abs() < near;
        let expected = if passes { 4.0 * 0.125 / 1.2_f64.powi(3) } else { 0.0 };
        assert!((fraction[look] - expected).abs() < 1.0e-12, "{time}: {}", fraction[look]);
        assert_eq!(velocity[look].is_nan(), !passes, "{time}");
        assert!(!passes || (velocity[look] - 1.0).abs() < 1.0e-12, "{time}");
    }
    let passing = fraction.iter().filter(|&&fraction| fraction > 0.0).count();
    assert_eq!(passing, 15 + 4, "a whole passage, and the beginning of a second");
    // The control: none comes so near.
    assert!(all(&probe(0.7), "solids_fraction").iter().all(|&fraction| fraction == 0.0));
}

#[test]
fn time_averages_of_a_sheet_that_passes_are_those_of_its_weights() {
    let averaged = |average: f64| {
        let keys = format!("kind = \"time_average\"\naverage = {average}");
        with_sheet(&keys, |file| {
            let file = hdf5::File::open(file).unwrap();
            let read = |name: &str| file.dataset(name).unwrap().read_raw::<f64>().unwrap();
            let heights = read("height");
            let first = |name: &str| read(&format!("results/{name}"))[..heights.len()].to_vec();
            let [mean, deviation] = ["solids_fraction", "solids_fraction_deviation"].map(first);
            (heights, mean, deviation)
        })
    };
    // 80 looks, one time through the box: every node sees the sheet pass once.
    let (heights, mean, deviation) = averaged(10.0);
    let (looks, spacing) = (80.0, heights[1] - heights[0]);
    // A node at a distance x of the sheet has 16 spheres in 16 d^2 by the hat weight 1 - |x| / h.
    let at = |distance: f64| PI / 6.0 / spacing * (1.0 - distance.abs() / spacing).max(0.0);
    for (node, &height) in heights.iter().enumerate() {
        let values: Vec<f64> = (1..=80)
            .map(|look| at((2.5 + 0.125 * f64::from(look) - height + 5.0).rem_euclid(10.0) - 5.0))
            .collect();
        let expected = values.iter().sum::<f64>() / looks;
        let square: f64 = values.iter().map(|value| (value - expected).powi(2)).sum();
        // Positions are rounded to their quantum at each of 12,000 steps.
        assert!((mean[node] - expected).abs() < 1.0e-9, "{height}: {} {expected}", mean[node]);
        let expected = (square / (looks - 1.0)).sqrt();
        assert!((deviation[node] - expected).abs() < 1.0e-7, "{height}: {}", deviation[node]);
    }
    // The control: half of the time the sheet has passed half of the nodes only.
    let (_, mean, _) = averaged(5.0);
    assert!(mean.contains(&0.0), "{mean:?}");
}
