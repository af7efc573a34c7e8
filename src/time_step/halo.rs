//! What ranks tell each other about ghosts in a step: velocities of the originals come, forces on copies go back.

use super::meanwhile::with_other_work;
use crate::parallel::{Communicator, ParticleHalo};
use crate::particles::DriftStep;
use crate::state::{State, Workspace};
use crate::timers::Phase;

/// Images become like their originals, and the velocities of other ranks' particles are sent; meanwhile other work is done,
/// for which these particles are not yet where they should be. Collective.
pub(super) fn while_ghosts_travel<T>(
    state: &mut State,
    work: &mut Workspace,
    ranks: &dyn Communicator,
    meanwhile: impl FnOnce(&mut State, &mut Workspace) -> T,
) -> T {
    on_halo(work, |halo| halo.begin(&mut state.particles));
    exchange_during(ParticleHalo::exchange, state, work, ranks, meanwhile)
}

/// Moves the ghosts of other ranks' particles by the velocities that have come.
pub(super) fn move_ghosts(state: &mut State, work: &mut Workspace, step: DriftStep) {
    on_halo(work, |halo| halo.finish(&mut state.particles, step));
}

/// Takes the forces on particles of other ranks to their owners, and does other work until those on this rank's particles
/// have come. Collective.
pub(super) fn while_forces_return(
    state: &mut State,
    work: &mut Workspace,
    ranks: &dyn Communicator,
    meanwhile: impl FnOnce(&mut State, &mut Workspace),
) {
    on_halo(work, |halo| halo.begin_return(&mut state.particles));
    exchange_during(ParticleHalo::exchange_return, state, work, ranks, meanwhile);
    on_halo(work, |halo| halo.finish_return(&mut state.particles));
}

/// Brings the velocities of ghosts up to date, between two steps. Collective.
pub fn refresh_ghosts(state: &mut State, work: &mut Workspace, ranks: &dyn Communicator) {
    // With the copies, which belong to no step and are no load.
    work.timers.time(Phase::ExchangeGhosts, || work.halo.refresh(&mut state.particles, ranks));
}

/// Does what needs no other rank.
fn on_halo(work: &mut Workspace, of_halo: impl FnOnce(&mut ParticleHalo)) {
    work.time(Phase::CopyGhosts, |work| of_halo(&mut work.halo));
}

/// An exchange of the halo: it does other work until all has come.
type Exchange = fn(&mut ParticleHalo, &dyn Communicator, &mut dyn FnMut());

/// Does other work during an exchange; the rest of the time is that of the messages. Collective.
fn exchange_during<T>(
    exchange: Exchange,
    state: &mut State,
    work: &mut Workspace,
    ranks: &dyn Communicator,
    meanwhile: impl FnOnce(&mut State, &mut Workspace) -> T,
) -> T {
    let mut halo = std::mem::take(&mut work.halo);
    let (result, took) = with_other_work(
        |other_work| exchange(&mut halo, ranks, other_work),
        || meanwhile(state, work),
    );
    work.halo = halo;
    work.timers.add(Phase::ExchangeGhosts, took);
    result
}
