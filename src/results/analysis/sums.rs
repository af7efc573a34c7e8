//! Sums over all particles, independent of the number of ranks.

use talcum_engine::parallel::Communicator;
use talcum_engine::particle_sets::exact_sums::totals;
use talcum_engine::particles::Particles;

/// Exact sums over the owned particles of all ranks. Collective.
pub(super) fn sums<const N: usize>(
    particles: &Particles,
    ranks: &dyn Communicator,
    of: impl Fn(usize) -> [f64; N],
) -> [f64; N] {
    totals((0..particles.owned_count()).map(of), ranks)
}
