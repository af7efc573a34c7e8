//! The Archimedes number, which determines the regime in which a particle falls.

/// Ar = rho_g (rho_s - rho_g) g d^3 / mu^2, with the densities of gas and solid, gravity g, the diameter d and the
/// viscosity mu of the gas.
///
/// ```
/// # use talcum_engine as talcum;
/// use talcum::rules::archimedes_number;
/// // Glass beads of 0.1 mm in air: viscosity decides (Ar below some 100, Geldart's group A).
/// let number = archimedes_number([1.2, 2500.0], 9.81, 1.0e-4, 1.8e-5);
/// assert!((number - 90.8).abs() < 0.1); // three digits of the numbers above
/// ```
pub fn archimedes_number(
    [gas_density, density]: [f64; 2],
    gravity: f64,
    diameter: f64,
    viscosity: f64,
) -> f64 {
    gas_density * (density - gas_density) * gravity * diameter.powi(3) / viscosity.powi(2)
}
