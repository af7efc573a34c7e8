//! Drag by Beetstra, van der Hoef & Kuipers.
//!
//! References:
//! * R. Beetstra, M. A. van der Hoef, J. A. M. Kuipers, "Drag force of intermediate Reynolds number flow past mono- and
//!   bidisperse arrays of spheres", AIChE J. 53 (2007) 489-501, <https://doi.org/10.1002/aic.11065>

use super::law::DENSITY;
use super::{DragCorrelation, RegisteredDragLaw};
use crate::numbers::power;
use crate::schema::{Key, KeyValues};

/// Beetstra, van der Hoef & Kuipers (2007), from lattice-Boltzmann simulations of arrays of spheres up to
/// Re = 1000.
///
/// ```math
/// F = \frac{10 \phi}{\varepsilon^2} + \varepsilon^2 (1 + 1.5 \sqrt{\phi}) + \frac{0.413\, Re}{24\, \varepsilon^2}\,
///     \frac{\varepsilon^{-1} + 3 \varepsilon \phi + 8.4\, Re^{-0.343}}{1 + 10^{3 \phi}\, Re^{-(1/2 + 2 \phi)}}
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beetstra;

/// Reynolds number below which the inertial part is lost in the rounding of the viscous one.
const SLOWEST: f64 = 1.0e-14;

impl DragCorrelation for Beetstra {
    #[inline(always)]
    fn scaled_drag(&self, solids_fraction: f64, reynolds: f64) -> f64 {
        let (phi, eps, reynolds) = (solids_fraction, 1.0 - solids_fraction, reynolds.max(SLOWEST));
        let viscous = 10.0 * phi / (eps * eps) + eps * eps * (1.0 + 1.5 * phi.sqrt());
        // Both brackets times Re^(1/2 + 2 phi), so that no power of a small number grows large.
        let raised = power(reynolds, 0.5 + 2.0 * phi);
        let above = 1.0 / eps + 3.0 * eps * phi + 8.4 * power(reynolds, -0.343);
        let ratio = raised * above / (raised + power(10.0, 3.0 * phi));
        eps * (viscous + 0.413 * reynolds / (24.0 * eps * eps) * ratio)
    }
}

impl RegisteredDragLaw for Beetstra {
    const MEANING: &'static str = "Beetstra, van der Hoef and Kuipers";
    const KEYS: &'static [Key] = &[DENSITY];

    fn from_keys(_: &dyn KeyValues) -> Option<Self> {
        Some(Self)
    }

    fn examples() -> Vec<Self> {
        vec![Self]
    }
}
