//! Particles and gas in a round column.

use super::gas_on_cells;
use crate::beds::{Bench, OPEN, PLATE, law};
use std::f64::consts::PI;
use talcum::domain::{Face, RankGrid, Wall};
use talcum::gas::{DragLaw, Ergun};
use talcum::grid::RoundColumn;
use talcum::parallel::run_on_threads;

const STOP: [Face; 2] = [Face::Stop; 2];
const DIAMETER: f64 = 1.0e-3;
const VISCOSITY: f64 = 1.8e-5;
const DENSITY: f64 = 1.2;
const VOIDAGE: f64 = 0.6;
const LAYERS: u32 = 24;

/// Spheres that do not move, in layers of Vogel's spiral, each turned against the last: it has the same number per area from the axis to the wall. Without the
/// `column` the gas fills the box around it.
fn packed(velocity: f64, column: bool) -> Bench {
    let (radius, height) = (8.0 * DIAMETER, 1.1 * DIAMETER);
    let edge = 2.04 * radius;
    let mut bench = Bench::new([edge, edge, f64::from(LAYERS) * height], [STOP, STOP, OPEN]);
    bench.contact = law(1.0e3, 0.9, 0.1);
    bench.density = 1.0e9;
    bench.skin = Some(0.1 * DIAMETER);
    bench.time_step = 1.0e-5;
    let sphere = PI / 6.0 * DIAMETER.powi(3);
    let in_layer = ((1.0 - VOIDAGE) * PI * radius * radius * height / sphere).round() as u32;
    for (layer, place) in (0..LAYERS).flat_map(|layer| (0..in_layer).map(move |i| (layer, i))) {
        let out = radius * ((f64::from(place) + 0.5) / f64::from(in_layer)).sqrt();
        let angle = f64::from(place) * PI * (3.0 - 5.0_f64.sqrt()) + f64::from(layer);
        let [x, y] = [out * angle.cos(), out * angle.sin()].map(|along| 0.5 * edge + along);
        bench.add([x, y, (f64::from(layer) + 0.5) * height], [0.0; 3], 0.5 * DIAMETER);
    }
    let air = (DENSITY, VISCOSITY);
    let mut model = gas_on_cells(&bench, [8, 8, 12], air, DragLaw::Ergun(Ergun), velocity);
    let round = || RoundColumn::new(&model.grid, [0.5 * edge; 2], radius).unwrap();
    model.column = column.then(round);
    bench.volume_averaged = Some(model);
    bench
}

#[test]
fn a_uniform_bed_has_a_uniform_voidage_up_to_the_wall() {
    let bench = packed(0.0, true);
    let model = bench.volume_averaged.clone().unwrap();
    let column = model.column.unwrap();
    let run = bench.alone();
    let voidage = &run.state.gas.volume_averaged().unwrap().fields.voidage;
    let (mut solids, mut volume, mut deviation) = (0.0, 0.0, 0.0_f64);
    for (i, j) in (0..8).flat_map(|j| (0..8).map(move |i| (i, j))) {
        let open = column.open_fraction([i, j]);
        for k in 0..12 {
            let eps = voidage.at([i, j, k]);
            solids += open * (1.0 - eps);
            volume += open;
            deviation += open * (eps - VOIDAGE).powi(2);
        }
    }
    let deviation = (deviation / volume).sqrt();
    println!("voidage {VOIDAGE} +- {deviation:.4}");
    let of_spheres = bench.particles.len() as f64 * PI / 6.0 * DIAMETER.powi(3);
    // Shares are rounded to 2^-50 of a cell, some ten of each of 4000 spheres.
    assert!((solids * model.grid.cell_volume() / of_spheres - 1.0).abs() < 1.0e-12);
    // Some 40 spheres lie in reach of a cell, spread far more evenly than at random (0.06).
    assert!(deviation < 0.02, "{deviation}");
    // Control: in the box the cells at the wall are half empty.
    let run = packed(0.0, false).alone();
    let in_box = run.state.gas.volume_averaged().unwrap().fields.voidage.clone();
    assert!((in_box.at([0, 4, 5]) - VOIDAGE).abs() > 0.02);
}

