//! One rank's share of the box.

use super::{Bounds, Decomposition};
use nalgebra::Vector3;

/// The subdomain of one rank, with the box and its decomposition.
#[derive(Clone, Copy, Debug)]
pub struct Subdomain<'a> {
    /// Decomposition of the box.
    pub decomposition: &'a Decomposition,
    /// The whole box.
    pub bounds: &'a Bounds,
    /// The rank that owns this subdomain.
    pub rank: usize,
}

impl Subdomain<'_> {
    /// Lower and upper corner.
    pub fn corners(self) -> [Vector3<f64>; 2] {
        self.decomposition.subdomain_corners(self.rank)
    }

    /// Whether a place outside the subdomain is ahead of it: above it along the last axis along which it is outside.
    /// For two particles in different subdomains, or in different images of one, each is outside the other's subdomain,
    /// and exactly one of them is ahead. Beyond a face without a neighbour nothing is outside.
    pub fn is_ahead(self) -> impl Fn(&Vector3<f64>) -> bool {
        let [mut lower, mut upper] = self.corners();
        for axis in 0..3 {
            let [below, above] = self.neighbours(axis);
            lower[axis] = below.map_or(f64::NEG_INFINITY, |_| lower[axis]);
            upper[axis] = above.map_or(f64::INFINITY, |_| upper[axis]);
        }
        move |place| {
            let side = |&axis: &usize| place[axis] < lower[axis] || place[axis] >= upper[axis];
            [2, 1, 0].iter().find(|axis| side(axis)).is_some_and(|&axis| place[axis] >= upper[axis])
        }
    }

    /// The ranks below and above along an axis; at a periodic face, the one at the opposite face.
    pub fn neighbours(self, axis: usize) -> [Option<usize>; 2] {
        self.decomposition.neighbours(self.rank, axis, self.bounds)
    }
}

impl Decomposition {
    /// The subdomain of a rank.
    pub fn subdomain<'a>(&'a self, bounds: &'a Bounds, rank: usize) -> Subdomain<'a> {
        Subdomain { decomposition: self, bounds, rank }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::{Face, RankGrid};
    use crate::numbers::{random_of, uniform};

    /// Numbers of random pairs in different blocks, the second particle in any image, that are ahead for neither rank,
    /// and for both ranks, by the function `is_ahead` of a rank and a place.
    fn neither_and_both(
        grid: [usize; 3],
        is_ahead: impl Fn(Subdomain<'_>, &Vector3<f64>) -> bool,
    ) -> [usize; 2] {
        let periodic = [Face::Periodic; 2];
        let bounds =
            Bounds::new(Vector3::new(5.0, 6.0, 7.0), [periodic, periodic, [Face::Wall; 2]]);
        let decomposition = Decomposition::even(RankGrid(grid), &bounds);
        let mut random = random_of(3, 0, "ahead");
        let mut number = || uniform(&mut random);
        let mut found = [0; 2];
        for _ in 0..2000 {
            // Some places are slightly beyond a wall.
            let mut place = || Vector3::new(5.0 * number(), 6.0 * number(), 8.0 * number() - 0.5);
            let [one, other] = [place(), place()];
            let shift = Vector3::new(5.0, 6.0, 0.0)
                .map(|length: f64| length * (3.0 * number() - 1.5).round());
            let owners = [one, other].map(|place| decomposition.owner_of(&place));
            if owners[0] == owners[1] && shift == Vector3::zeros() {
                continue;
            }
            let [here, there] = owners.map(|rank| decomposition.subdomain(&bounds, rank));
            let seen = [is_ahead(here, &(other + shift)), is_ahead(there, &(one - shift))];
            found[0] += usize::from(seen == [false; 2]);
            found[1] += usize::from(seen == [true; 2]);
        }
        found
    }

    #[test]
    fn of_two_places_one_is_ahead_of_the_other() {
        for grid in [[1, 1, 1], [2, 1, 1], [1, 1, 2], [3, 2, 1], [2, 2, 2], [1, 4, 3]] {
            assert_eq!(neither_and_both(grid, |here, place| here.is_ahead()(place)), [0, 0]);
        }
        // Control: above along any axis.
        let above = |here: Subdomain<'_>, place: &Vector3<f64>| {
            let upper = here.corners()[1];
            (0..3).any(|axis| place[axis] >= upper[axis])
        };
        assert!(neither_and_both([3, 2, 1], above)[1] > 0);
    }
}
