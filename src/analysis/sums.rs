//! Sums over all particles, independent of the number of ranks.

use crate::parallel::Communicator;
use crate::particle_sets::exact_sums::totals;
use crate::particles::Particles;

/// Exact sums over the owned particles of all ranks. Collective.
pub(super) fn sums<const N: usize>(
    particles: &Particles,
    ranks: &dyn Communicator,
    of: impl Fn(usize) -> [f64; N],
) -> [f64; N] {
    totals((0..particles.owned_count()).map(of), ranks)
}
