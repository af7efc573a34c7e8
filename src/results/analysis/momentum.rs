//! The momentum balance of one step.

use super::sums::sums;
use talcum_engine::parallel::Communicator;
use talcum_engine::particles::Particles;

/// Momentum and total force before a step, for comparison with those after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MomentumProbe {
    momentum: [f64; 3],
    force: [f64; 3],
}

impl MomentumProbe {
    /// The present momentum and total force. Collective.
    pub fn take(particles: &Particles, ranks: &dyn Communicator) -> Self {
        let [px, py, pz, fx, fy, fz] = sums(particles, ranks, |i| {
            let (p, f) =
                (particles.body[i].velocity * particles.body[i].mass, particles.forces[i].force);
            [p.x, p.y, p.z, f.x, f.y, f.z]
        });
        Self { momentum: [px, py, pz], force: [fx, fy, fz] }
    }

    /// (P_after - P_before) / dt - (F_before + F_after) / 2, where F_after is not the sum over particles but the
    /// reported sum for walls, gas and weight: it is zero only if contact forces cancel.
    fn imbalance(&self, after: &Self, external: [f64; 3], dt: f64) -> [f64; 3] {
        std::array::from_fn(|axis| {
            let change = (after.momentum[axis] - self.momentum[axis]) / dt;
            change - 0.5 * (self.force[axis] + external[axis])
        })
    }

    /// The largest component of the imbalance over a step of length `dt`, where `external` is the external force at its
    /// end.
    pub(super) fn largest_imbalance(&self, after: &Self, external: [f64; 3], dt: f64) -> f64 {
        let errors = self.imbalance(after, external, dt);
        errors.iter().fold(0.0, |largest: f64, error| largest.max(error.abs()))
    }

    /// Momentum at the time of the probe.
    pub(super) fn momentum(&self) -> [f64; 3] {
        self.momentum
    }
}
