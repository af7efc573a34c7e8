//! One rank's share of the box.

use super::{Bounds, Decomposition};
use nalgebra::Vector3;

/// The subdomain of one rank: the box, how it is divided among the ranks, and which of them this is.
#[derive(Clone, Copy, Debug)]
pub struct Subdomain<'a> {
    /// How the box is divided.
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

    /// Whether a place outside of the subdomain is ahead of it: above it along the last axis along which it is outside. Of two
    /// particles in different subdomains, or in different images of one, each sees the other outside, and one of them sees it
    /// ahead. Beyond a face without a neighbour nothing is outside.
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
