//! Attractions with the same work, for particles that are softer than the real ones.

use super::{VanDerWaals, VanDerWaalsNow};

impl VanDerWaals {
    /// The attraction whose largest force is multiplied by `factor`, at most 1, and whose cut-off is enlarged such that
    /// the work of separating two particles of radius `radius` is kept. The range is kept too, except for a square
    /// force, whose range grows with its cut-off. `None` if no cut-off within the range gives that work.
    ///
    /// Forces at walls are multiplied by the same factor.
    pub fn keeping_work(&self, factor: f64, radius: f64) -> Option<Self> {
        if self.cut_off == self.range {
            let range = self.range / factor;
            let constants = factor * (range * range) / (self.range * self.range);
            return Some(self.with_cut_off(range, range, [constants; 2]));
        }
        let unit = |cut_off: f64| {
            let (hamaker, range, expression) = (1.0, self.range, self.expression);
            VanDerWaalsNow { hamaker, wall_hamaker: 1.0, cut_off, range, expression }
        };
        let force = |cut_off: f64| unit(cut_off).between_particles(radius, radius, 0.0);
        let work = |cut_off: f64| -unit(cut_off).energy_of_particles(radius, radius, 0.0);
        let constant = |cut_off: f64| factor * force(self.cut_off) / force(cut_off);
        let is_too_small = |cut_off: f64| constant(cut_off) * work(cut_off) < work(self.cut_off);
        let (mut low, mut high) = (self.cut_off, self.range);
        if is_too_small(high) {
            return None;
        }
        // The number of halvings exceeds the number of bits.
        for _ in 0..100 {
            let middle = (low * high).sqrt();
            if is_too_small(middle) { low = middle } else { high = middle }
        }
        let at_wall = |cut_off: f64| unit(cut_off).to_wall(radius, 0.0);
        let at_walls = factor * at_wall(self.cut_off) / at_wall(high);
        Some(self.with_cut_off(high, self.range, [constant(high), at_walls]))
    }

    fn with_cut_off(&self, cut_off: f64, range: f64, constants: [f64; 2]) -> Self {
        let [of_particles, at_walls] = constants;
        Self {
            hamaker_constant: self.hamaker_constant.scaled(of_particles),
            wall_hamaker_constant: self.wall_hamaker_constant.scaled(at_walls),
            cut_off,
            range,
            expression: self.expression,
        }
    }
}
