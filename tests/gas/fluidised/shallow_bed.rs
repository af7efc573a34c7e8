//! A bed of few cells on a plate: the loss of pressure drop at its surface in the gas, and its recovery with the
//! voidage of finer cells.

use super::gas_on_cells;
use crate::beds::{Bench, PERIODIC, PLATE, law};
use nalgebra::Vector3;
use std::f64::consts::PI;
use talcum::gas::{DragLaw, Ergun};
use talcum::particles::GAS_FORCE;

const DIAMETER: f64 = 1.0e-3;
const VISCOSITY: f64 = 1.8e-5;
const DENSITY: f64 = 1.2;
const VOIDAGE: f64 = 0.4;
const VELOCITY: f64 = 0.1;
/// Of the bed, 17.2 diameters deep, and of the whole box.
const LAYERS: [u64; 2] = [18, 36];
/// Ergun's equation.
const GRADIENT: f64 = 1715.625;

/// Force of the gas on a bed of layers that are packed alike up to the plate, over that of Ergun's equation; on so many cells over the
/// height, with a filter of so many diameters.
fn force(cells: usize, filter: f64, local_voidage: Option<usize>) -> f64 {
    let spacing = (PI / 6.0 * DIAMETER.powi(3) / (1.0 - VOIDAGE)).cbrt();
    let [bed, all] = LAYERS.map(|layers| layers as f64 * spacing);
    let across = 6.0 * spacing;
    let mut bench = Bench::new([across, across, all], [PERIODIC, PERIODIC, PLATE]);
    bench.contact = law(1.0e3, 0.9, 0.1);
    bench.density = 1.0e9; // nothing moves
    bench.skin = Some(0.1 * DIAMETER);
    bench.time_step = 1.0e-5;
    let place = (spacing * (1.0 - 1.0e-9), 0.5 * spacing);
    bench.add_layers(36 * LAYERS[0], place, &[DIAMETER], (0.0, 0.0));
    let ergun = DragLaw::Ergun(Ergun);
    let mut model = gas_on_cells(&bench, [2, 2, cells], (DENSITY, VISCOSITY), ergun, VELOCITY);
    model.coupling.filter_width = filter * DIAMETER;
    model.coupling.local_voidage = local_voidage;
    bench.volume_averaged = Some(model);
    let mut run = bench.alone();
    run.steps(100);
    let columns = &run.state.particles.columns;
    let forces: f64 = columns.at(GAS_FORCE).iter::<Vector3<f64>>().map(|force| force.z).sum();
    forces / (GRADIENT * bed * across * across)
}

/// Cells of 2.6 to 3.1 diameters.
#[test]
fn the_voidage_of_finer_cells_gives_more_than_half_of_the_loss_back() {
    let on =
        |filter: f64, local: Option<usize>| [11, 12, 13].map(|cells| force(cells, filter, local));
    let lost = |forces: [f64; 3]| 1.0 - forces.iter().sum::<f64>() / 3.0;
    let ([with, without], [filtered, filtered_without]) =
        ([on(0.0, Some(2)), on(0.0, None)], [on(4.0, Some(2)), on(4.0, None)]);
    println!("17 diameters: {with:.4?}, by the gas's cells {without:.4?}");
    println!("filter of 4: {filtered:.4?}, by the gas's cells {filtered_without:.4?}");
    // The lattice's layers and the finer cells have different distances, so that single beds scatter by 4 %.
    assert!(lost(with) < 0.5 * lost(without) && lost(with) > -0.02, "{with:?} {without:?}");
    assert!(lost(filtered) < 0.5 * lost(filtered_without), "{filtered:?} {filtered_without:?}");
    // The filter does not act on the voidage: what is left is its effect on the slip.
    assert!((lost(filtered) - lost(with)).abs() < 0.025, "{filtered:?} {with:?}");
    // Control: by the gas's own cells the filter takes more.
    assert!(lost(filtered_without) > lost(without) + 0.04, "{filtered_without:?}");
}

#[test]
fn on_the_gas_s_own_cells_it_changes_little() {
    let twice = |local| force(13, 0.0, local);
    let (one, coarse) = (twice(Some(1)), twice(None));
    // The cells themselves, without a filter: the same voidage, but for what the one particle has of itself, S = 0.008 of 3 %.
    assert!((one / coarse - 1.0).abs() < 2.0e-3, "{one} for {coarse}");
    assert!(one != coarse); // a control: it acts
}
