//! A compressible column gas: diffusion through a fixed bed, resonance of a shaken one, its incompressible limit,
//! closure of mass and momentum, and the same bits on any ranks.

use crate::beds::{Bench, PERIODIC, PLATE, Run, attraction, gas, law, shaken};
use std::f64::consts::{PI, TAU};
use talcum::domain::RankGrid;
use talcum::gas::{BaseNode, ColumnSolver, DragLaw, Drive, GasStep, Plenum};
use talcum::numbers::Schedule;

/// Width of the lattices, of two particles along x and y.
const WIDTH: f64 = 2.6;

/// Layers of four spheres at equal distances, the grid's; the plate's node averages over its half cell, so that phi is the same
/// from the plate up to the highest layer.
fn lattice(layers: u64, spacing: f64, pressure: f64) -> Bench {
    let height = (layers as f64 + 4.0) * spacing;
    let mut bench = Bench::new([WIDTH, WIDTH, height], [PERIODIC, PERIODIC, PLATE]);
    let mut flow = gas(0.0);
    flow.spacing = spacing;
    flow.base_node = BaseNode::HalfCell;
    flow.ambient_pressure = Some(pressure);
    bench.gas = Some(flow);
    bench.add_layers(4 * layers, (spacing, 0.5 * spacing), &[1.0], (0.0, 0.0));
    bench
}

fn column<'a>(run: &'a Run) -> &'a ColumnSolver {
    run.work.gas.column().unwrap()
}

/// Vertical gas force on all particles, over the cross-section.
fn pressure_on_bed(run: &Run) -> f64 {
    let area = run.domain.bounds.cross_section();
    run.gas_force().z / area
}

/// The pressure on the plate of a lattice that is held fast, at multiples of `every` steps after the flow has fallen to a half.
fn relaxation(layers: u64, pressure: f64, dt: f64, every: usize) -> Vec<f64> {
    let flow = 1.0e-3;
    let mut bench = lattice(layers, 1.0, pressure);
    let supply = Schedule::Steps { values: vec![flow, 0.5 * flow], start: 0.0, every: 1.0 };
    bench.gas.as_mut().unwrap().drive = Drive::Velocity(supply);
    let mut run = bench.alone();
    let mut found = Vec::new();
    for step in 1..=4 * every {
        let state = &mut run.0.state;
        let step_of_gas = GasStep { time: 1.0 + step as f64 * dt, dt, gravity: 0.0 };
        let (gas, particles) = (&mut state.gas, &mut state.particles);
        run.0.work.gas.advance(gas, particles, None, &step_of_gas, run.0.ranks).unwrap();
        if step % every == 0 {
            found.push(run.gas_force().z / (WIDTH * WIDTH) / flow);
        }
    }
    found
}

/// phi and R = beta / (1 - phi)^2 of a lattice, by creeping drag of this viscosity.
fn resistance(spacing: f64, viscosity: f64) -> (f64, f64) {
    let phi = 4.0 * PI / 6.0 / (WIDTH * WIDTH * spacing);
    (phi, 18.0 * viscosity * phi * (1.0 - phi).powf(-4.65))
}

/// The same of a continuum, over the flow before: eps dp/dt = (P / R) d2p/dz2, -dp/dz = R U at the plate, p = 0 above.
fn diffusion(height: f64, pressure: f64, time: f64) -> f64 {
    let (phi, resistance) = resistance(1.0, 1.0 / 55.0);
    let diffusivity = pressure / ((1.0 - phi) * resistance);
    let mode = |m: u32| {
        let q = (f64::from(m) + 0.5) * PI;
        2.0 / (q * q) * (-q * q * diffusivity * time / (height * height)).exp()
    };
    resistance * height * (0.5 + 0.5 * (0..50).map(mode).sum::<f64>())
}

