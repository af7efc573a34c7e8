//! The gas velocity at which the gas carries a bed at rest.

use talcum_engine::gas::GasModel;

/// Force of the gas on a particle at rest in a bed at rest: (V / phi) beta U / (1 - phi)^2, mean pressure gradient
/// included.
///
/// `drag` is (V / phi) beta, the drag per velocity, U the superficial velocity, phi the solids fraction (Moon et al.
/// 2006, eq. (12)).
pub fn gas_force_at_rest(drag: f64, superficial_velocity: f64, solids_fraction: f64) -> f64 {
    drag * superficial_velocity / (1.0 - solids_fraction).powi(2)
}

/// U_mf: the least superficial velocity at which [`gas_force_at_rest`] equals the weight m g of a particle.
///
/// `drag` gives the drag per velocity at this solids fraction for a superficial velocity; its product with the velocity
/// must increase without bound. U_mf is found by bisection, to rounding.
///
/// ```
/// # mod talcum { pub use talcum_engine::*; pub use talcum_results::*; }
/// use talcum::analysis::minimum_fluidisation::minimum_fluidisation_velocity;
/// // Stokes' drag 3 pi mu d on a sphere with mu = 1/55, d = 1 and weight pi/6: U = (St / 18) (1 - phi)^2.
/// let drag = 3.0 * std::f64::consts::PI / 55.0;
/// let velocity = minimum_fluidisation_velocity(|_| drag, std::f64::consts::PI / 6.0, 0.6);
/// assert!((velocity - 55.0 / 18.0 * 0.16).abs() < 1.0e-12); // rounding
/// ```
pub fn minimum_fluidisation_velocity(
    drag: impl Fn(f64) -> f64,
    weight: f64,
    solids_fraction: f64,
) -> f64 {
    let force = |velocity: f64| gas_force_at_rest(drag(velocity), velocity, solids_fraction);
    let (mut low, mut high) = (0.0, 1.0e-12);
    while force(high) < weight {
        high *= 2.0;
    }
    // The number of halvings exceeds the number of bits.
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if force(middle) < weight { low = middle } else { high = middle }
    }
    high
}

/// U_mf of the force balance: the superficial velocity at which this gas carries a bed at rest of particles of a diameter and
/// weight, at a solids fraction. None without gas or weight.
pub fn velocity_of_balance(
    gas: &GasModel,
    (diameter, weight): (f64, f64),
    solids_fraction: f64,
) -> Option<f64> {
    let drag = match gas {
        GasModel::None => return None,
        GasModel::Column(gas) => gas.particle_drag(),
        GasModel::VolumeAveraged(model) => model.coupling.drag.clone(),
    };
    let per_velocity = |velocity: f64| drag.per_velocity(diameter, solids_fraction, velocity);
    let balance = || minimum_fluidisation_velocity(per_velocity, weight, solids_fraction);
    (weight > 0.0 && (0.0..1.0).contains(&solids_fraction)).then(balance)
}
