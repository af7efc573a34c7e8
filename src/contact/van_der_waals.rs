//! Van der Waals attraction between spheres, and between a sphere and a wall.
//!
//! References:
//! * H. C. Hamaker, "The London-van der Waals attraction between spherical particles", Physica 4 (1937) 1058-1072,
//!   <https://doi.org/10.1016/S0031-8914(37)80203-7>
//! * S. J. Moon, I. G. Kevrekidis, S. Sundaresan, "Particle simulation of vibrated gas-fluidized beds of cohesive fine
//!   powders", Ind. Eng. Chem. Res. 45 (2006) 6966-6977, eq. (4)

use crate::numbers::Schedule;

/// Expression of the force at a separation s between surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CohesionExpression {
    /// A r / (12 s^2) with r = 2 r_i r_j / (r_i + r_j): the limit s << r.
    NearContact,
    /// Hamaker's expression for two spheres at any separation.
    Full,
}

/// Van der Waals attraction. Below the separation `cut_off`, contact included, the force is that at `cut_off`; beyond
/// the separation `range` there is none.
///
/// ```math
/// F = \frac{A\, \bar{r}}{12\, s^2} \quad \text{between particles}, \qquad F = \frac{A_w\, r}{6\, s^2} \quad \text{on a wall}
/// ```
///
/// near contact, with the harmonic mean of the radii 2 r_1 r_2 / (r_1 + r_2); walls have their own constant A_w.
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

/// The attraction at one instant, with the values that the schedules have then.
///
/// ```
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

    /// Largest force at any time on a particle of this radius, by an equal particle or a wall.
    pub fn largest_force(&self, radius: f64) -> f64 {
        let per_area = radius / (self.cut_off * self.cut_off);
        let particles = self.hamaker_constant.largest() / 12.0;
        let walls = self.wall_hamaker_constant.largest() / 6.0;
        particles.max(walls) * per_area
    }
}

/// An attraction between two spheres whose surfaces are `separation` apart (negative: overlap).
pub(crate) trait Attraction: Copy {
    /// Separation below which the attraction no longer grows.
    fn cut_off(&self) -> f64;

    fn between(&self, radius_1: f64, radius_2: f64, separation: f64) -> f64;
}

/// A r / (12 s^2), r = 2 r_1 r_2 / (r_1 + r_2).
#[derive(Clone, Copy)]
pub(crate) struct NearContact(pub(crate) VanDerWaalsNow);

/// Hamaker's expression.
#[derive(Clone, Copy)]
pub(crate) struct Full(pub(crate) VanDerWaalsNow);

impl Attraction for NearContact {
    #[inline(always)]
    fn cut_off(&self) -> f64 {
        self.0.cut_off
    }

    #[inline(always)]
    fn between(&self, radius_1: f64, radius_2: f64, separation: f64) -> f64 {
        let s = if separation > self.0.cut_off { separation } else { self.0.cut_off };
        let force =
            self.0.hamaker * (radius_1 * radius_2) / (6.0 * (radius_1 + radius_2) * (s * s));
        if separation > self.0.range { 0.0 } else { force }
    }
}

impl Attraction for Full {
    #[inline(always)]
    fn cut_off(&self) -> f64 {
        self.0.cut_off
    }

    #[inline(always)]
    fn between(&self, radius_1: f64, radius_2: f64, separation: f64) -> f64 {
        let s = if separation > self.0.cut_off { separation } else { self.0.cut_off };
        let force = self.0.hamaker * hamaker_full(radius_1, radius_2, s);
        if separation > self.0.range { 0.0 } else { force }
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
        self.wall_hamaker * radius / (6.0 * s * s)
    }

    /// Separation beyond which there is no force.
    pub fn range(&self) -> f64 {
        self.range
    }
}

/// Force over Hamaker constant (Moon 2006 eq. (4)):
///
/// ```math
/// \frac{2 r_1 r_2 (s + r_1 + r_2)}{3 p^2} \left[ \frac{p}{p + 4 r_1 r_2} - 1 \right]^2, \qquad p = s (s + 2 r_1 + 2 r_2)
/// ```
#[inline(always)]
fn hamaker_full(radius_1: f64, radius_2: f64, s: f64) -> f64 {
    let product = radius_1 * radius_2;
    let near = s * (s + 2.0 * (radius_1 + radius_2));
    let far = near + 4.0 * product; // (s + r_1 + r_2)^2 - (r_1 - r_2)^2
    let bracket = 4.0 * product / (far * near);
    2.0 / 3.0 * product * (s + radius_1 + radius_2) * bracket * bracket
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hamaker's energy over A of two spheres: -1/6 [2 r1 r2 / p + 2 r1 r2 / q + ln(p / q)].
    fn energy(r1: f64, r2: f64, s: f64) -> f64 {
        let p = s * (s + 2.0 * (r1 + r2));
        let q = p + 4.0 * r1 * r2;
        -(2.0 * r1 * r2 / p + 2.0 * r1 * r2 / q + (p / q).ln()) / 6.0
    }

    #[test]
    fn full_force_is_the_slope_of_hamakers_energy() {
        for (r1, r2, s) in [(0.5, 0.5, 0.1), (0.3, 1.2, 0.05), (1.0, 0.2, 2.0)] {
            let h = 1.0e-4 * s;
            let slope = (energy(r1, r2, s + h) - energy(r1, r2, s - h)) / (2.0 * h);
            // Central differences: relative error of order (h/s)^2 times a few.
            assert!((hamaker_full(r1, r2, s) / slope - 1.0).abs() < 1.0e-6);
            // Negative control: another radius gives another force.
            assert!((hamaker_full(1.1 * r1, r2, s) / slope - 1.0).abs() > 1.0e-3);
        }
    }

    #[test]
    fn full_force_tends_to_the_near_contact_limit() {
        let (r1, r2) = (0.3, 1.2);
        let s = 1.0e-6;
        let near = 2.0 * r1 * r2 / (r1 + r2) / (12.0 * s * s);
        // The next term of the expansion in s/r is of order s/r = 1e-5.
        assert!((hamaker_full(r1, r2, s) / near - 1.0).abs() < 1.0e-5);
    }
}
