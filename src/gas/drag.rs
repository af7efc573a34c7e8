//! Drag laws: pure functions of solids fraction and Reynolds number.

use crate::numbers::power;

/// Drag of a suspension over the Stokes drag of a single sphere:
/// F = F_d / (3 pi mu d eps |u_g - v|), eps = 1 - phi, Re = eps rho_g d |u_g - v| / mu.
///
/// The momentum transfer per volume is beta = 18 mu eps phi F / d^2, and the force per particle
/// (V / phi) beta (u_g - v) = 3 pi mu d eps F (u_g - v).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DragLaw {
    /// Wen & Yu with Rowe's C_D (Moon 2006 eqs (13)-(15)): F = (C_D Re / 24) eps^-3.65, where
    /// C_D Re / 24 = 1 + 0.15 Re^0.687 below Re = 1000 and 0.44 Re / 24 above.
    WenYu,
    /// The limit Re << 1 (Moon 2006 eq. (16)): F = eps^-3.65, so that beta = 18 (mu / d^2) phi eps^-2.65.
    WenYuCreeping,
}

impl DragLaw {
    /// eps F at a solids fraction in [0, 1) and a Reynolds number >= 0.
    ///
    /// ```
    /// use talcum::gas::DragLaw;
    /// let eps = 0.9_f64;
    /// let f = DragLaw::WenYu.scaled_drag(0.1, 100.0) / eps;
    /// assert!((f - 6.68220).abs() < 5e-6); // tabulated value
    /// ```
    #[inline(always)]
    pub fn scaled_drag(self, solids_fraction: f64, reynolds: f64) -> f64 {
        let crowding = power(1.0 - solids_fraction, -2.65);
        match self {
            Self::WenYuCreeping => crowding,
            Self::WenYu if reynolds < 1000.0 => crowding * (1.0 + 0.15 * power(reynolds, 0.687)),
            Self::WenYu => crowding * 0.44 * reynolds / 24.0,
        }
    }

    /// Whether the drag depends on the Reynolds number: if not, gas forces are linear in the velocities.
    pub fn depends_on_reynolds(self) -> bool {
        self == Self::WenYu
    }
}
