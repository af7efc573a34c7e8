//! The Stokes number of a particle that falls in the gas.

/// St = rho_s g^(1/2) d^(3/2) / mu, with the density of the solid, gravity g, the diameter d and the viscosity mu of
/// the gas (Moon et al. 2006).
///
/// ```
/// # use talcum_engine as talcum;
/// use talcum::rules::{stokes_number, viscosity_of_stokes_number};
/// let viscosity = viscosity_of_stokes_number(55.0, 2500.0, 9.81, 80.0e-6);
/// assert!((stokes_number(viscosity, 2500.0, 9.81, 80.0e-6) - 55.0).abs() < 1.0e-12); // rounding
/// ```
pub fn stokes_number(viscosity: f64, density: f64, gravity: f64, diameter: f64) -> f64 {
    viscosity_of_stokes_number(viscosity, density, gravity, diameter)
}

/// mu = rho_s g^(1/2) d^(3/2) / St, the inverse of [`stokes_number`].
pub fn viscosity_of_stokes_number(
    stokes_number: f64,
    density: f64,
    gravity: f64,
    diameter: f64,
) -> f64 {
    density * (gravity * diameter).sqrt() * diameter / stokes_number
}
