//! Sums over all ranks that do not depend on how many there are.

use crate::numbers::ExactSum;
use crate::parallel::Communicator;
use crate::particles::Particles;

/// Exact sums over the owned particles of all ranks. Collective.
pub(super) fn sums<const N: usize>(
    particles: &Particles,
    ranks: &dyn Communicator,
    of: impl Fn(usize) -> [f64; N],
) -> [f64; N] {
    let mut local = [(); N].map(|()| ExactSum::default());
    for i in 0..particles.owned_count() {
        for (sum, value) in local.iter_mut().zip(of(i)) {
            sum.add(value);
        }
    }
    totals(&local, ranks)
}

/// Totals of some sums over all ranks. Collective.
fn totals<const N: usize>(local: &[ExactSum; N], ranks: &dyn Communicator) -> [f64; N] {
    let mut integers: Vec<i64> = local.iter().flat_map(ExactSum::to_integers).collect();
    ranks.sum_integers(&mut integers);
    let mut totals = integers.chunks(ExactSum::INTEGERS).map(ExactSum::from_integers);
    [(); N].map(|()| totals.next().map_or(0.0, |sum| sum.value()))
}
