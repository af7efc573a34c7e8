//! Drag by Di Felice.
//!
//! References:
//! * R. Di Felice, "The voidage function for fluid-particle interaction systems", Int. J. Multiphase Flow 20 (1994)
//!   153-159, <https://doi.org/10.1016/0301-9322(94)90011-6>
//! * J. M. Dallavalle, "Micromeritics: the technology of fine particles", 2nd ed., Pitman, New York (1948)
//! * L. Schiller, A. Naumann, "Über die grundlegenden Berechnungen bei der Schwerkraftaufbereitung", Z. Ver. Dtsch. Ing.
//!   77 (1933) 318-320

use super::law::DENSITY;
use super::wen_yu::schiller_naumann;
use super::{DragCorrelation, RegisteredDragLaw};
use crate::numbers::power;
use crate::schema::{Key, KeyValues, Word};

const SINGLE_SPHERE: Key =
    Key::word("single_sphere", SPHERES, "Drag coefficient of a single sphere");
const SPHERES: &[Word] =
    &[Word::new("dallavalle", "4 % below Stokes at small Re"), Word::new("schiller_naumann", "")];

/// Di Felice (1994), between a single sphere and a packed bed.
///
/// ```math
/// F = \frac{C_D\, Re}{24}\, \varepsilon^{-\chi}, \qquad \chi = 3.7 - 0.65 \exp \left[ -\tfrac{1}{2} (1.5 - \log_{10} Re)^2 \right]
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiFelice {
    /// C_D, for which programs use different expressions.
    pub single_sphere: SingleSphere,
}

/// Drag coefficient C_D of a single sphere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SingleSphere {
    /// (0.63 + 4.8 Re^-1/2)^2, Dallavalle (1948), as used by Di Felice; at small Re 0.96 of Stokes' drag.
    Dallavalle,
    /// 24 / Re (1 + 0.15 Re^0.687), 0.44 above Re = 1000, Schiller & Naumann (1935).
    SchillerNaumann,
}

impl DragCorrelation for DiFelice {
    #[inline(always)]
    fn scaled_drag(&self, solids_fraction: f64, reynolds: f64) -> f64 {
        let sphere = match self.single_sphere {
            SingleSphere::Dallavalle => {
                let root = 0.63 * reynolds.sqrt() + 4.8;
                root * root / 24.0
            }
            SingleSphere::SchillerNaumann => schiller_naumann(reynolds),
        };
        let distance = 1.5 - libm::log10(reynolds); // infinite for a sphere at rest: chi = 3.7
        let chi = 3.7 - 0.65 * libm::exp(-0.5 * distance * distance);
        sphere * power(1.0 - solids_fraction, 1.0 - chi)
    }
}

impl RegisteredDragLaw for DiFelice {
    const MEANING: &'static str = "Di Felice";
    const KEYS: &'static [Key] = &[SINGLE_SPHERE, DENSITY];

    fn from_keys(values: &dyn KeyValues) -> Option<Self> {
        let single_sphere = match values.word("single_sphere")? {
            "schiller_naumann" => SingleSphere::SchillerNaumann,
            _ => SingleSphere::Dallavalle,
        };
        Some(Self { single_sphere })
    }

    fn examples() -> Vec<Self> {
        [SingleSphere::Dallavalle, SingleSphere::SchillerNaumann]
            .map(|single_sphere| Self { single_sphere })
            .to_vec()
    }
}
