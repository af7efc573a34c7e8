//! Gas from a plenum through a distributor: its time constant, its limits, closure of mass and momentum, and the same
//! bits on any ranks.

use crate::beds::{Bench, PERIODIC, PLATE, Run, attraction, gas, law, shaken};
use talcum::domain::RankGrid;
use talcum::gas::{DragLaw, Drive, GasStep, Plenum};
use talcum::numbers::Schedule;

const AREA: f64 = 4.4 * 4.4;

fn plenum(supply: Schedule, height: f64, resistances: [f64; 2]) -> Drive {
    let [linear_resistance, quadratic_resistance] = resistances;
    Drive::Plenum(Plenum {
        supply,
        height,
        pressure: 50.0,
        linear_resistance,
        quadratic_resistance,
    })
}

/// 160 spheres in ten layers on a plate.
fn bed(drive: Drive) -> Bench {
    let mut bench = Bench::new([4.4, 4.4, 30.0], [PERIODIC, PERIODIC, PLATE]);
    bench.contact = law(2.0e4, 0.9, 0.3);
    bench.time_step = 5.0e-4;
    let mut flow = gas(0.0);
    flow.drive = drive;
    bench.gas = Some(flow);
    bench.add_layers(160, (1.05, 0.6), &[1.0, 0.8], (0.01, 0.2));
    bench
}

/// The same, cohesive and shaken.
fn shaken_bed(drive: Drive) -> Bench {
    let mut bench = bed(drive);
    bench.gravity = shaken(3.0, 0.16);
    bench.cohesion = Some(attraction((3.0, 1.5), 1.0, (1.0e-4, 0.01)));
    bench
}

fn pressure(run: &Run) -> f64 {
    run.state.gas.plenum().unwrap()
}

fn velocity(run: &Run) -> f64 {
    run.work.gas.column().unwrap().superficial_velocity()
}

/// Vertical gas force on all particles, over the cross-section.
fn pressure_on_bed(run: &Run) -> f64 {
    run.gas_force().z / AREA
}

/// U_s at a time after the supply of a bed that is held fast has fallen from 0.1 to 0.04, and the slope of the pressure drop
/// of that bed.
fn fixed_bed_after(time: f64, dt: f64, linear: f64) -> (f64, f64) {
    let supply = Schedule::Steps { values: vec![0.1, 0.04], start: 0.0, every: 1.0 };
    let mut bench = bed(plenum(supply, 20.0, [linear, 0.0]));
    bench.particles.iter_mut().for_each(|particle| particle.velocity = [0.0; 3]);
    let mut run = bench.alone();
    let slope = pressure_on_bed(&run) / 0.1;
    let talcum::setup::Run { state, work, ranks, .. } = &mut *run;
    for step in 1..=(time / dt).round() as u32 {
        let step = GasStep { time: 1.0 + f64::from(step) * dt, dt, gravity: 0.0 };
        work.gas.advance(&mut state.gas, &mut state.particles, None, &step, *ranks).unwrap();
    }
    (velocity(&run), slope)
}

#[test]
fn flow_through_a_fixed_bed_follows_the_supply_by_the_time_constant_of_the_plenum() {
    let (time, linear) = (2.0, 3.0);
    let (_, slope) = fixed_bed_after(0.0, 0.01, linear);
    // H / P dp/dt = U_0 - U with p = (R_1 + slope) U.
    let expected = |resistance: f64| 0.04 + 0.06 * (-time / (20.0 / 50.0 * resistance)).exp();
    let error = |dt: f64| fixed_bed_after(time, dt, linear).0 - expected(linear + slope);
    let (coarse, fine) = (error(0.02), error(0.01));
    // Implicit Euler is of first order: x e^-x dt / (2 tau) of the change at most, 0.06 * 0.37 * 0.02 / 2 / 2.
    assert!(coarse.abs() < 1.2e-4, "{coarse} of {slope}");
    assert!((coarse / fine - 2.0).abs() < 0.05, "{coarse} {fine}");
    // Controls: the distributor, or the bed, left out.
    assert!((expected(linear) - expected(linear + slope)).abs() > 1.0e-3);
    assert!((expected(slope) - expected(linear + slope)).abs() > 1.0e-3);
}

