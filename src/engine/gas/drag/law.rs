//! The interface of a drag law: its input, its result, and its properties.

use crate::schema::{Allowed, Key, KeyValues};

/// Ratio of the drag in a suspension to the Stokes drag of a single sphere: F = F_d / (3 pi mu d eps |u_g - v|).
///
/// Here eps = 1 - phi and Re = eps rho_g d |u_g - v| / mu. F_d is the drag without the force of the mean pressure
/// gradient (model A). The momentum transfer per volume is beta = 18 mu eps phi F / d^2, and the force per particle
/// (V / phi) beta (u_g - v) = 3 pi mu d eps F (u_g - v).
pub trait DragCorrelation {
    /// eps F at a solids fraction in [0, 1) and a Reynolds number >= 0.
    fn scaled_drag(&self, solids_fraction: f64, reynolds: f64) -> f64;

    /// The drags of many particles at once, in vector instructions.
    #[inline(always)]
    fn scaled_drags<const N: usize>(
        &self,
        solids_fraction: &[f64; N],
        reynolds: &[f64; N],
    ) -> [f64; N]
    where
        Self: Sized,
    {
        let mut scaled = [0.0; N];
        for lane in 0..N {
            scaled[lane] = self.scaled_drag(solids_fraction[lane], reynolds[lane]);
        }
        scaled
    }

    /// Whether the drag depends on the Reynolds number. If not, gas forces are linear in the velocities, and the law is
    /// evaluated with a Reynolds number of zero.
    fn depends_on_reynolds(&self) -> bool {
        true
    }
}

/// `density`, a key of every law that depends on the Reynolds number.
pub(super) const DENSITY: Key =
    Key::number("density", Allowed::POSITIVE, "Density of the gas").unit("mass/volume");

/// A law of the registry. The tests of finite, monotone drag and of equal values one by one and many at once run over
/// its examples.
pub trait RegisteredDragLaw: DragCorrelation + Sized {
    /// Meaning of the law, for the manual.
    const MEANING: &'static str;

    /// Its keys in the case file.
    const KEYS: &'static [Key];

    /// The law with these values; `None` if one is missing or wrong.
    fn from_keys(values: &dyn KeyValues) -> Option<Self>;

    /// Example laws: at least one, and one for each choice that the law offers.
    fn examples() -> Vec<Self>;
}
