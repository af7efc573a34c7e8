//! The one-dimensional gas: pressure drop, momentum balances, and beds of all kinds.

use crate::beds::{Bench, OPEN, PERIODIC, PLATE, Run, attraction, gas, law, shaken};
use std::f64::consts::PI;
use talcum::analysis::{BedProfile, MomentumProbe, RunView, SeriesRow, series_row};
use talcum::domain::{EffectiveGravity, Face};
use talcum::gas::{DragLaw, DragShare, Drive, GasSolver, WeightBalance};
use talcum::grid::ColumnGrid;

const VISCOSITY: f64 = 1.0 / 55.0;
const DENSITY: f64 = 1.3e-3;

/// beta by hand: Moon 2006 eqs (13) to (16).
fn momentum_transfer(drag: &DragLaw, phi: f64, diameter: f64, slip: f64) -> f64 {
    let creeping = 18.0 * VISCOSITY / diameter.powi(2) * phi * (1.0 - phi).powf(-2.65);
    match *drag {
        DragLaw::WEN_YU_CREEPING => creeping,
        DragLaw::WEN_YU => {
            // Re = (1 - phi) rho d |u_g - u_s| / mu, and (1 - phi) (u_g - u_s) = U_s - u_s.
            let reynolds = DENSITY * diameter * slip.abs() / VISCOSITY;
            creeping * (1.0 + 0.15 * reynolds.powf(0.687))
        }
        _ => panic!("{drag:?} is not among these beds"),
    }
}

/// Reads everything off after one step. Collective.
fn step_and_measure(run: &mut Run, profile: &mut BedProfile) -> SeriesRow {
    let probe = MomentumProbe::take(&run.state.particles, run.ranks);
    run.steps(1);
    let talcum::setup::Run { state, domain, models, work, ranks } = &mut **run;
    series_row(RunView { state, domain, models, work }, profile, Some(probe), *ranks)
}

fn profile_of(run: &Run) -> BedProfile {
    let spacing = run.models.physics.gas.column().map_or(1.5, |gas| gas.spacing);
    let grid = ColumnGrid::new(&run.domain.bounds, spacing, 1.0);
    BedProfile::new(grid, run.models.limits.speed, [1.0; 2], 0.3)
}

/// A cubic lattice of spheres, a layer at each node of the gas, that is not let go.
fn fixed_lattice(drag: DragLaw, velocity: f64, diameter: f64) -> Bench {
    let mut bench = Bench::new([5.0, 5.0, 12.5], [PERIODIC; 3]);
    let mut flow = gas(velocity);
    (flow.spacing, flow.drag) = (1.25, drag);
    bench.gas = Some(flow);
    bench.add_layers(160, (1.25, 1.0), &[diameter], (0.0, 0.0));
    bench
}

#[test]
fn the_pressure_drop_of_a_fixed_bed_is_beta_u() {
    for drag in [DragLaw::WEN_YU_CREEPING, DragLaw::WEN_YU] {
        for (velocity, d) in [(0.12, 1.0), (30.0, 1.0), (-5.0, 0.8)] {
            let run = fixed_lattice(drag.clone(), velocity, d).alone();
            let phi = 160.0 * PI / 6.0 * d.powi(3) / (25.0 * 12.5);
            let u_g = velocity / (1.0 - phi);
            let gradient = momentum_transfer(&drag, phi, d, velocity) * u_g / (1.0 - phi);
            let expected = gradient * 12.5;
            let found = run.work.gas.column().unwrap().pressure_drop();
            // Sums of 160 numbers on lattices of 1e-15 of the cell, and a power: round-off.
            assert!(
                (found / expected - 1.0).abs() < 1.0e-12,
                "{drag:?} {velocity}: {found} {expected}"
            );
            // The bed is uniform, so the force on the particles is the same, but for the rounding of each to
            // half a spacing of the lattice, and round-off.
            let spacing = run.models.force_quantum.spacing();
            let force = run.gas_force().z;
            let rounding = 160.0 * 0.5 * spacing / 25.0 + 1.0e-12 * expected.abs();
            assert!((force / 25.0 - expected).abs() < rounding, "{force}");
            // Negative control: a voidage left out once.
            assert!((found / (expected * (1.0 - phi)) - 1.0).abs() > 0.1);
        }
    }
}

/// Diameters of a mixture.
const SIZES: [f64; 2] = [1.0, 0.7];