#[test]
fn pressure_diffuses_through_a_fixed_bed() {
    let pressure = 100.0;
    let error = |layers: u64, pressure: f64, expected: f64| {
        // Until after three time constants of the slowest mode, 4 H^2 / (pi^2 D) = 0.64 at 20 layers.
        let dt = 1.0e-3 * (layers as f64 / 20.0).powi(2);
        let found = relaxation(layers, pressure, dt, 500);
        let after = |k: usize| diffusion(layers as f64, expected, (k + 1) as f64 * 500.0 * dt);
        let errors = (0..4).map(|k| (found[k] / after(k) - 1.0).abs());
        errors.fold(0.0, f64::max)
    };
    let [coarse, fine] = [20, 40].map(|layers| error(layers, pressure, pressure));
    // The highest of 20 or 40 layers is in gas whose phi has fallen by a quarter, and so resists about half as much.
    assert!(coarse < 0.04 && (coarse / fine - 2.0).abs() < 0.2, "{coarse} {fine}");
    // Controls: the diffusivity of another pressure, and that without the voidage.
    let voidage = 1.0 - resistance(1.0, 1.0).0;
    for wrong in [2.0 * pressure, voidage * pressure] {
        let wrong = error(20, pressure, wrong);
        assert!(wrong > 0.05, "{wrong}");
    }
}

/// A lattice that hangs in the gas on a shaken plate: so little weight that it does not fall meanwhile.
struct Suspension {
    layers: u64,
    spacing: f64,
    pressure: f64,
    viscosity: f64,
}

impl Suspension {
    const GRAVITY: f64 = 1.0e-4;
    const GAMMA: f64 = 10.0;

    fn height(&self) -> f64 {
        self.layers as f64 * self.spacing
    }

    /// c / (4 H) with c^2 = P / (rho_s phi (1 - phi)).
    fn resonance(&self) -> f64 {
        let phi = resistance(self.spacing, 1.0).0;
        (self.pressure / (phi * (1.0 - phi))).sqrt() / (4.0 * self.height())
    }

    /// Amplitude of the pressure on the plate over that of the weight, of a continuum without contacts:
    /// tanh(kH) / (kH) / (1 + i w tau), k^2 = i w eps / (P Y), Y = 1 / R + 1 / (i w rho_s phi), tau = rho_s phi / R.
    fn theory(&self, frequency: f64) -> f64 {
        let (phi, resistance) = resistance(self.spacing, self.viscosity);
        let (w, tau) = (TAU * frequency, phi / resistance);
        // (k H)^2 = -(w H / c)^2 / (1 + i w tau)
        let wave = (w * self.height()).powi(2) * phi * (1.0 - phi) / self.pressure;
        let of_drag = 1.0 + (w * tau).powi(2);
        let square = [-wave / of_drag, wave * w * tau / of_drag];
        let size = (square[0].hypot(square[1])).sqrt();
        let angle = 0.5 * square[1].atan2(square[0]);
        let (a, b) = (size * angle.cos(), size * angle.sin());
        // |tanh(a + i b)|^2 = (sinh^2 a + sin^2 b) / (sinh^2 a + cos^2 b)
        let (sinh, sin, cos) = (a.sinh().powi(2), b.sin().powi(2), b.cos().powi(2));
        ((sinh + sin) / (sinh + cos)).sqrt() / size / of_drag.sqrt()
    }

    /// The same in a run: by Fourier's integral over the last two of twelve cycles. `compressible` or not.
    fn response(&self, frequency: f64, compressible: bool) -> f64 {
        let mut bench = lattice(self.layers, self.spacing, self.pressure);
        let gas = bench.gas.as_mut().unwrap();
        gas.viscosity = self.viscosity;
        gas.ambient_pressure = Some(self.pressure).filter(|_| compressible);
        bench.gravity = shaken(Self::GAMMA, frequency);
        bench.gravity.magnitude = Self::GRAVITY;
        let cycle = 2000;
        bench.time_step = 1.0 / frequency / cycle as f64;
        bench.contact = law(1.0e3, 0.9, 0.1);
        let mut run = bench.alone();
        run.steps(10 * cycle);
        let mut sums = [0.0; 2];
        for step in 0..2 * cycle {
            run.steps(1);
            let (sin, cos) = (TAU * step as f64 / cycle as f64).sin_cos();
            sums[0] += pressure_on_bed(&run) * sin / cycle as f64;
            sums[1] += pressure_on_bed(&run) * cos / cycle as f64;
        }
        let phi = resistance(self.spacing, 1.0).0;
        sums[0].hypot(sums[1]) / (phi * self.height() * Self::GRAVITY * Self::GAMMA)
    }
}

