//! A particle in the column gas: Stokes' law, MFiX DEM06, and unit values of the drag law.

use crate::beds::{Bench, OPEN, PERIODIC, gas};
use talcum::domain::EffectiveGravity;
use talcum::gas::Drive;
use talcum::gas::{DragCorrelation, DragLaw};
use talcum::numbers::Schedule;

#[test]
fn wen_yu_has_the_tabulated_values() {
    // F = F_d / (3 pi mu d eps |u - v|), computed by hand from (1 + 0.15 Re^0.687) eps^-3.65.
    let table = [
        (0.1, 1.0, 1.68932),
        (0.1, 100.0, 6.68220),
        (0.3, 1.0, 4.22756),
        (0.3, 100.0, 16.72232),
        (0.5, 1.0, 14.43635),
        (0.5, 100.0, 57.10366),
        (0.6, 1.0, 32.59709),
        (0.6, 100.0, 128.93935),
    ];
    for (phi, reynolds, expected) in table {
        let found = DragLaw::WEN_YU.scaled_drag(phi, reynolds) / (1.0 - phi);
        assert!((found - expected).abs() < 6.0e-6, "{found} for {expected}"); // digits of the table
        let creeping = DragLaw::WEN_YU_CREEPING.scaled_drag(phi, reynolds) / (1.0 - phi);
        assert!((creeping - expected).abs() > 1.0e-2); // negative control: without the Reynolds number
    }
}

#[test]
fn a_particle_settles_as_stokes_says() {
    let mut bench = Bench::new([200.0, 200.0, 40.0], [PERIODIC, PERIODIC, OPEN]);
    bench.gas = Some(gas(0.0));
    bench.gravity = EffectiveGravity { magnitude: 1.0, vibration: None };
    bench.time_step = 1.0e-3;
    bench.add([100.0, 100.0, 30.0], [0.0; 3], 0.5);
    let terminal = 55.0 / 18.0; // m g / (3 pi mu d) with St = 55
    let mut run = bench.alone();
    let mut worst = 0.0_f64;
    for _ in 0..60 {
        run.steps(100);
        let expected = terminal * (1.0 - (-run.time() / terminal).exp());
        let error = run.particle(0).velocity[2] / expected + 1.0;
        worst = worst.max(error.abs());
    }
    println!("Stokes settling: largest relative error {worst:.1e}");
    // The particle fills 0.52 / (200 x 200 x 1.5) of its cell: drag is more by 4.65 times that, 4e-5. Half-step
    // velocities in the drag: dt / (2 tau) = 1.6e-4 of what the drag is.
    assert!(worst < 2.5e-4, "{worst:.1e}");
    // Negative control: a diameter of 1 % more (velocity 2 % more) would be seen.
    let velocity = -run.particle(0).velocity[2];
    assert!(
        (velocity / (1.02 * terminal * (1.0 - (-run.time() / terminal).exp())) - 1.0).abs() > 0.01
    );
}

/// Absolute velocity of MFiX's sphere (100 um, 2000 kg/m^3) 0.35 s after it was at rest in gas of 0.4 m/s.
fn dem06(drag: DragLaw) -> f64 {
    let d = 1.0e-4;
    let mut bench = Bench::new([200.0 * d, 200.0 * d, 0.1], [PERIODIC, PERIODIC, OPEN]);
    bench.contact = crate::beds::law(10.0, 0.9, 0.1);
    let mut air = gas(0.0);
    air.spacing = 1.5 * d;
    air.viscosity = 1.8e-5;
    air.density = 1.2;
    air.drag = drag;
    air.drive = Drive::Velocity(Schedule::Constant(0.4));
    bench.gas = Some(air);
    // MFiX's sphere floats a little; the model's, for which gas weighs nothing, is lighter instead.
    let buoyant = 9.81 * (1.0 - 1.2 / 2000.0);
    bench.gravity = EffectiveGravity { magnitude: buoyant, vibration: None };
    bench.density = 2000.0;
    bench.skin = Some(0.15 * d);
    bench.time_step = 1.0e-5;
    bench.add([100.0 * d, 100.0 * d, 0.05], [0.0, 0.0, 0.4], 0.5 * d);
    bench.alone().steps(35_000).particle(0).velocity[2]
}

/// The same from its equation of motion with Schiller & Naumann's drag, by the classical Runge-Kutta method.
fn dem06_reference() -> f64 {
    let (viscosity, gas_density, d, density) = (1.8e-5, 1.2, 1.0e-4, 2000.0);
    let rate = |v: f64| {
        let slip: f64 = 0.4 - v;
        let reynolds = gas_density * d * slip.abs() / viscosity;
        let drag = 18.0 * viscosity / (density * d * d) * (1.0 + 0.15 * reynolds.powf(0.687));
        drag * slip - 9.81 * (1.0 - gas_density / density)
    };
    let (mut v, dt) = (0.4, 1.0e-4);
    for _ in 0..3500 {
        let first = rate(v);
        let second = rate(v + 0.5 * dt * first);
        let third = rate(v + 0.5 * dt * second);
        v += dt / 6.0 * (first + 2.0 * (second + third) + rate(v + dt * third));
    }
    v
}

#[test]
fn dem06_terminal_velocity() {
    let (found, exact) = (dem06(DragLaw::WEN_YU), dem06_reference());
    println!("DEM06: v(0.35 s) {found:.6}, reference {exact:.6} (published -0.05739)");
    // The particle's own solids fraction is 9e-6: its drag is 4e-5 more, its slip of 0.457 not quite as much less.
    assert!((found - exact).abs() < 2.0e-5, "{found} for {exact}");
    // The published reference and its terminal slip of 0.45754, from another start of the transient.
    assert!((found + 0.05739).abs() < 1.0e-4 && (0.4 - found - 0.45754).abs() < 2.0e-4);
    // Negative control: Stokes' drag is far off.
    assert!((dem06(DragLaw::WEN_YU_CREEPING) - exact).abs() > 0.1);
}
