//! A fluidised bed: the time-averaged force of the gas carries its weight.

use super::gas_on_cells;
use crate::beds::{Bench, PERIODIC, PLATE, Run, law};
use talcum::analysis::{BedProfile, RunView, SeriesRow, series_row};
use talcum::gas::DragLaw;
use talcum::grid::ColumnGrid;

/// Rows read off a bed at this superficial velocity, from the time on at which it is steady.
fn rows(velocity: f64) -> Vec<SeriesRow> {
    let mut bench = Bench::new([6.0, 6.0, 36.0], [PERIODIC, PERIODIC, PLATE]);
    bench.contact = law(2.0e4, 0.8, 0.1);
    bench.gravity.magnitude = 1.0;
    bench.time_step = 8.0e-4;
    bench.add_layers(320, (1.15, 0.6), &[1.0], (0.05, 0.1));
    let mut model =
        gas_on_cells(&bench, [2, 2, 12], (1.0e-3, 1.0 / 55.0), DragLaw::WEN_YU, velocity);
    model.substeps = 25;
    bench.volume_averaged = Some(model);
    let mut run = bench.alone();
    let grid = ColumnGrid::new(&run.domain.bounds, 1.5, 1.0);
    let mut profile = BedProfile::new(grid, run.models.limits.speed, [1.0, 1.0], 0.3);
    run.steps(12_500);
    let mut read = |run: &mut Run| {
        run.steps(25);
        let talcum::setup::Run { state, domain, models, work, ranks } = &mut **run;
        series_row(RunView { state, domain, models, work }, &mut profile, None, *ranks)
    };
    (0..1600).map(|_| read(&mut run)).collect()
}

fn mean(rows: &[SeriesRow], of: impl Fn(&SeriesRow) -> f64) -> f64 {
    rows.iter().map(of).sum::<f64>() / rows.len() as f64
}

#[test]
fn the_mean_pressure_drop_is_the_weight_per_area() {
    let rows = rows(0.16);
    let drop = mean(&rows, |row| row.grid_pressure_drop);
    let plate = mean(&rows, |row| row.plate_stress);
    let force = mean(&rows, |row| row.gas_force);
    let deviation = mean(&rows, |row| (row.grid_pressure_drop - drop).powi(2)).sqrt();
    let exchange = rows.iter().fold(0.0, |most: f64, row| most.max(row.exchange_error));
    println!(
        "fluidised bed: pressure drop {drop:.4} +- {deviation:.4}, gas force {force:.4}, plate {plate:.4}; \
         exchange error {exchange:.1e}"
    );
    // Over 32 time units a bed that has come to move at 0.1 has gained 0.3 % of weight times time.
    assert!((force + plate - 1.0).abs() < 0.005, "{force} and {plate}");
    // The pressure at the bottom is continued through half a cell, which holds fewer particles than the next one.
    assert!((drop - 1.0).abs() < 0.01, "{drop}");
    assert!(deviation > 0.001, "the bed moves: {deviation}"); // a control: it is not packed
    assert!(exchange < 1.0e-7); // 320 forces on a lattice of 1e-9 of a weight
    assert!(rows.iter().all(|row| row.raised_cells == 0.0));
}

#[test]
fn a_gas_too_slow_to_fluidise_carries_a_part() {
    let rows = rows(0.01);
    let [drop, force, plate] = [0, 1, 2]
        .map(|k| mean(&rows, |row| [row.grid_pressure_drop, row.gas_force, row.plate_stress][k]));
    println!(
        "fixed bed: pressure drop {drop:.4}, gas force {force:.4}, plate {plate:.4} of the weight"
    );
    assert!(drop < 0.8, "{drop}"); // the negative control of the balance above
    assert!((force + plate - 1.0).abs() < 0.005, "{force} and {plate}");
}
