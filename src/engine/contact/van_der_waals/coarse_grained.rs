//! Attraction of parcels.

use super::{CohesionExpression, VanDerWaals};
use crate::contact::CoarseGraining;

impl VanDerWaals {
    /// The attraction of parcels: at l times the separation it is that of their particles times the factor of forces.
    #[must_use]
    pub fn coarse_grained(&self, parcels: &CoarseGraining) -> Self {
        let constant = parcels.energy();
        Self {
            hamaker_constant: self.hamaker_constant.scaled(constant),
            wall_hamaker_constant: self.wall_hamaker_constant.scaled(constant),
            cut_off: parcels.length() * self.cut_off,
            range: parcels.length() * self.range,
            expression: match self.expression {
                CohesionExpression::Rough { asperity_radius } => CohesionExpression::Rough {
                    asperity_radius: parcels.length() * asperity_radius,
                },
                same => same,
            },
        }
    }
}
