//! The gas in three dimensions on one cell across, against the column of gas, in the vibrated bed of Moon 2006.

use super::beds::{Bench, PERIODIC, PLATE, Run, gas, law, shaken};
use super::flow;
use talcum::analysis::{BedProfile, Measures, measure};
use talcum::gas::DragLaw;
use talcum::grid::ColumnGrid;

const FREQUENCY: f64 = 0.16;
/// Rows in a cycle.
const ROWS: usize = 25;
/// Cycles before and in the mean.
const CYCLES: [usize; 2] = [3, 4];

/// The mean cycle of plate stress and pressure drop, over weight.
fn cycle(three_dimensional: bool, gamma: f64) -> Vec<[f64; 2]> {
    let mut bench = Bench::new([5.0, 5.0, 48.0], [PERIODIC, PERIODIC, PLATE]);
    bench.contact = law(2.0e4, 0.9, 0.1);
    bench.gravity = shaken(gamma, FREQUENCY);
    bench.time_step = 8.0e-4;
    bench.add_layers(300, (1.1, 0.6), &[1.0], (0.03, 0.1));
    let mut column = gas(0.01);
    column.spacing = 1.5;
    if three_dimensional {
        let (density, viscosity) = (1.0e-3, column.viscosity);
        let mut model =
            flow(&bench, [1, 1, 32], (density, viscosity), DragLaw::WEN_YU_CREEPING, 0.01);
        model.substeps = 10;
        bench.flow = Some(model);
    } else {
        bench.gas = Some(column);
    }
    let mut run = bench.alone();
    let grid = ColumnGrid::new(&run.domain.bounds, 1.5, 1.0);
    let mut profile = BedProfile::new(grid, run.models.limits.speed, [1.0, 1.0], 0.3);
    let mut read = |run: &mut Run| -> Measures {
        let Run { state, domain, models, work, ranks } = run;
        measure(state, domain, models, work, &mut profile, None, *ranks)
    };
    let period = 1.0 / FREQUENCY / bench.time_step; // 7812.5 steps
    let mut mean = vec![[0.0; 2]; ROWS];
    let samples = 10; // in a row of the cycle
    for cycle in 0..CYCLES[0] + CYCLES[1] {
        for (row, mean) in mean.iter_mut().enumerate() {
            for sample in 0..samples {
                let at = (cycle * ROWS + row) * samples + sample + 1;
                let step = (at as f64 * period / (ROWS * samples) as f64) as u64;
                run.steps(step - run.state.clock.step);
                if cycle >= CYCLES[0] {
                    let measures = read(&mut run);
                    let part = 1.0 / (samples * CYCLES[1]) as f64;
                    mean[0] += part * measures.plate_stress;
                    mean[1] += part * measures.gas_force;
                }
            }
        }
    }
    mean
}

/// Root mean square of the difference of two cycles over that of one about its mean, for each quantity.
fn distance(one: &[[f64; 2]], other: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|quantity| {
        let mean = one.iter().map(|row| row[quantity]).sum::<f64>() / ROWS as f64;
        let size: f64 = one.iter().map(|row| (row[quantity] - mean).powi(2)).sum();
        let apart: f64 =
            one.iter().zip(other).map(|(a, b)| (a[quantity] - b[quantity]).powi(2)).sum();
        (apart / size).sqrt()
    })
}

#[test]
fn a_vibrated_bed_sees_the_same_cycle_in_both_gases() {
    let (column, cells) = (cycle(false, 2.0), cycle(true, 2.0));
    let [plate, drop] = distance(&column, &cells);
    println!("column and one cell across: plate stress {plate:.3}, gas force {drop:.3} apart");
    // Nodes of the column lie on the plate and at multiples of dz, cells between them: phi of the lowest half cell
    // and of the surface are averaged otherwise. The bed of 12 layers is thrown once a cycle.
    assert!(plate < 0.25 && drop < 0.15, "{plate} {drop}");
    // Negative control: a weaker vibration is farther away.
    let [plate, drop] = distance(&column, &cycle(true, 1.5));
    println!("Gamma 1.5 in the place of 2: {plate:.3}, {drop:.3}");
    assert!(plate > 0.3 && drop > 0.2);
}
