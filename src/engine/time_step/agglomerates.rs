//! Agglomerates of the particles, for models in which drag depends on them.

use crate::gas::{AgglomerateBall, AgglomerateDrag};
use crate::parallel::Communicator;
use crate::particle_sets::agglomerates::{Agglomerate, Search};
use crate::particle_sets::{
    Ownership, Pair, Periodicity, Persistence, PersistentContacts, samples, touching_pairs,
};
use crate::particles::{AGGLOMERATE, AgglomerateOfParticle};
use crate::state::{Domain, Models, State};

/// Finds the agglomerates if a search is due before this step of the gas; forgets them where drag does not depend on
/// agglomerates. Collective.
///
/// A search is due at the first step of the gas, and afterwards whenever its step number is a multiple of
/// [`AgglomerateDrag::every`].
pub(super) fn find_if_due(
    state: &mut State,
    domain: &Domain,
    models: &Models,
    ranks: &dyn Communicator,
) {
    let Some(drag) = models.physics.gas.agglomerates() else {
        if state.looked_at.take().is_some() {
            state.particles.columns.at_mut(AGGLOMERATE).reset();
        }
        return;
    };
    let gas_steps = state.clock.step / models.physics.gas.substeps();
    if state.looked_at.is_none() || gas_steps.is_multiple_of(drag.every) {
        find(state, domain, drag, ranks);
    }
}

/// Finds the agglomerate of each particle: the connected sets of pairs that touch now and also touched at the previous
/// search, or that merely touch now if this is the first search. Collective.
fn find(state: &mut State, domain: &Domain, drag: AgglomerateDrag, ranks: &dyn Communicator) {
    let (samples, indices) = samples(&state.particles, &domain.bounds);
    let owned = Ownership::of(samples.iter().map(|particle| particle.id).collect());
    let touching = touching_pairs(&state.contacts, &state.particles, &owned, ranks);
    let kept: Option<Vec<Pair>> = state.looked_at.take().map(|before| {
        PersistentContacts::begin(Persistence::AtBothTimes, &before).look(&touching, &owned, ranks)
    });
    let search = Search {
        particles: &samples,
        bonds: kept.as_ref().unwrap_or(&touching),
        touching: &[],
        periodicity: Periodicity::of(&domain.bounds),
        smallest: drag.smallest,
    };
    let found = search.run(ranks).of_particles(ranks);
    for (index, agglomerate) in indices.into_iter().zip(found) {
        let ball = agglomerate.as_ref().and_then(ball_of);
        let column = state.particles.columns.at_mut(AGGLOMERATE);
        let of_particle = &mut column.hold::<AgglomerateOfParticle>()[index];
        (of_particle.diameter, of_particle.packing) =
            ball.map_or((0.0, 0.0), |ball| (ball.diameter, ball.packing));
    }
    state.looked_at = Some(touching);
}

/// The ball that represents an agglomerate; an agglomerate that winds around a periodic box has no size.
fn ball_of(agglomerate: &Agglomerate) -> Option<AgglomerateBall> {
    let Agglomerate { radius_of_gyration, volume, winds, .. } = *agglomerate;
    let member_radius = agglomerate.member_radius();
    (winds == [0; 3]).then(|| AgglomerateBall::of(radius_of_gyration, member_radius, volume))
}
