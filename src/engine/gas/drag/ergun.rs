//! Drag by Ergun, of packed beds.
//!
//! References:
//! * S. Ergun, "Fluid flow through packed columns", Chem. Eng. Prog. 48 (1952) 89-94 (without DOI)

use super::law::DENSITY;
use super::{DragCorrelation, RegisteredDragLaw};
use crate::schema::{Key, KeyValues};

/// Ergun (1952), the pressure drop of a packed bed.
///
/// ```math
/// F = \frac{150\, \phi + 1.75\, Re}{18\, \varepsilon^2}, \qquad
/// \frac{\Delta p}{L} = \frac{150\, \mu\, \phi^2 U}{\varepsilon^3 d^2} + \frac{1.75\, \rho_g\, \phi\, U^2}{\varepsilon^3 d}
/// ```
///
/// U is the superficial velocity. The law is not meaningful in dilute suspensions, where it goes to zero with phi and
/// Re.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ergun;

impl DragCorrelation for Ergun {
    #[inline(always)]
    fn scaled_drag(&self, solids_fraction: f64, reynolds: f64) -> f64 {
        (150.0 * solids_fraction + 1.75 * reynolds) / (18.0 * (1.0 - solids_fraction))
    }
}

impl RegisteredDragLaw for Ergun {
    const MEANING: &'static str = "Ergun";
    const KEYS: &'static [Key] = &[DENSITY];

    fn from_keys(_: &dyn KeyValues) -> Option<Self> {
        Some(Self)
    }

    fn examples() -> Vec<Self> {
        vec![Self]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_gives_the_pressure_drop_of_packed_beds() {
        // d, eps, U and dp/L in air of 1.2 kg/m3 and 1.8e-5 Pa s.
        for [d, eps, speed, expected] in [
            [1.0e-3, 0.40, 0.1, 1715.625],
            [1.0e-3, 0.40, 0.5, 12515.625],
            [1.0e-3, 0.45, 0.5, 7650.206],
            [40.0e-6, 0.42, 0.01, 76662.8],
        ] {
            let (density, viscosity, phi) = (1.2, 1.8e-5, 1.0 - eps);
            let reynolds = density * d * speed / viscosity;
            let beta = 18.0 * viscosity * phi / (d * d) * Ergun.scaled_drag(phi, reynolds);
            // -eps dp/dz = beta u with u = U / eps.
            let gradient = beta * speed / (eps * eps);
            assert!((gradient / expected - 1.0).abs() < 1.0e-6, "{gradient} {expected}");
        }
    }
}