/// What Beetstra, van der Hoef & Kuipers (2007) find for the gas force on a sphere of a mixture, the mean pressure gradient
/// included, over that on one of equal spheres of the Sauter mean diameter: (eps y + phi y^2) y, y = d / <d>.
fn share_of_force(phi: f64, diameter: f64, mean: f64) -> f64 {
    let y = diameter / mean;
    ((1.0 - phi) * y + phi * y * y) * y
}

#[test]
fn a_mixture_that_shares_drag_by_surface_is_a_bed_of_its_sauter_diameter() {
    let (a, b) = (SIZES[0], SIZES[1]);
    let mean = (a.powi(3) + b.powi(3)) / (a.powi(2) + b.powi(2));
    let phi = 80.0 * PI / 6.0 * (a.powi(3) + b.powi(3)) / (25.0 * 12.5);
    for (drag, velocity) in [(DragLaw::WEN_YU_CREEPING, 0.12), (DragLaw::WEN_YU, 30.0)] {
        let run = |share: DragShare| {
            let mut bench = fixed_lattice(drag.clone(), velocity, 1.0);
            bench.particles.clear();
            bench.add_layers(160, (1.25, 1.0), &SIZES, (0.0, 0.0));
            bench.gas.as_mut().unwrap().drag_share = share;
            bench.alone()
        };
        let mixture = run(DragShare::Surface);
        let beta = momentum_transfer(&drag, phi, mean, velocity);
        let expected = beta * velocity / (1.0 - phi).powi(2) * 12.5;
        let found = mixture.work.gas.column().unwrap().pressure_drop();
        // Round-off, as of one size.
        assert!((found / expected - 1.0).abs() < 1.0e-12, "{drag:?}: {found} {expected}");
        // Of each size the force that the paper gives: the drop over their number is that on equal spheres.
        let equals = phi * 25.0 * 12.5 / (PI / 6.0 * mean.powi(3));
        let of_one = expected * 25.0 / equals;
        let forces = mixture.work.gas.forces_on(&mixture.state.particles);
        for (body, force) in mixture.state.particles.body.iter().zip(&forces) {
            let force_expected = of_one * share_of_force(phi, 2.0 * body.radius, mean);
            let rounding = mixture.models.force_quantum.spacing();
            assert!((force.z - force_expected).abs() < rounding + 1.0e-9 * force_expected.abs());
        }
        // The control: by diameter, each with the drag of a bed of its own size, it is another bed.
        let other = run(DragShare::Diameter).work.gas.column().unwrap().pressure_drop();
        assert!((other / expected - 1.0).abs() > 0.02, "{other}");
    }
}

/// A bed on a plate has phi of its own at each node: the sum over nodes, by hat weights computed again.
#[test]
fn the_pressure_drop_of_a_bed_on_a_plate_is_that_of_its_nodes() {
    let mut bench = Bench::new([4.2, 4.2, 30.0], [PERIODIC, PERIODIC, PLATE]);
    bench.add_layers(160, (1.03, 0.55), &[1.0, 0.8], (0.01, 0.0));
    for drag in [DragLaw::WEN_YU_CREEPING, DragLaw::WEN_YU] {
        let mut flow = gas(0.5);
        flow.drag = drag.clone();
        bench.gas = Some(flow);
        let run = bench.alone();
        let cell = 4.2 * 4.2 * 1.5;
        let mut expected = 0.0;
        for node in 0..21 {
            let (mut phi, mut lengths) = (0.0, 0.0);
            for it in &bench.particles {
                let weight = (1.0 - (it.position[2] / 1.5 - f64::from(node)).abs()).max(0.0);
                phi += weight * 4.0 / 3.0 * PI * it.radius.powi(3) / cell;
                lengths += weight * 2.0 * it.radius / cell;
            }
            if phi > 0.0 {
                let mean_diameter = (6.0 * phi / (PI * lengths)).sqrt();
                let beta = momentum_transfer(&drag, phi, mean_diameter, 0.5);
                expected += beta * 0.5 / (1.0 - phi).powi(2) * 1.5;
            }
        }
        let found = run.work.gas.column().unwrap().pressure_drop();
        assert!((found / expected - 1.0).abs() < 1.0e-12, "{found} for {expected}"); // round-off
    }
}

