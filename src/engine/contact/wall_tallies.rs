//! Forces of particles on walls, as counts of the force quantum: total forces, and forces by classes of size.

/// Forces on walls at the last evaluation, as counts of the force quantum: sums over particles and ranks are exact.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WallTallies {
    /// Diameters of the size classes, ascending; empty if there are no classes.
    diameters: Vec<f64>,
    /// Radii between those of neighbouring classes.
    limits: Vec<f64>,
    /// The tally of class c on wall w, at w times the number of classes plus c.
    counts: Vec<[i64; 3]>,
}

impl WallTallies {
    /// Sets size classes for particles of these diameters; fewer than two give no classes.
    pub fn set_classes(&mut self, mut diameters: Vec<f64>) {
        let walls = self.walls();
        diameters.sort_by(f64::total_cmp);
        diameters.dedup();
        self.limits = diameters.windows(2).map(|pair| 0.25 * (pair[0] + pair[1])).collect();
        self.diameters = if self.limits.is_empty() { Vec::new() } else { diameters };
        self.reset(walls);
    }

    /// Sets the forces on this number of walls to zero.
    pub(crate) fn reset(&mut self, walls: usize) {
        self.counts.clear();
        self.counts.resize(walls * self.classes(), [0; 3]);
    }

    pub(super) fn clear(&mut self) {
        self.counts.fill([0; 3]);
    }

    /// Adds a force of a particle on a wall.
    #[inline(always)]
    pub(super) fn add(&mut self, wall: usize, radius: f64, force: [i64; 3]) {
        let class = self.limits.partition_point(|&limit| limit < radius);
        let place = wall * self.classes() + class;
        let sum = &mut self.counts[place];
        (0..3).for_each(|axis| sum[axis] += force[axis]);
    }

    /// Diameters of the size classes, ascending; empty if there are no classes.
    pub fn diameters(&self) -> &[f64] {
        &self.diameters
    }

    /// Number of walls.
    pub fn walls(&self) -> usize {
        self.counts.len() / self.classes()
    }

    /// Force on one wall by the particles of each class, in quanta.
    pub fn by_class(&self, wall: usize) -> &[[i64; 3]] {
        &self.counts[wall * self.classes()..][..self.classes()]
    }

    /// Force on one wall by all particles, in quanta.
    pub fn on_wall(&self, wall: usize) -> [i64; 3] {
        let of_classes = self.by_class(wall);
        [0, 1, 2].map(|axis| of_classes.iter().map(|force| force[axis]).sum())
    }

    fn classes(&self) -> usize {
        1 + self.limits.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_are_summed_by_class_and_in_all() {
        let mut tallies = WallTallies::default();
        tallies.reset(2);
        tallies.add(1, 0.3, [1, 2, 3]);
        assert_eq!((tallies.on_wall(1), tallies.diameters()), ([1, 2, 3], &[][..]));
        tallies.set_classes(vec![1.2, 0.8, 1.0, 0.8]);
        assert_eq!((tallies.walls(), tallies.on_wall(1)), (2, [0; 3]));
        for (radius, force) in [(0.4, 1), (0.5, 10), (0.6, 100), (0.4, 1000)] {
            tallies.add(0, radius, [force, 0, -force]);
        }
        assert_eq!(tallies.by_class(0), [[1001, 0, -1001], [10, 0, -10], [100, 0, -100]]);
        assert_eq!((tallies.on_wall(0), tallies.on_wall(1)), ([1111, 0, -1111], [0; 3]));
    }
}
