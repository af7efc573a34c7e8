//! Drag by Gidaspow: Ergun in dense, Wen & Yu in dilute suspensions.
//!
//! References:
//! * D. Gidaspow, "Multiphase flow and fluidization: continuum and kinetic theory descriptions", Academic Press, Boston
//!   (1994), ISBN 0-12-282470-9
//! * L. Huilin, D. Gidaspow, "Hydrodynamics of binary fluidization in a riser: CFD simulation using two granular
//!   temperatures", Chem. Eng. Sci. 58 (2003) 3777-3792, <https://doi.org/10.1016/S0009-2509(03)00238-0>

use super::law::DENSITY;
use super::{DragCorrelation, Ergun, RegisteredDragLaw, WenYu};
use crate::schema::{Key, KeyValues, Word};
use std::f64::consts::PI;

const DRAG_SWITCH: Key =
    Key::word("drag_switch", SWITCHES, "From Ergun to Wen and Yu at a solids fraction of 0.2");
const SWITCHES: &[Word] =
    &[Word::new("sharp", "with a jump"), Word::new("smooth", "by an arctangent")];

/// Gidaspow (1994): Ergun where the voidage is below 0.8, Wen & Yu (n = 1.65) above.
///
/// ```math
/// F = w\, F_\text{Wen Yu} + (1 - w)\, F_\text{Ergun}, \qquad
/// w = \begin{cases} 1, & \phi < 0.2 \\ 0 \end{cases} \quad \text{or} \quad
/// w = \tfrac{1}{2} + \tfrac{1}{\pi} \arctan \left[ 150 \cdot 1.75\, (0.2 - \phi) \right]
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gidaspow {
    /// Transition between the two laws.
    pub switch: Switch,
}

/// Transition from Ergun to Wen & Yu.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Switch {
    /// At phi = 0.2, with a jump.
    Sharp,
    /// The fraction atan(150 * 1.75 (0.2 - phi)) / pi + 1/2 of Wen & Yu, and the rest of Ergun (Huilin & Gidaspow
    /// 2003).
    Smooth,
}

/// Solids fraction at the switch.
const SWITCH: f64 = 0.2;

impl DragCorrelation for Gidaspow {
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
        let mut scaled = WenYu::USUAL.scaled_drags(solids_fraction, reynolds);
        let dense = Ergun.scaled_drags(solids_fraction, reynolds);
        match self.switch {
            Switch::Sharp => {
                for lane in 0..N {
                    let is_dense = solids_fraction[lane] > SWITCH;
                    scaled[lane] = if is_dense { dense[lane] } else { scaled[lane] };
                }
            }
            Switch::Smooth => {
                for lane in 0..N {
                    let part =
                        libm::atan(150.0 * 1.75 * (SWITCH - solids_fraction[lane])) / PI + 0.5;
                    scaled[lane] = dense[lane] + part * (scaled[lane] - dense[lane]);
                }
            }
        }
        scaled
    }
}

impl RegisteredDragLaw for Gidaspow {
    const MEANING: &'static str = "Ergun in dense regions, Wen and Yu in dilute ones";
    const KEYS: &'static [Key] = &[DRAG_SWITCH, DENSITY];

    fn from_keys(values: &dyn KeyValues) -> Option<Self> {
        let switch = match values.word("drag_switch")? {
            "smooth" => Switch::Smooth,
            _ => Switch::Sharp,
        };
        Some(Self { switch })
    }

    fn examples() -> Vec<Self> {
        [Switch::Sharp, Switch::Smooth].map(|switch| Self { switch }).to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn far_from_the_switch_both_forms_are_the_two_laws() {
        let [sharp, smooth] = [Switch::Sharp, Switch::Smooth].map(|switch| Gidaspow { switch });
        for reynolds in [0.1, 10.0] {
            assert_eq!(sharp.scaled_drag(0.5, reynolds), Ergun.scaled_drag(0.5, reynolds));
            assert_eq!(sharp.scaled_drag(0.05, reynolds), WenYu::USUAL.scaled_drag(0.05, reynolds));
            // The arctangent is 1 / (150 * 1.75 * 0.3 pi) = 0.4 % of the other law away from its limit.
            let [a, b] = [sharp, smooth].map(|law| law.scaled_drag(0.5, reynolds));
            assert!((a / b - 1.0).abs() < 0.005, "{a} {b}");
        }
    }

    #[test]
    fn only_the_sharp_switch_jumps() {
        let jump = |switch| {
            let law = Gidaspow { switch };
            let [below, above] = [0.2, 0.2 + 1.0e-9].map(|phi| law.scaled_drag(phi, 1.0));
            (above / below - 1.0).abs()
        };
        assert!(jump(Switch::Sharp) > 0.05);
        assert!(jump(Switch::Smooth) < 1.0e-6);
    }
}
