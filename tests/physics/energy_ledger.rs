//! The energy ledger: the work of all mechanisms balances the stored energy, for every contact law, with an error that
//! falls with the step. The ledger changes no bit, and has the same bits on any ranks.

use crate::beds::{Bench, PERIODIC, PLATE, attraction, gas, law};
use nalgebra::Vector3;
use talcum::contact::{
    ContactLaw, ContactModel, ExampleScales, FrictionCap, LinearSpringDashpot, RollingFriction,
    RollingKind, TwistingFriction,
};
use talcum::domain::{EffectiveGravity, Face, WallMotion};
use talcum::numbers::Schedule;
use talcum::state::{EnergyBalance, Mechanism};

const STEP: f64 = 2.0e-4;

/// A bed that falls onto a plate.
fn falling(contact: impl Into<ContactModel>) -> Bench {
    let mut bench = Bench::new([4.2, 4.2, 20.0], [PERIODIC, PERIODIC, PLATE]);
    bench.interface = Some(contact.into());
    bench.gravity = EffectiveGravity { magnitude: 1.0, vibration: None };
    bench.time_step = STEP;
    bench.add_layers(120, (1.03, 0.55), &[1.0, 0.9], (0.012, 1.0));
    bench
}

/// What the ledger says after a time.
fn balance_after(bench: &Bench, time: f64) -> EnergyBalance {
    let mut run = bench.alone();
    run.keep_energy_ledger();
    run.steps((time / bench.time_step).round() as u64);
    run.energy_balance().unwrap()
}

/// Closure errors over all work, with a step and with half of it.
fn errors(bench: &Bench, time: f64) -> [f64; 2] {
    [1.0, 0.5].map(|part| {
        let mut bench = bench.clone();
        bench.time_step *= part;
        let balance = balance_after(&bench, time);
        println!("{balance:?}: {:.2e}", balance.relative_error());
        balance.relative_error()
    })
}

#[test]
fn every_contact_law_closes_to_the_order_of_the_integrator() {
    let scales = ExampleScales { stiffness: 2.0e4, overlap: 4.0e-3, restitution: 0.8 };
    for law in ContactLaw::examples(scales) {
        let name = law.name().to_owned();
        let [coarse, fine] = errors(&falling(law), 2.0);
        println!("energy ledger, {name}: {coarse:.2e}, {fine:.2e}");
        // Dashpots act at velocities half a step old: the integrator is of first order, 1 - e^2 times omega dt / 2 = 2e-3 of
        // what they take, and contacts that begin or end within a step add to it by chance.
        assert!(coarse < 2.0e-2, "{name}: {coarse}");
        // A half of the error with half of the step.
        assert!((0.3..0.7).contains(&(fine / coarse)), "{name}: {coarse} {fine}");
    }
}

#[test]
fn without_dissipation_the_ledger_closes_to_second_order() {
    let elastic = LinearSpringDashpot::new(2.0e4, 1.6e4, 1.0, 0.0, FrictionCap::Contact).unwrap();
    let [coarse, fine] = errors(&falling(elastic), 1.0);
    println!("energy ledger, elastic: {coarse:.2e}, {fine:.2e}");
    // (omega dt)^2 / 8 of the energy of a contact, omega dt = 0.055; a quarter of it with half of the step, or less by chance.
    assert!(coarse < 4.0e-4 && fine < 0.45 * coarse, "{coarse} {fine}");
}

#[test]
fn each_mechanism_has_its_own_work() {
    let of = |restitution: f64, friction: f64| {
        balance_after(&falling(law(2.0e4, restitution, friction)), 2.0)
    };
    let both = of(0.8, 0.3);
    assert!(both.of(Mechanism::Dashpot) < -1.0 && both.of(Mechanism::Friction) < -1.0, "{both:?}");
    assert_eq!(of(1.0, 0.3).of(Mechanism::Dashpot), 0.0);
    let smooth = of(0.8, 0.0);
    // Springs without friction hold nothing.
    assert_eq!(smooth.of(Mechanism::Friction), 0.0);
    for mechanism in [Mechanism::Plasticity, Mechanism::Gas, Mechanism::Walls, Mechanism::Models] {
        assert_eq!(both.of(mechanism), 0.0, "{mechanism:?}");
    }
    // Negative control: whatever is left out of the sum is missed.
    for mechanism in [Mechanism::Dashpot, Mechanism::Friction, Mechanism::Gravity] {
        let missed = both.closure_error + both.of(mechanism);
        assert!(missed.abs() > 20.0 * both.closure_error.abs(), "{mechanism:?}: {both:?}");
    }
}

/// A bed with rolling and twisting friction, attraction that is ramped, a gas, and a wall that swings.
fn with_everything() -> Bench {
    let rolling = RollingFriction::new(RollingKind::ElasticPlastic { damping: 0.3 }, 0.2).unwrap();
    let twisting = TwistingFriction::new(0.3, 0.1, 0.2).unwrap();
    let (rolling, twisting) = (Some(rolling), Some(twisting));
    let contact = ContactModel { rolling, twisting, ..law(2.0e4, 0.8, 0.4).into() };
    let mut bench = Bench::new([4.2, 4.2, 24.0], [[Face::Wall; 2], PERIODIC, PLATE]);
    bench.interface = Some(contact);
    bench.gravity = EffectiveGravity { magnitude: 1.0, vibration: None };
    bench.time_step = STEP;
    bench.add_layers(90, (1.05, 0.6), &[1.0, 0.9], (0.012, 0.5));
    let mut cohesion = attraction((3.0, 1.5), 1.0, (0.02, 0.2));
    let full = cohesion.hamaker_constant.largest();
    cohesion.hamaker_constant = Schedule::Ramp { from: 0.0, to: full, start: 0.2, end: 1.2 };
    bench.cohesion = Some(cohesion);
    bench.gas = Some(gas(0.15));
    let amplitude = Vector3::new(0.0, 0.05, 0.02);
    bench.domain.walls[0].motion = WallMotion { amplitude, frequency: 2.0, ..WallMotion::REST };
    bench
}

#[test]
fn gas_walls_in_motion_rolling_and_ramps_close_too() {
    let bench = with_everything();
    let [coarse, fine] = errors(&bench, 1.5);
    println!("energy ledger, everything: {coarse:.2e}, {fine:.2e}");
    assert!(coarse < 2.0e-2 && (0.3..0.7).contains(&(fine / coarse)), "{coarse} {fine}");
    let balance = balance_after(&bench, 1.5);
    for mechanism in [Mechanism::Gas, Mechanism::Walls, Mechanism::Models, Mechanism::Friction] {
        let part = balance.of(mechanism).abs() / balance.closure_error.abs();
        // Negative control: each of them is larger than the error, so that it would be missed.
        assert!(part > 2.0, "{mechanism:?}: {balance:?}");
    }
}

#[test]
fn the_ledger_changes_no_bit_and_is_the_same_on_any_ranks() {
    let bench = with_everything();
    let on = |grid: [usize; 3], keeps: bool| {
        bench.on_ranks(grid, |run| {
            if keeps {
                run.keep_energy_ledger();
            }
            run.steps(3000);
            (run.snapshot().bits(), run.energy_balance())
        })
    };
    let (without, none) = on([1, 1, 1], false);
    assert_eq!(none, None);
    let (bits, alone) = on([1, 1, 1], true);
    assert!(bits == without, "an account changes nothing");
    for grid in [[1, 1, 2], [1, 1, 3], [2, 1, 2]] {
        let (bits, balance) = on(grid, true);
        assert!(bits == without, "{grid:?}");
        assert_eq!(balance, alone, "{grid:?}");
    }
}