#[test]
fn a_packed_column_has_erguns_pressure_drop() {
    let gradient = |velocity: f64, column: bool| {
        let mut run = packed(velocity, column).alone();
        run.steps(100);
        let report = run.state.gas.volume_averaged().unwrap();
        let pressure = &report.fields.pressure;
        let drop = pressure.at([4, 4, 1]) - pressure.at([4, 4, 10]);
        (drop / (9.0 * 2.2 * DIAMETER), report.report.momentum_error)
    };
    for velocity in [0.1, 1.0] {
        let phi = 1.0 - VOIDAGE;
        let expected = 150.0 * VISCOSITY * phi.powi(2) / VOIDAGE.powi(3) * velocity
            / DIAMETER.powi(2)
            + 1.75 * DENSITY * phi / VOIDAGE.powi(3) * velocity * velocity / DIAMETER;
        let (found, error) = gradient(velocity, true);
        println!("Ergun in a tube: {found:.3} Pa/m for {expected:.3}; exchange error {error:.1e}");
        // The voidage varies by 1 %, and the wall takes some 1 % at the lower velocity: its friction on a cell is
        // mu / (d 2 d), the drag on it 40 mu / d^2.
        assert!((found / expected - 1.0).abs() < 0.03, "{found} for {expected}");
        // Control: the same flow over the cross-section of the box, in cells with fewer spheres at the walls.
        let (in_box, _) = gradient(velocity, false);
        assert!(in_box < 0.9 * expected, "{in_box}");
    }
}

/// A bed that a gas lifts in a round column.
fn bed(filter_width: f64) -> Bench {
    let mut bench = Bench::new([8.0, 8.0, 18.0], [STOP, STOP, PLATE]);
    bench.gravity.magnitude = 1.0;
    let (centre, radius) = ([4.1, 3.9], 3.85);
    bench.domain.walls.push(Wall::cylinder("tube", [centre[0], centre[1], 0.0].into(), radius));
    let mut lattice = bench.clone();
    lattice.add_layers(450, (1.12, 0.6), &[1.0, 0.8], (0.05, 0.1));
    for sphere in lattice.particles {
        let [x, y, _] = sphere.position;
        if (x - centre[0]).hypot(y - centre[1]) < radius - sphere.radius {
            bench.add(sphere.position, sphere.velocity, sphere.radius);
        }
    }
    let air = (0.01, 1.0 / 55.0);
    let mut model = gas_on_cells(&bench, [6, 6, 9], air, DragLaw::WEN_YU, 0.4);
    model.column = Some(RoundColumn::new(&model.grid, centre, radius).unwrap());
    model.coupling.filter_width = filter_width;
    bench.volume_averaged = Some(model);
    bench
}

#[test]
fn a_bed_in_a_round_column_has_one_answer_on_any_ranks() {
    for width in [0.0, 3.0] {
        let bench = bed(width);
        assert!(bench.particles.len() > 200);
        let alone = bench.on_ranks([1; 3], |run| run.steps(200).snapshot().bits());
        for grid in [[1, 1, 2], [1, 1, 3], [2, 1, 1], [2, 2, 1], [1, 2, 2]] {
            let bits = bench.on_ranks(grid, |run| run.steps(200).snapshot().bits());
            assert!(bits == alone, "{grid:?}, filter {width}");
        }
        // Control: the gas fills the box.
        let mut in_box = bench.clone();
        in_box.volume_averaged.as_mut().unwrap().column = None;
        assert!(in_box.on_ranks([1; 3], |run| run.steps(200).snapshot().bits()) != alone);
    }
}

#[test]
fn a_restart_in_a_round_column_changes_nothing() {
    let bench = bed(0.0);
    let whole = bench.on_ranks([1; 3], |run| run.steps(120).snapshot().bits());
    let middle = bench.on_ranks([2, 1, 1], |run| run.steps(53).snapshot());
    let resumed = run_on_threads(2, |ranks| {
        bench.resume(&middle, RankGrid([1, 2, 1]), ranks).steps(67).snapshot().bits()
    });
    assert!(resumed.iter().all(|bits| *bits == whole));
}
