//! Granular temperature without a source: Haff's law, drag by a gas at rest, and both together.

use super::gas_on_cells;
use crate::beds::{Bench, PERIODIC, law};
use nalgebra::Vector3;
use std::f64::consts::PI;
use talcum::gas::volume_averaged::Boundary;
use talcum::gas::{DragLaw, WenYuCreeping};
use talcum::numbers::{normal, random_of};

const LENGTH: f64 = 21.4;
const COUNT: u64 = 1000;

/// T over T_0 at each time unit, for particles of diameter, density and T_0 = 1.
fn temperatures(restitution: f64, viscosity: Option<f64>) -> Vec<f64> {
    let mut bench = Bench::new([LENGTH; 3], [PERIODIC; 3]);
    bench.contact = law(2.0e4, restitution, 0.0);
    bench.time_step = 1.0e-3;
    bench.skin = Some(0.4);
    bench.add_layers(COUNT, (2.1, 1.0), &[1.0], (0.4, 0.0));
    let mut mean = Vector3::zeros();
    let mut velocities: Vec<Vector3<f64>> = (0..COUNT)
        .map(|id| {
            let mut generator = random_of(7, id, "velocity");
            let velocity = Vector3::from_fn(|_, _| normal(&mut generator));
            mean += velocity / COUNT as f64;
            velocity
        })
        .collect();
    velocities.iter_mut().for_each(|velocity| *velocity -= mean);
    let square: f64 = velocities.iter().map(Vector3::norm_squared).sum::<f64>() / COUNT as f64;
    for (particle, velocity) in bench.particles.iter_mut().zip(velocities) {
        particle.velocity = (velocity * (3.0 / square).sqrt()).into();
    }
    if let Some(viscosity) = viscosity {
        let creeping = DragLaw::WenYuCreeping(WenYuCreeping::USUAL);
        let mut model = gas_on_cells(&bench, [2, 2, 2], (1.0e-3, viscosity), creeping, 0.0);
        model.gas.boundaries = [(); 3].map(|()| [(); 2].map(|()| Boundary::Periodic));
        model.substeps = 20;
        bench.volume_averaged = Some(model);
    }
    let mut run = bench.alone();
    (0..8)
        .map(|_| {
            run.steps(1000);
            let squares = run.state.particles.body[..COUNT as usize].iter();
            squares.map(|body| body.velocity.norm_squared()).sum::<f64>() / (3.0 * COUNT as f64)
        })
        .collect()
}

/// dT/dt = -2 C T - A T^(3/2): sqrt(T) = e^(-C t) / [1 + (A / (2 C)) (1 - e^(-C t))], Haff's law for C -> 0.
fn law_of_cooling(collisions: f64, drag: f64, time: f64) -> f64 {
    let decay = (-drag * time).exp();
    let spent = if drag > 0.0 { (1.0 - decay) / drag } else { time };
    (decay / (1.0 + 0.5 * collisions * spent)).powi(2)
}

/// A = 8 (1 - e^2) phi g_0 / (d sqrt(pi)), g_0 by Carnahan & Starling.
fn collisions(restitution: f64, phi: f64) -> f64 {
    let contact = (1.0 - 0.5 * phi) / (1.0 - phi).powi(3);
    8.0 * (1.0 - restitution.powi(2)) * phi * contact / PI.sqrt()
}

/// Largest deviation of T from a law of cooling.
fn deviation(found: &[f64], collisions: f64, drag: f64) -> f64 {
    let expected = |k: usize| law_of_cooling(collisions, drag, (k + 1) as f64);
    let deviations = found.iter().enumerate().map(|(k, t)| (t / expected(k) - 1.0).abs());
    deviations.fold(0.0, f64::max)
}

#[test]
fn granular_temperature_decays_by_collisions_by_drag_and_by_both() {
    let phi = COUNT as f64 * PI / 6.0 / LENGTH.powi(3);
    let viscosity = 0.002;
    // C = gamma / m, gamma = 3 pi mu d eps F.
    let drag = 18.0 * viscosity * (1.0 - phi).powf(-2.65);
    let with = collisions(0.8, phi);
    let dry = temperatures(0.8, None);
    let elastic = temperatures(1.0, Some(viscosity));
    let both = temperatures(0.8, Some(viscosity));
    let [a, b, c] =
        [deviation(&dry, with, 0.0), deviation(&elastic, 0.0, drag), deviation(&both, with, drag)];
    println!(
        "cooling: T after 8: {:.3} {:.3} {:.3}, deviations {a:.3} {b:.3} {c:.3}",
        dry[7], elastic[7], both[7]
    );
    // Some 500 collisions of 1000 particles happen: a scatter of 4 % of what they take, and the first ones follow the
    // lattice that the particles begin on.
    assert!(a < 0.08 && c < 0.08, "{a} {c}");
    // The gas of each of 8 cells moves with the mean of its 125 particles: it takes 1 % less.
    assert!(b < 0.02, "{b}");
    // Negative control: each law misses what the other process does.
    assert!(deviation(&both, with, 0.0) > 0.2 && deviation(&both, 0.0, drag) > 0.2);
}