/// Shaken, cohesive, between side walls, of two sizes, with gas: everything that acts on a bed.
fn bed_between_walls() -> Bench {
    let mut bench = Bench::new([4.4, 4.4, 30.0], [[Face::Wall; 2], PERIODIC, PLATE]);
    bench.contact = law(2.0e4, 0.9, 0.3);
    bench.time_step = 5.0e-4;
    bench.gravity = shaken(3.0, 0.16);
    bench.cohesion = Some(attraction((3.0, 1.5), 1.0, (1.0e-4, 0.01)));
    let mut flow = gas(0.05);
    flow.drag = DragLaw::WEN_YU;
    flow.lateral_drag = true;
    bench.gas = Some(flow);
    bench.add_layers(160, (1.05, 0.6), &[1.0, 0.8], (0.01, 0.5));
    bench
}

#[test]
fn plate_gas_and_weight_change_the_momentum_at_every_step() {
    let bench = bed_between_walls();
    for grid in [[1, 1, 1], [1, 1, 3]] {
        let (worst, without_gas) = bench.on_ranks(grid, |run| {
            let mut profile = profile_of(run);
            let (mut worst, mut without_gas) = (0.0_f64, f64::INFINITY);
            for step in 0..2000 {
                let error = step_and_measure(run, &mut profile).momentum_error;
                worst = worst.max(error);
                if step % 500 == 499 {
                    // Negative control: the same balance without the gas.
                    let probe = MomentumProbe::take(&run.state.particles, run.ranks);
                    run.steps(1);
                    run.work.gas = GasSolver::None;
                    let talcum::setup::Run { state, domain, models, work, ranks } = &mut **run;
                    let probe = Some(probe);
                    let view = RunView { state, domain, models, work };
                    let wrong = series_row(view, &mut profile, probe, *ranks);
                    without_gas = without_gas.min(wrong.momentum_error);
                }
            }
            (worst, without_gas)
        });
        println!(
            "momentum balance, ranks {grid:?}: {worst:.1e} of the weight; without gas {without_gas:.1e}"
        );
        // All forces lie on one lattice and add up without error. What rounds are the velocities: two
        // kicks of half an ulp each (1e-16 at speeds of 1) over dt, of each particle: 4e-13 of its
        // weight, less by chance in the sum over 160.
        assert!(worst < 1.0e-12, "{worst:.1e}");
        assert!(without_gas > 1.0e-4, "{without_gas:.1e}");
    }
}

/// The same balance once more, vertically, from the printed measures alone.
#[test]
fn plate_stress_and_gas_force_less_weight_is_the_acceleration() {
    let mut bench = bed_between_walls();
    bench.domain = Bench::new([4.4, 4.4, 30.0], [PERIODIC, PERIODIC, PLATE]).domain;
    let mut run = bench.alone();
    let mut profile = profile_of(&run);
    let mut before = step_and_measure(&mut run, &mut profile);
    let (mut worst, mut least_without_gas) = (0.0_f64, 0.0_f64);
    for _ in 0..2000 {
        let now = step_and_measure(&mut run, &mut profile);
        let force = |it: &SeriesRow| it.plate_stress + it.gas_force - it.effective_gravity;
        let acceleration = (now.centre_velocity - before.centre_velocity) / bench.time_step;
        let mean = 0.5 * (force(&before) + force(&now));
        worst = worst.max((acceleration - mean).abs());
        let without = 0.5 * (before.gas_force + now.gas_force);
        least_without_gas = least_without_gas.max((acceleration - mean + without).abs());
        before = now;
    }
    // Velocity of the centre in half ulps (1e-16) over dt; the weight is rounded to forces of 1e-10 of 0.5.
    assert!(worst < 1.0e-9, "{worst:.1e}");
    assert!(least_without_gas > 0.1); // negative control
}

/// A dense, shaken, fully periodic box whose gas carries the weight.
fn weightless_box(balance: WeightBalance, drag: DragLaw, diameters: &[f64]) -> Bench {
    let mut bench = Bench::new([4.4, 4.4, 9.0], [PERIODIC; 3]);
    bench.contact = law(2.0e4, 0.9, 0.1);
    bench.time_step = 5.0e-4;
    bench.gravity = shaken(3.0, 0.5);
    let mut flow = gas(0.0);
    (flow.drive, flow.drag) = (Drive::Weight(balance), drag);
    bench.gas = Some(flow);
    bench.add_layers(128, (1.1, 0.55), diameters, (0.0, 0.3));
    bench
}

