//! The gas velocity that carries a settled bed, compared with the force balance at its solids fraction.

use crate::beds::{Bench, PERIODIC, PLATE, Run, Snapshot, gas};
use nalgebra::Vector3;
use std::f64::consts::PI;
use talcum::analysis::minimum_fluidisation::minimum_fluidisation_velocity;
use talcum::domain::{EffectiveGravity, RankGrid};
use talcum::gas::{BaseNode, DragLaw, DragShare, Drive, Ergun, ParticleDrag};
use talcum::numbers::Schedule;
use talcum::parallel::OneRank;
use talcum::particles::ForceTorque;

const STOKES: f64 = 55.0;
/// The bed is poured until then; the gas rises from SLOWEST to FASTEST in RISE time units afterwards.
const POURED: f64 = 14.0;
const RISE: f64 = 10.0;
const SLOWEST: f64 = 0.01;
const FASTEST: f64 = 0.05;

/// A bed poured without gas, and at rest; then with the gas of the rise.
fn poured_bed() -> (Bench, Snapshot) {
    let mut bench = Bench::new([4.2, 4.2, 60.0], [PERIODIC, PERIODIC, PLATE]);
    bench.gravity = EffectiveGravity { magnitude: 1.0, vibration: None };
    bench.add_layers(640, (1.05, 0.55), &[1.0], (0.02, 0.3));
    let end = bench.alone().steps((POURED / bench.time_step) as u64).snapshot();
    let mut flow = gas(0.0);
    let (start, end_of_rise) = (POURED, POURED + RISE);
    flow.drive =
        Drive::Velocity(Schedule::Ramp { from: SLOWEST, to: FASTEST, start, end: end_of_rise });
    // The half cell: the bed's lowest layer has the bed's solids fraction, and is lifted.
    flow.base_node = BaseNode::HalfCell;
    bench.gas = Some(flow);
    (bench, end)
}

/// Gas force over weight of the particles in the middle half of the bed, and the mean solids fraction there:
/// the ends, where phi is averaged with what is beyond them, are not the bulk.
fn bulk(run: &mut Run) -> (f64, f64) {
    let talcum::setup::Run { state, work, .. } = &mut **run;
    let gas = work.gas.column().unwrap();
    let mut probe = state.particles.clone();
    probe.forces.fill(ForceTorque::of(Vector3::zeros()));
    gas.add_forces(&mut probe).expect("forces have a meaning");
    let owned = probe.owned_count();
    let top = probe.body[..owned].iter().fold(0.0, |top: f64, body| top.max(body.position.z));
    let inside = |height: f64| (0.25 * top..0.75 * top).contains(&height);
    let (mut force, mut weight) = (0.0, 0.0);
    for i in (0..owned).filter(|&i| inside(probe.body[i].position.z)) {
        force += probe.forces[i].force.z;
        weight += probe.body[i].mass;
    }
    let nodes = gas.grid().nodes();
    let in_bulk = (0..nodes).filter(|&node| inside(gas.grid().height_of(node)));
    let fractions: Vec<f64> = in_bulk.map(|node| gas.bed().solids_fraction[node]).collect();
    (force / weight, fractions.iter().sum::<f64>() / fractions.len() as f64)
}

/// U_mf of the straight line through the origin that the gas force on a fixed bed follows, and phi.
fn measured(run: &mut Run) -> (f64, f64) {
    let (mut slopes, mut fractions) = (Vec::new(), Vec::new());
    while run.time() < POURED + RISE {
        run.steps(400);
        let velocity = run.work.gas.column().unwrap().superficial_velocity();
        let (force, fraction) = bulk(run);
        if (0.4..0.9).contains(&force) {
            slopes.push(force / velocity);
            fractions.push(fraction);
        }
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    assert!(slopes.len() > 5, "the bed passes through the fixed branch");
    (1.0 / mean(&slopes), mean(&fractions))
}

/// U_mf / [(St / 18) (1 - phi)^4.65] (Moon 2006: 0.97 at the phi of the bulk).
#[test]
fn minimum_fluidisation_is_that_of_the_force_balance() {
    let (bench, poured) = poured_bed();
    let (velocity, phi) = measured(&mut bench.resume(&poured, RankGrid([1, 1, 1]), &OneRank));
    let ratio = |phi: f64| velocity / (STOKES / 18.0 * (1.0 - phi).powf(4.65));
    println!("U_mf {velocity:.5} at phi {phi:.4}: ratio {:.4}", ratio(phi));
    assert!((0.58..0.66).contains(&phi), "a bed poured at random: {phi}");
    // 3 % for the scatter of phi, which the power 4.65 of the voidage turns into scatter of the force.
    assert!((ratio(phi) - 1.0).abs() < 0.03, "{}", ratio(phi));
    // Negative control: at the solids fraction of another packing it does not hold.
    assert!((ratio(phi + 0.02) - 1.0).abs() > 0.1);
    // What `talcum check` prints for this bed; within 3 % for the same reason.
    let drag = gas(0.0).particle_drag();
    let per_velocity = |velocity: f64| drag.per_velocity(1.0, phi, velocity);
    let expected = minimum_fluidisation_velocity(per_velocity, PI / 6.0, phi);
    assert!((velocity / expected - 1.0).abs() < 0.03, "{velocity} for {expected}");
}

/// Of powders of 40 um (Liu et al. 2016) in air of 1.205 kg/m^3 and 1.8e-5 Pa s by Ergun's equation: voidage, and U_mf in mm/s of
/// grains of 250 and of 137 kg/m^3. Solved by hand: 150 mu (1 - eps) U / (eps^3 d^2) + 1.75 rho U^2 / (eps^3 d) = (rho_s - rho) g.
const ERGUN: [(f64, [f64; 2]); 3] =
    [(0.40, [0.1543, 0.0842]), (0.42, [0.1847, 0.1008]), (0.45, [0.2396, 0.1308])];

#[test]
fn fine_powders_are_fluidised_at_erguns_velocity() {
    let (diameter, air) = (4.0e-5_f64, 1.205);
    let velocity = |voidage: f64, density: f64| {
        let drag = ParticleDrag {
            law: DragLaw::Ergun(Ergun),
            factor: 1.0,
            share: DragShare::default(),
            viscosity: 1.8e-5,
            density: air,
            parcel_size: 1.0,
        };
        let weight = PI / 6.0 * diameter.powi(3) * density * 9.81;
        let per_velocity = |velocity: f64| drag.per_velocity(diameter, 1.0 - voidage, velocity);
        1.0e3 * minimum_fluidisation_velocity(per_velocity, weight, 1.0 - voidage)
    };
    for (voidage, expected) in ERGUN {
        for (density, expected) in [250.0, 137.0].into_iter().zip(expected) {
            let found = velocity(voidage, density - air);
            println!("U_mf at {voidage}, {density} kg/m^3: {found:.4} mm/s for {expected}");
            assert!((found - expected).abs() < 1.0e-4, "{found}"); // digits of the table, rounded
            // Negative control: without buoyancy, 0.5 and 0.9 % more.
            assert!((velocity(voidage, density) - expected).abs() > 4.0e-4);
        }
    }
}
