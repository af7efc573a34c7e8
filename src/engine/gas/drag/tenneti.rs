//! Drag by Tenneti, Garg & Subramaniam.
//!
//! References:
//! * S. Tenneti, R. Garg, S. Subramaniam, "Drag law for monodisperse gas-solid systems using particle-resolved direct
//!   numerical simulation of flow past fixed assemblies of spheres", Int. J. Multiphase Flow 37 (2011) 1072-1092,
//!   <https://doi.org/10.1016/j.ijmultiphaseflow.2011.05.010>

use super::law::DENSITY;
use super::{DragCorrelation, RegisteredDragLaw};
use crate::numbers::power;
use crate::schema::{Key, KeyValues};

/// Tenneti, Garg & Subramaniam (2011), from particle-resolved simulations of fixed arrays, phi from 0.1 to 0.5
/// and Re up to 300.
///
/// ```math
/// F = \frac{1 + 0.15\, Re^{0.687}}{\varepsilon^3} + \frac{5.81\, \phi}{\varepsilon^3} + \frac{0.48\, \phi^{1/3}}{\varepsilon^4}
///   + \phi^3 Re \left( 0.95 + \frac{0.61\, \phi^3}{\varepsilon^2} \right)
/// ```
///
/// Other programs print phi^(1/3) in the last term, which differs by 29 % at phi = 0.6, Re = 100, or leave 1 undivided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tenneti;

impl DragCorrelation for Tenneti {
    #[inline(always)]
    fn scaled_drag(&self, solids_fraction: f64, reynolds: f64) -> f64 {
        let (phi, eps) = (solids_fraction, 1.0 - solids_fraction);
        let (phi_cubed, eps_cubed) = (phi * phi * phi, eps * eps * eps);
        let single = 1.0 + 0.15 * power(reynolds, 0.687);
        let viscous = 5.81 * phi / eps_cubed + 0.48 * power(phi, 1.0 / 3.0) / (eps_cubed * eps);
        let inertial = phi_cubed * reynolds * (0.95 + 0.61 * phi_cubed / (eps * eps));
        eps * (single / eps_cubed + viscous + inertial)
    }
}

impl RegisteredDragLaw for Tenneti {
    const MEANING: &'static str = "Tenneti, Garg and Subramaniam";
    const KEYS: &'static [Key] = &[DENSITY];

    fn from_keys(_: &dyn KeyValues) -> Option<Self> {
        Some(Self)
    }

    fn examples() -> Vec<Self> {
        vec![Self]
    }
}