/// Largest acceleration of the box's centre over time since the start, over gravity.
fn drift(bench: &Bench) -> f64 {
    let mut run = bench.alone();
    let mut profile = profile_of(&run);
    run.steps(2000); // the layers of the start are gone
    let start = step_and_measure(&mut run, &mut profile);
    let mut drift = 0.0_f64;
    for _ in 0..30 {
        run.steps(99);
        let now = step_and_measure(&mut run, &mut profile);
        let velocity = now.centre_velocity - start.centre_velocity;
        drift = drift.max(velocity.abs() / (now.time - start.time));
        // At this instant too, by the measure that the case chose; round-off as below.
        let carried = match bench.gas.as_ref().map(|flow| &flow.drive) {
            Some(Drive::Weight(WeightBalance::ParticleForce)) => now.gas_force,
            _ => now.grid_pressure_drop,
        };
        let excess = carried - now.effective_gravity;
        assert!(excess.abs() < 1.0e-9, "{excess:.1e}");
    }
    drift
}

#[test]
fn gas_that_carries_the_weight_lets_nothing_drift() {
    for drag in [DragLaw::WEN_YU_CREEPING, DragLaw::WEN_YU] {
        for diameters in [[1.0, 1.0], [1.1, 0.7]] {
            let drift =
                drift(&weightless_box(WeightBalance::ParticleForce, drag.clone(), &diameters));
            println!("weight by particle force, {drag:?} {diameters:?}: drift {drift:.1e} of g");
            // Gas forces are rounded to 1e-10, of weights of 0.2 to 0.7.
            assert!(drift < 1.0e-9, "{drift:.1e}");
        }
    }
}

#[test]
fn the_grid_integral_lets_the_box_drift_a_little() {
    for drag in [DragLaw::WEN_YU_CREEPING, DragLaw::WEN_YU] {
        for diameters in [vec![1.0], vec![1.0, 0.7]] {
            let drift =
                drift(&weightless_box(WeightBalance::GridIntegral, drag.clone(), &diameters));
            println!("weight by grid integral, {drag:?} {diameters:?}: drift {drift:.1e} of g");
            // phi is averaged twice, up to the particles and back: 1 to 2 % of the force, here of the mean
            // of g_eff.
            assert!(drift < 0.02, "{drift:.1e}");
            assert!(drift > 1.0e-5); // negative control: the measure of drift is not blind
        }
    }
}

#[test]
fn an_empty_column_is_fine() {
    for faces in [PLATE, OPEN] {
        let mut bench = Bench::new([5.0, 5.0, 10.0], [PERIODIC, PERIODIC, faces]);
        bench.gas = Some(gas(0.12));
        bench.gravity = EffectiveGravity { magnitude: 1.0, vibration: None };
        for grid in [[1, 1, 1], [1, 1, 2]] {
            let now = bench.on_ranks(grid, |run| {
                let mut profile = profile_of(run);
                run.steps(20);
                step_and_measure(run, &mut profile)
            });
            assert_eq!(now.superficial_velocity, 0.12);
            let zeros = [now.grid_pressure_drop, now.gas_force, now.plate_stress, now.particles];
            assert_eq!(zeros, [0.0; 4]);
            assert!(now.momentum_error == 0.0 && now.mass_error == 0.0 && now.centre_height == 0.0);
        }
    }
}

#[test]
fn measures_have_the_same_bits_on_any_number_of_ranks() {
    let beds = [
        bed_between_walls(),
        weightless_box(WeightBalance::ParticleForce, DragLaw::WEN_YU, &[1.1, 0.7]),
        weightless_box(WeightBalance::GridIntegral, DragLaw::WEN_YU, &[1.0]),
    ];
    for bench in beds {
        let measures = |grid| {
            bench.on_ranks(grid, |run| {
                let mut profile = profile_of(run);
                let rows = (0..20).map(|_| {
                    run.steps(24);
                    step_and_measure(run, &mut profile)
                });
                rows.collect::<Vec<SeriesRow>>()
            })
        };
        let alone = measures([1, 1, 1]);
        for grid in [[1, 1, 2], [1, 1, 3], [1, 2, 2]] {
            assert_eq!(measures(grid), alone, "{grid:?}");
        }
        // Negative control: a viscosity that differs by one part in 10^14.
        let mut other = bench.clone();
        let flow = other.gas.as_mut().unwrap();
        flow.viscosity *= 1.0 + 1.0e-14;
        let rows = other.on_ranks([1, 1, 1], |run| {
            let mut profile = profile_of(run);
            run.steps(499);
            step_and_measure(run, &mut profile)
        });
        assert_eq!(rows.time, alone[19].time);
        assert_ne!(Some(&rows), alone.last());
    }
}
