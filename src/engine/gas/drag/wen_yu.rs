//! Drag by Wen & Yu, and its limit at small Reynolds numbers.
//!
//! References:
//! * C. Y. Wen, Y. H. Yu, "Mechanics of fluidization", Chem. Eng. Prog. Symp. Ser. 62 (1966) 100-111
//!   (without DOI)
//! * L. Schiller, A. Naumann, "Über die grundlegenden Berechnungen bei der Schwerkraftaufbereitung", Z. Ver. Dtsch. Ing.
//!   77 (1933) 318-320
//! * S. J. Moon, I. G. Kevrekidis, S. Sundaresan, "Particle simulation of vibrated gas-fluidized beds of cohesive fine
//!   powders", Ind. Eng. Chem. Res. 45 (2006) 6966-6977, eqs (13)-(16)

use super::law::DENSITY;
use super::{DragCorrelation, RegisteredDragLaw};
use crate::numbers::{power, powers};
use crate::schema::{Allowed, Key, KeyValues, Value};

const VOIDAGE_EXPONENT: Key = Key::number(
    "voidage_exponent",
    Allowed::between(0.0, 10.0),
    "n in beta = (3/4) C_D rho_g abs(u_g - v) phi / d eps^-n; Liu 2016 prints 2.7",
)
.default(Value::Number(1.65));

/// Reynolds number above which a sphere's drag coefficient is constant at 0.44.
pub(super) const INERTIAL: f64 = 1000.0;

/// C_D Re / 24 of a single sphere: 1 + 0.15 Re^0.687 (Schiller & Naumann 1935), 0.44 Re / 24 above Re = 1000.
#[inline(always)]
pub(super) fn schiller_naumann(reynolds: f64) -> f64 {
    if reynolds < INERTIAL { 1.0 + 0.15 * power(reynolds, 0.687) } else { 0.44 * reynolds / 24.0 }
}

/// Wen & Yu (1966) with Schiller & Naumann's C_D (Moon 2006 eqs (13)-(15)).
///
/// ```math
/// \beta = \frac{3}{4}\, C_D\, \frac{\rho_g |u_g - v|\, \phi}{d}\, \varepsilon^{-n}, \qquad
/// \varepsilon F = \frac{C_D\, Re}{24}\, \varepsilon^{-(n + 1)}
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WenYu {
    /// n: usually 1.65, so that F = (C_D Re / 24) eps^-3.65; Liu 2016 prints 2.7.
    pub exponent: f64,
}

impl WenYu {
    /// n = 1.65.
    pub const USUAL: Self = Self { exponent: 1.65 };
}

impl DragCorrelation for WenYu {
    /// ```
    /// # use talcum_engine as talcum;
    /// use talcum::gas::{DragCorrelation, WenYu};
    /// let eps = 0.9_f64;
    /// let f = WenYu::USUAL.scaled_drag(0.1, 100.0) / eps;
    /// assert!((f - 6.68220).abs() < 5e-6); // tabulated value
    /// ```
    #[inline(always)]
    fn scaled_drag(&self, solids_fraction: f64, reynolds: f64) -> f64 {
        let [scaled] = self.scaled_drags(&[solids_fraction], &[reynolds]);
        scaled
    }

    #[inline(always)]
    fn scaled_drags<const N: usize>(
        &self,
        solids_fraction: &[f64; N],
        reynolds: &[f64; N],
    ) -> [f64; N] {
        let mut scaled = crowding(solids_fraction, self.exponent);
        let inertia = powers(*reynolds, 0.687);
        for lane in 0..N {
            let viscous = scaled[lane] * (1.0 + 0.15 * inertia[lane]);
            let inertial = scaled[lane] * 0.44 * reynolds[lane] / 24.0;
            scaled[lane] = if reynolds[lane] < INERTIAL { viscous } else { inertial };
        }
        scaled
    }
}

/// Wen & Yu's limit Re << 1 (Moon 2006 eq. (16)); n = 1.65.
///
/// ```math
/// \varepsilon F = \varepsilon^{-(n + 1)}, \qquad \beta = \frac{18\, \mu}{d^2}\, \phi\, \varepsilon^{-2.65}
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WenYuCreeping {
    /// n.
    pub exponent: f64,
}

impl WenYuCreeping {
    /// n = 1.65.
    pub const USUAL: Self = Self { exponent: 1.65 };
}

impl DragCorrelation for WenYuCreeping {
    #[inline(always)]
    fn scaled_drag(&self, solids_fraction: f64, _reynolds: f64) -> f64 {
        let [scaled] = crowding(&[solids_fraction], self.exponent);
        scaled
    }

    #[inline(always)]
    fn scaled_drags<const N: usize>(&self, solids_fraction: &[f64; N], _: &[f64; N]) -> [f64; N] {
        crowding(solids_fraction, self.exponent)
    }

    fn depends_on_reynolds(&self) -> bool {
        false
    }
}

/// eps^-(n + 1) for many particles.
#[inline(always)]
fn crowding<const N: usize>(solids_fraction: &[f64; N], exponent: f64) -> [f64; N] {
    let mut voidage = *solids_fraction;
    for number in &mut voidage {
        *number = 1.0 - *number;
    }
    powers(voidage, -(exponent + 1.0))
}

impl RegisteredDragLaw for WenYu {
    const MEANING: &'static str = "Wen and Yu";
    const KEYS: &'static [Key] = &[VOIDAGE_EXPONENT, DENSITY];

    fn from_keys(values: &dyn KeyValues) -> Option<Self> {
        Some(Self { exponent: values.number("voidage_exponent")? })
    }

    fn examples() -> Vec<Self> {
        vec![Self::USUAL, Self { exponent: 2.7 }]
    }
}

impl RegisteredDragLaw for WenYuCreeping {
    const MEANING: &'static str = "Wen and Yu for Re << 1";
    const KEYS: &'static [Key] = &[VOIDAGE_EXPONENT];

    fn from_keys(values: &dyn KeyValues) -> Option<Self> {
        Some(Self { exponent: values.number("voidage_exponent")? })
    }

    fn examples() -> Vec<Self> {
        vec![Self::USUAL]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponent_of_liu_is_that_of_beta() {
        // beta d^2 / (18 mu phi) = eps F, with eps^-2.7 and the slip |u - v| = Re mu / (eps rho d).
        let (phi, eps, reynolds) = (0.4, 0.6_f64, 2.0);
        let coefficient = 24.0 / reynolds * (1.0 + 0.15 * libm::pow(reynolds, 0.687));
        // (3/4) C_D rho |u - v| phi / d eps^-2.7 over 18 mu phi / d^2.
        let printed = 0.75 * coefficient * (reynolds / eps) * libm::pow(eps, -2.7) / 18.0;
        let found = WenYu { exponent: 2.7 }.scaled_drag(phi, reynolds);
        assert!((found / printed - 1.0).abs() < 1.0e-13, "{found} {printed}");
        assert!((WenYu::USUAL.scaled_drag(phi, reynolds) / printed - 1.0).abs() > 0.4); // a control
    }

    #[test]
    fn a_single_sphere_in_fast_flow_has_a_constant_coefficient() {
        assert_eq!(WenYu::USUAL.scaled_drag(0.0, 2400.0), 44.0);
        assert_eq!(schiller_naumann(2400.0), 44.0);
    }
}
