//! Energy of the attraction.

use super::{CohesionExpression, VanDerWaalsNow};

impl VanDerWaalsNow {
    /// Energy of two spheres whose surfaces are `separation` apart: minus the work that takes them out of range.
    pub fn energy_of_particles(&self, radius_1: f64, radius_2: f64, separation: f64) -> f64 {
        let plateau = self.between_particles(radius_1, radius_2, 0.0);
        let radius = 2.0 * (radius_1 * radius_2) / (radius_1 + radius_2);
        let tail = |s: f64| match self.expression {
            CohesionExpression::Full => {
                let energy = |s: f64| hamaker_energy(radius_1, radius_2, s);
                self.hamaker * (energy(self.range) - energy(s))
            }
            _ => self.hamaker * radius / 12.0 * self.tail(radius, s),
        };
        self.energy(plateau, tail, separation)
    }

    /// Energy of a sphere and a wall.
    pub fn energy_at_wall(&self, radius: f64, separation: f64) -> f64 {
        let plateau = self.to_wall(radius, 0.0);
        let tail = |s: f64| self.wall_hamaker * radius / 6.0 * self.tail(radius, s);
        self.energy(plateau, tail, separation)
    }

    /// Energy for a force that is `plateau` up to the cut-off, and whose work from a larger separation outwards is
    /// `tail`.
    fn energy(&self, plateau: f64, tail: impl Fn(f64) -> f64, separation: f64) -> f64 {
        if separation > self.range {
            return 0.0;
        }
        -(plateau * (self.cut_off - separation).max(0.0) + tail(separation.max(self.cut_off)))
    }

    /// Integral of the roughness factor over s^2, from a separation to the range.
    fn tail(&self, radius: f64, from: f64) -> f64 {
        let inverse = |shift: f64| 1.0 / (from + shift) - 1.0 / (self.range + shift);
        match self.expression {
            CohesionExpression::Rough { asperity_radius: a } => {
                a / (a + radius) * inverse(0.0) + inverse(a)
            }
            _ => inverse(0.0),
        }
    }
}

/// Hamaker's energy of two spheres, divided by A: -1/6 [2 r1 r2 / p + 2 r1 r2 / q + ln(p / q)].
pub(super) fn hamaker_energy(r1: f64, r2: f64, s: f64) -> f64 {
    let p = s * (s + 2.0 * (r1 + r2));
    let q = p + 4.0 * r1 * r2;
    -(2.0 * r1 * r2 / p + 2.0 * r1 * r2 / q + libm::log(p / q)) / 6.0
}
