//! Ghosts in a step: their velocities come from the owners of the originals, and forces on copies are sent back to
//! these.

use super::decision::Displacement;
use crate::parallel::{Communicator, Exchange, Pending};
use crate::state::{State, Workspace};
use crate::timers::Phase;

/// Updates periodic images from their originals, and begins to send the velocities of particles of which other ranks
/// have copies. Collective.
///
/// After: copies must not be read until [`receive_ghosts`].
pub(super) fn send_ghosts<'r>(
    state: &mut State,
    work: &mut Workspace,
    ranks: &'r dyn Communicator,
) -> Pending<'r, Exchange> {
    work.time(Phase::CopyGhosts, |work| work.halo.pack_velocities(&mut state.particles));
    work.time(Phase::ExchangeGhosts, |work| work.halo.send_velocities(ranks))
}

/// Waits for the velocities of the copies, and moves these exactly as their owners moved the originals, bit for bit.
pub(super) fn receive_ghosts(
    ghosts: Pending<'_, Exchange>,
    moved: Displacement,
    state: &mut State,
    work: &mut Workspace,
) {
    work.time(Phase::ExchangeGhosts, |work| work.halo.receive_velocities(ghosts));
    work.time(Phase::CopyGhosts, |work| work.halo.drift_copies(&mut state.particles, moved.step));
}

/// Begins to send the forces on copies to the owners of the originals. Collective.
pub(super) fn return_forces<'r>(
    state: &mut State,
    work: &mut Workspace,
    ranks: &'r dyn Communicator,
) -> Pending<'r, Exchange> {
    work.time(Phase::CopyGhosts, |work| work.halo.pack_forces(&mut state.particles));
    work.time(Phase::ExchangeGhosts, |work| work.halo.return_forces(ranks))
}

/// Waits for the forces of other ranks' pairs on particles of this rank, and adds them.
pub(super) fn receive_forces(
    forces: Pending<'_, Exchange>,
    state: &mut State,
    work: &mut Workspace,
) {
    work.time(Phase::ExchangeGhosts, |work| work.halo.receive_forces(forces));
    work.time(Phase::CopyGhosts, |work| work.halo.unpack_forces(&mut state.particles));
}

/// Updates the velocities of ghosts between two steps. Collective.
pub fn refresh_ghosts(state: &mut State, work: &mut Workspace, ranks: &dyn Communicator) {
    // This includes the copies; it belongs to no step, and does not count as load.
    work.timers.time(Phase::ExchangeGhosts, || work.halo.refresh(&mut state.particles, ranks));
}