#[test]
fn mass_and_momentum_close_in_a_shaken_bed() {
    let [linear, quadratic] = [2.0, 40.0];
    let mut bench = shaken_bed(plenum(Schedule::Constant(0.05), 8.0, [linear, quadratic]));
    bench.gas.as_mut().unwrap().drag = DragLaw::WEN_YU;
    let mut run = bench.alone();
    let (first, mut leaving, mut range) = (pressure(&run), 0.0, [f64::INFINITY, -f64::INFINITY]);
    for _ in 0..4000 {
        let before = run.work.gas.column().unwrap().superficial_velocity();
        run.steps(1);
        let u = velocity(&run);
        leaving += 0.05 - u;
        range = [range[0].min(u), range[1].max(u)];
        // The pressure of the plenum is that over distributor and bed, but for the rounding of each of 160 forces, and of its
        // two parts before, to half a spacing of the lattice; U_s is found to as much.
        let through = linear * u + quadratic * u * u.abs() + pressure_on_bed(&run);
        let rounding = 160.0 * 2.0 * run.models.force_quantum.spacing() / AREA;
        assert!((through - pressure(&run)).abs() < rounding, "{through} {}", pressure(&run));
        assert!(rounding < 1.0e-8);
        // Control: the velocity of the step before would not do.
        if (u - before).abs() > 1.0e-6 {
            let wrong = linear * before + quadratic * before * before.abs() + pressure_on_bed(&run);
            assert!((wrong - pressure(&run)).abs() > 1.0e-6);
        }
    }
    // What has flowed in and not out is in the plenum; sums of 4000 numbers.
    let stored = 8.0 / 50.0 * (pressure(&run) - first);
    assert!((stored - leaving * 5.0e-4).abs() < 1.0e-12, "{stored} {}", leaving * 5.0e-4);
    // It is a bed whose gas follows the cycle.
    assert!(range[1] - range[0] > 0.02, "{range:?}");
}

/// The smallest and the largest U_s, and gas force per cross-section, within a third of a cycle.
fn ranges(drive: Drive) -> [[f64; 2]; 2] {
    let mut run = shaken_bed(drive).alone();
    let mut found = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for _ in 0..4000 {
        run.steps(1);
        for (range, value) in found.iter_mut().zip([velocity(&run), pressure_on_bed(&run)]) {
            *range = [range[0].min(value), range[1].max(value)];
        }
    }
    found
}

#[test]
fn small_plenums_and_large_resistances_prescribe_the_flow_and_large_plenums_the_pressure() {
    let supply = || Schedule::Constant(0.05);
    let width = |[least, largest]: [f64; 2]| largest - least;
    // In between: U_s and pressure both follow the cycle.
    let [flow, pressure] = ranges(plenum(supply(), 8.0, [2.0, 0.0]));
    assert!(width(flow) > 0.02 && width(pressure) > 0.1, "{flow:?} {pressure:?}");
    // No room in the plenum: what flows in flows out. A pressure that changes by 10 in a time step of 5e-4 would let
    // H / P * 10 / dt = 4e-5 past.
    let [flow, pressure] = ranges(plenum(supply(), 1.0e-8, [2.0, 0.0]));
    assert!(width(flow) < 1.0e-4 && width(pressure) > 0.1, "{flow:?} {pressure:?}");
    // A resistance of 1e5 beside a pressure drop of the bed of 10 lets the flow change by 1e-4.
    let [flow, pressure] = ranges(plenum(supply(), 1.0e8, [1.0e5, 0.0]));
    assert!(width(flow) < 2.0e-4 && width(pressure) > 0.1, "{flow:?} {pressure:?}");
    // An endless plenum without a distributor: the bed always has the same pressure drop.
    let [flow, pressure] = ranges(plenum(supply(), 1.0e8, [0.0, 0.0]));
    assert!(width(flow) > 0.02 && width(pressure) < 1.0e-4, "{flow:?} {pressure:?}");
}

#[test]
fn ranks_and_restarts_give_the_same_bits() {
    let mut bench = shaken_bed(plenum(Schedule::Constant(0.05), 8.0, [2.0, 40.0]));
    bench.gas.as_mut().unwrap().drag = DragLaw::WEN_YU;
    let whole = |grid| bench.on_ranks(grid, |run| run.steps(600).snapshot());
    let expected = whole([1, 1, 1]);
    assert_eq!(expected.cells.len(), 1);
    for grid in [[2, 1, 1], [1, 1, 3], [2, 2, 1]] {
        assert_eq!(whole(grid).bits(), expected.bits(), "{grid:?}");
    }
    let half = bench.on_ranks([1, 1, 2], |run| run.steps(250).snapshot());
    let on = |end: &talcum::setup::Snapshot| {
        bench.resume(end, RankGrid([1, 1, 1]), &talcum::parallel::OneRank).steps(350).snapshot()
    };
    assert_eq!(on(&half).bits(), expected.bits());
    // Control: without its plenum the state is another.
    let mut without = half.clone();
    without.cells.clear();
    assert_ne!(on(&without).bits(), expected.bits());
}
