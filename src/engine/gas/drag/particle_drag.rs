//! Drag on one particle by any of the laws.

use super::{DragCorrelation, DragLaw};
use crate::coupling::DragShare;
use std::f64::consts::PI;

/// Drag of a gas on single particles in a suspension.
#[derive(Clone, Debug, PartialEq)]
pub struct ParticleDrag {
    /// Drag law.
    pub law: DragLaw,
    /// xi, ratio of the drag to that of the law (Liu 2016: 0.2, for clustered particles).
    pub factor: f64,
    /// Rule by which particles of different sizes share the drag.
    pub share: DragShare,
    /// Gas viscosity.
    pub viscosity: f64,
    /// Gas density.
    pub density: f64,
    /// Size ratio l of parcels that represent l^3 particles each, d = D / l; 1 for particles. The drag on a parcel of
    /// diameter D is that on all of its particles.
    pub parcel_size: f64,
}

impl ParticleDrag {
    /// xi (V / phi) beta = xi 3 pi mu d eps F, the drag on one particle of diameter d per velocity difference (on a
    /// parcel of diameter D: l^3 times that for d = D / l), at the solids fraction phi and with U_s - u_s given as
    /// `slip`.
    ///
    /// Re = (1 - phi) rho_g d |u_g - u_s| / mu = rho_g d |U_s - u_s| / mu.
    #[inline(always)]
    pub fn per_velocity(&self, diameter: f64, solids_fraction: f64, slip: f64) -> f64 {
        let reynolds =
            if self.law.depends_on_reynolds() { self.reynolds(diameter, slip) } else { 0.0 };
        self.stokes(diameter) * self.law.scaled_drag(solids_fraction, reynolds)
    }

    /// The drag on one particle per velocity difference in a mixture with the Sauter mean diameter D: that of a bed of
    /// this diameter, shared by surface, xi 3 pi mu D eps F(phi, Re of D) (d / D)^2.
    ///
    /// This is the drag d y F, y = d / D, of Beetstra, van der Hoef & Kuipers, AIChE J. 53 (2007) 489,
    /// doi:10.1002/aic.11065, with its erratum, AIChE J. 53 (2007) 3020. These authors give the force that includes the
    /// mean pressure gradient, which is eps y + phi y^2 times that of equal spheres.
    #[inline(always)]
    pub fn per_velocity_in_mixture(
        &self,
        [diameter, mean]: [f64; 2],
        solids_fraction: f64,
        slip: f64,
    ) -> f64 {
        let ratio = diameter / mean;
        self.per_velocity(mean, solids_fraction, slip) * (ratio * ratio)
    }

    /// The drags of many particles at once, in vector instructions.
    #[inline(always)]
    pub fn per_velocities<const N: usize>(
        &self,
        diameter: &[f64; N],
        solids_fraction: &[f64; N],
        slip: &[f64; N],
    ) -> [f64; N] {
        let mut reynolds = [0.0; N];
        if self.law.depends_on_reynolds() {
            for lane in 0..N {
                reynolds[lane] = self.reynolds(diameter[lane], slip[lane]);
            }
        }
        let mut drag = self.law.scaled_drags(solids_fraction, &reynolds);
        for lane in 0..N {
            drag[lane] *= self.stokes(diameter[lane]);
        }
        drag
    }

    #[inline(always)]
    fn reynolds(&self, diameter: f64, slip: f64) -> f64 {
        self.density * diameter * slip.abs() / (self.viscosity * self.parcel_size)
    }

    /// xi 3 pi mu d; for a parcel l^3 xi 3 pi mu D / l.
    #[inline(always)]
    fn stokes(&self, diameter: f64) -> f64 {
        let factor = self.factor * (self.parcel_size * self.parcel_size);
        factor * (3.0 * PI * self.viscosity * diameter)
    }
}