#[test]
fn a_suspension_on_a_shaken_plate_resonates_at_a_quarter_of_a_wave() {
    let of = |layers: u64| {
        let pressure = (layers as f64).powi(2); // the same frequency for all heights
        Suspension { layers, spacing: 1.25, pressure, viscosity: 0.2 }
    };
    let error = |bed: &Suspension, ratio: f64, compressible: bool| {
        let frequency = ratio * bed.resonance();
        let found = bed.response(frequency, compressible);
        println!("{} {ratio} {} {found}", bed.layers, bed.theory(frequency));
        (found / bed.theory(frequency) - 1.0).abs()
    };
    let [short, tall] = [20, 40].map(of);
    for ratio in [0.4, 0.7, 1.0, 1.4] {
        // The bed's end is known to within a part of its highest layer, of 20 or 40, and with it the frequency of the resonance;
        // far from that the pressure changes by up to twice the frequency's part.
        assert!(error(&short, ratio, true) < 0.06, "{ratio}");
        assert!(error(&tall, ratio, true) < 0.03, "{ratio}");
    }
    let responses = [0.7, 1.0, 1.4].map(|ratio| tall.response(ratio * tall.resonance(), true));
    assert!(responses[1] > 1.5 * responses[0].min(responses[2]), "{responses:?}");
    // Controls: the incompressible gas; the theory of another pressure.
    assert!(error(&short, 1.0, false) > 0.5);
    let other = Suspension { pressure: 1.3 * short.pressure, ..of(20) };
    let frequency = 1.4 * short.resonance();
    let wrong = short.response(frequency, true) / other.theory(frequency) - 1.0;
    assert!(wrong.abs() > 0.2, "{wrong}");
}

/// 160 spheres in ten layers on a plate.
fn bed(pressure: Option<f64>) -> Bench {
    let mut bench = Bench::new([4.4, 4.4, 30.0], [PERIODIC, PERIODIC, PLATE]);
    bench.contact = law(2.0e4, 0.9, 0.3);
    bench.time_step = 5.0e-4;
    let mut flow = gas(0.05);
    flow.ambient_pressure = pressure;
    bench.gas = Some(flow);
    bench.add_layers(160, (1.05, 0.6), &[1.0, 0.8], (0.01, 0.2));
    bench
}

/// The same, cohesive and shaken.
fn shaken_bed(pressure: Option<f64>) -> Bench {
    let mut bench = bed(pressure);
    bench.gravity = shaken(3.0, 0.16);
    bench.cohesion = Some(attraction((3.0, 1.5), 1.0, (1.0e-4, 0.01)));
    bench
}

fn with_plenum(mut bench: Bench) -> Bench {
    let gas = bench.gas.as_mut().unwrap();
    gas.drag = DragLaw::WEN_YU;
    gas.drive = Drive::Plenum(Plenum {
        supply: Schedule::Constant(0.05),
        height: 8.0,
        pressure: gas.ambient_pressure.unwrap(),
        linear_resistance: 2.0,
        quadratic_resistance: 40.0,
    });
    bench
}

/// Gas forces and heights of the particles after each of some hundred steps.
fn history(pressure: Option<f64>) -> Vec<[f64; 2]> {
    let mut run = shaken_bed(pressure).alone();
    let mut found = Vec::new();
    for _ in 0..600 {
        run.steps(1);
        let height: f64 = (0..160).map(|id| run.particle(id).position[2]).sum();
        found.push([pressure_on_bed(&run), height / 160.0]);
    }
    found
}

#[test]
fn at_a_high_pressure_the_gas_is_the_incompressible_one() {
    let expected = history(None);
    let error = |pressure: f64, number: usize| {
        let rows = history(Some(pressure));
        let errors = rows.iter().zip(&expected).map(|(row, of)| (row[number] - of[number]).abs());
        errors.fold(0.0, f64::max)
    };
    // The force, and the mean height, which the force has changed for 0.3 time units.
    for (number, per_pressure) in [(0, 110.0), (1, 1.4)] {
        let [low, high, highest] = [1.0e5, 1.0e7, 1.0e9].map(|pressure| error(pressure, number));
        // Of first order in 1 / P, as the mass that the bed's own pressure of some 10 adds to the gas.
        assert!(low < per_pressure / 1.0e5, "{low}");
        assert!((low / high - 100.0).abs() < 2.0, "{low} {high}");
        assert!(highest < 0.02 * high, "{highest}");
        // Control: at a pressure of a hundred times the bed's it is another gas.
        assert!(error(1.0e3, number) > 50.0 * low);
    }
}

