//! Van der Waals attraction between spheres, and between a sphere and a wall.
//!
//! References:
//! * H. C. Hamaker, "The London-van der Waals attraction between spherical particles", Physica 4 (1937) 1058-1072,
//!   <https://doi.org/10.1016/S0031-8914(37)80203-7>
//! * S. J. Moon, I. G. Kevrekidis, S. Sundaresan, "Particle simulation of vibrated gas-fluidized beds of cohesive fine
//!   powders", Ind. Eng. Chem. Res. 45 (2006) 6966-6977, eq. (4)
//! * H. Rumpf, "Particle technology", Chapman and Hall, London (1990); Y. I. Rabinovich, J. J. Adler, A. Ata, R. K. Singh,
//!   B. M. Moudgil, "Adhesion between nanoscale rough surfaces: I. Role of asperity geometry", J. Colloid Interface Sci.
//!   232 (2000) 10-16, <https://doi.org/10.1006/jcis.2000.7167>: asperities
//! * P. Liu, C. Q. LaMarche, K. M. Kellogg, C. M. Hrenya, "A square-force cohesion model and its extraction from bulk
//!   measurements", AIChE J. 64 (2018) 2329-2339, <https://doi.org/10.1002/aic.16089>

mod coarse_grained;
mod energy;
mod expression;
mod softened;
#[cfg(test)]
mod tests;

pub use expression::CohesionExpression;
pub(crate) use expression::{Attraction, Full, NearContact, Rough};

use crate::numbers::Schedule;

/// Van der Waals attraction. Below the separation `cut_off`, contact included, the force is that at `cut_off`; beyond
/// the separation `range` it is zero. If the two are equal, it is a square force: constant up to its range.
///
/// ```math
/// F = \frac{A\, \bar{r}}{12\, s^2} \quad \text{between particles}, \qquad F = \frac{A_w\, r}{6\, s^2} \quad \text{on a wall}
/// ```
///
/// near contact, with the harmonic mean of the radii 2 r_1 r_2 / (r_1 + r_2); walls have their own constant A_w.
/// Asperities multiply the force by a factor ([`CohesionExpression::Rough`]).
#[derive(Clone, Debug, PartialEq)]
pub struct VanDerWaals {
    /// Hamaker constant A of two particles, energy.
    pub hamaker_constant: Schedule,
    /// Hamaker constant of particle and wall, energy.
    pub wall_hamaker_constant: Schedule,
    /// Separation delta below which the force no longer grows.
    pub cut_off: f64,
    /// Separation beyond which there is no force.
    pub range: f64,
    /// Expression of the force.
    pub expression: CohesionExpression,
}

/// The attraction at one instant, with the values of the schedules at that time.
///
/// ```
/// # use talcum_engine as talcum;
/// use talcum::contact::{CohesionExpression, VanDerWaals};
/// use talcum::numbers::Schedule;
/// let cohesion = VanDerWaals {
///     hamaker_constant: Schedule::Constant(12.0e-6),
///     wall_hamaker_constant: Schedule::Constant(0.0),
///     cut_off: 1.0e-3,
///     range: 0.01,
///     expression: CohesionExpression::NearContact,
/// };
/// let now = cohesion.at(0.0);
/// assert!((now.between_particles(0.5, 0.5, -1.0e-4) - 0.5).abs() < 1e-12); // A r / (12 delta^2)
/// assert!((now.between_particles(0.5, 0.5, 2.0e-3) - 0.125).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VanDerWaalsNow {
    hamaker: f64,
    wall_hamaker: f64,
    cut_off: f64,
    range: f64,
    expression: CohesionExpression,
}

impl VanDerWaals {
    /// Returns the attraction at a time.
    pub fn at(&self, time: f64) -> VanDerWaalsNow {
        VanDerWaalsNow {
            hamaker: self.hamaker_constant.at(time),
            wall_hamaker: self.wall_hamaker_constant.at(time),
            cut_off: self.cut_off,
            range: self.range,
            expression: self.expression,
        }
    }

    /// A square force (Liu et al. 2018): constant up to a separation `range`, zero beyond. `force` is the force of two
    /// equal particles of radius `radius`, `wall_force` that of such a particle and a wall; both grow with r as the van
    /// der Waals forces do.
    pub fn square(force: &Schedule, wall_force: &Schedule, radius: f64, range: f64) -> Self {
        let per_force = range * range / radius;
        Self {
            hamaker_constant: force.scaled(12.0 * per_force),
            wall_hamaker_constant: wall_force.scaled(6.0 * per_force),
            cut_off: range,
            range,
            expression: CohesionExpression::NearContact,
        }
    }

    /// The attraction with the largest values that the schedules ever have.
    pub fn strongest(&self) -> VanDerWaalsNow {
        VanDerWaalsNow {
            hamaker: self.hamaker_constant.largest(),
            wall_hamaker: self.wall_hamaker_constant.largest(),
            ..self.at(0.0)
        }
    }

    /// Largest force at any time on a particle of this radius, exerted by an equal particle or a wall.
    pub fn largest_force(&self, radius: f64) -> f64 {
        let roughness = self.expression.roughness_factor(radius, self.cut_off);
        let per_area = roughness * radius / (self.cut_off * self.cut_off);
        let particles = self.hamaker_constant.largest() / 12.0;
        let walls = self.wall_hamaker_constant.largest() / 6.0;
        particles.max(walls) * per_area
    }
}

impl VanDerWaalsNow {
    /// Magnitude of the attraction between two spheres whose surfaces are `separation` apart (negative: overlap).
    pub fn between_particles(&self, radius_1: f64, radius_2: f64, separation: f64) -> f64 {
        match self.expression {
            CohesionExpression::NearContact => {
                NearContact(*self).between(radius_1, radius_2, separation)
            }
            CohesionExpression::Full => Full(*self).between(radius_1, radius_2, separation),
            CohesionExpression::Rough { asperity_radius } => {
                let rough = Rough { smooth: NearContact(*self), asperity_radius };
                rough.between(radius_1, radius_2, separation)
            }
        }
    }

    /// Expression of the force.
    pub fn expression(&self) -> CohesionExpression {
        self.expression
    }

    /// Magnitude of the attraction between a sphere and a wall.
    pub fn to_wall(&self, radius: f64, separation: f64) -> f64 {
        if separation > self.range {
            return 0.0;
        }
        let s = separation.max(self.cut_off);
        let smooth = self.wall_hamaker * radius / (6.0 * s * s);
        smooth * self.expression.roughness_factor(radius, s)
    }

    /// Separation beyond which there is no force.
    pub fn range(&self) -> f64 {
        self.range
    }
}
