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