/// Mass of the gas over the cross-section, as volume at P; of a bed with a plenum without that in the plenum.
fn content(run: &Run, ambient: f64) -> f64 {
    let cells = &run.state.gas.column().unwrap().cells;
    let held = cells.iter().map(|cell| cell.voidage * (ambient + cell.pressure) / ambient);
    held.sum::<f64>() * column(run).grid().spacing()
}

#[test]
fn mass_and_momentum_close_in_a_shaken_bed() {
    let ambient = 50.0;
    let mut run = with_plenum(shaken_bed(Some(ambient))).alone();
    run.steps(1);
    let (first, mut gained, mut of_uniform) = (content(&run, ambient), 0.0, 0.0);
    let mut difference: f64 = 0.0;
    for _ in 0..2000 {
        run.steps(1);
        let [inflow, outflow] = [column(&run).superficial_velocity(), column(&run).outflow()];
        gained += (inflow - outflow) * run.models.physics.time_step;
        of_uniform += inflow * run.models.physics.time_step;
        difference = difference.max((inflow - outflow).abs());
        // The distributor's drop and the gas force on all particles make the plenum's pressure, but for the rounding of five
        // shares for each of 160 particles.
        let through = 2.0 * inflow + 40.0 * inflow * inflow.abs() + pressure_on_bed(&run);
        let plenum = run.state.gas.plenum().unwrap();
        let rounding =
            160.0 * 5.0 * run.models.force_quantum.spacing() / run.domain.bounds.cross_section();
        assert!((through - plenum).abs() < rounding, "{through} {plenum} {rounding}");
    }
    let change = content(&run, ambient) - first;
    // Sums of 2000 numbers up to 1, each rounded; the momentum balance gives the pressure to as many digits.
    assert!((change - gained).abs() < 1.0e-12, "{change} {gained}");
    // Control: what flows out is another flow than what flows in.
    assert!(difference > 0.1 && (change - of_uniform).abs() > 1.0e-3);
}

#[test]
fn ranks_and_restarts_give_the_same_bits() {
    for bench in [shaken_bed(Some(200.0)), with_plenum(shaken_bed(Some(50.0)))] {
        let whole = |grid| bench.on_ranks(grid, |run| run.steps(600).snapshot());
        let expected = whole([1, 1, 1]);
        // 30 / 1.5 intervals, and perhaps a plenum.
        assert!([20, 21].contains(&expected.cells.len()));
        for grid in [[2, 1, 1], [1, 1, 3], [2, 2, 1]] {
            assert_eq!(whole(grid).bits(), expected.bits(), "{grid:?}");
        }
        let half = bench.on_ranks([1, 1, 2], |run| run.steps(250).snapshot());
        let on = |end: &talcum::setup::Snapshot| {
            bench.resume(end, RankGrid([1, 1, 1]), &talcum::parallel::OneRank).steps(350).snapshot()
        };
        assert_eq!(on(&half).bits(), expected.bits());
        // Control: without its gas the state is another; likewise with another pressure in one interval.
        let mut without = half.clone();
        without.cells.retain(|cell| cell.cell == u64::MAX);
        assert_ne!(on(&without).bits(), expected.bits());
        let mut other = half.clone();
        other.cells.last_mut().unwrap().pressure += 1.0e-9;
        assert_ne!(on(&other).bits(), expected.bits());
    }
}

#[test]
fn a_vacuum_below_the_bed_is_refused() {
    // The bed resists by some 20 per velocity.
    let mut bench = bed(Some(1.0));
    bench.gas.as_mut().unwrap().drive = Drive::Velocity(Schedule::Constant(-0.5));
    let mut run = bench.alone();
    let error = (0..3).find_map(|_| run.try_step().err()).unwrap().to_string();
    assert!(error.contains("the absolute pressure has to be above 0"), "{error}");
    // Control: in a denser atmosphere it is possible.
    bench.gas.as_mut().unwrap().ambient_pressure = Some(100.0);
    bench.alone().steps(3);
}
