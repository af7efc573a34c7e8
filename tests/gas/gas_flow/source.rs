//! A force in space and time that is expensive to compute: it is computed at some instants, and interpolated by
//! polynomials between them.

use super::driver::Flow;
use std::f64::consts::PI;
use talcum::grid::Field;

/// Instants: an error of (rate x duration / 4)^8 / 8! and less, below 1e-9 of forces that change at rates of some 10.
const INSTANTS: usize = 8;

/// Forces on faces at the instants of Chebyshev.
pub(crate) struct Source {
    instants: [f64; INSTANTS],
    forces: [[Field; 3]; INSTANTS],
}

impl Source {
    /// From the component along an axis at a place and a time from 0 to `end`.
    pub(crate) fn new(flow: &Flow, end: f64, force: impl Fn(usize, [f64; 3], f64) -> f64) -> Self {
        let angle = |i: usize| PI * (i as f64 + 0.5) / INSTANTS as f64;
        let instants = std::array::from_fn(|i| end * 0.5 * (1.0 - angle(i).cos()));
        let field = |axis: usize, t: f64| flow.field(Some(axis), |x| force(axis, x, t));
        let forces = instants.map(|t| [0, 1, 2].map(|axis| field(axis, t)));
        Self { instants, forces }
    }

    /// The force at a time.
    pub(crate) fn at(&self, t: f64) -> [Field; 3] {
        let weight = |own: usize| -> f64 {
            let others = self.instants.iter().enumerate().filter(|&(other, _)| other != own);
            others.map(|(_, instant)| (t - instant) / (self.instants[own] - instant)).product()
        };
        let mut sum = self.forces[0].clone();
        sum.iter_mut().for_each(|field| field.values_mut().fill(0.0));
        for (own, forces) in self.forces.iter().enumerate() {
            let weight = weight(own);
            for (sum, force) in sum.iter_mut().zip(forces) {
                for (sum, force) in sum.values_mut().iter_mut().zip(force.values()) {
                    *sum += weight * force;
                }
            }
        }
        sum
    }
}
