//! The step of the gas, and what a column gas has to know of the particles of all ranks.

use super::agglomerates;
use super::meanwhile::with_other_work;
use crate::gas::{GasStep, NodeSums};
use crate::parallel::Communicator;
use crate::state::{Domain, Models, State, Workspace};
use crate::timers::Phase;

/// Adds up over the ranks what a column gas has to know of the particles, and does other work while these numbers travel.
/// Returns them, unless the gas is another, and what the work returned. Collective.
///
/// Before: particles are where, and as fast as, the gas is to find them.
pub(super) fn while_bed_is_summed<T>(
    state: &mut State,
    work: &mut Workspace,
    ranks: &dyn Communicator,
    meanwhile: impl FnOnce(&mut State, &mut Workspace) -> T,
) -> (Option<NodeSums>, T) {
    let sums = work.timers.time(Phase::Gas, || work.gas.sum_bed(&state.particles));
    let Some(mut sums) = sums else { return (None, meanwhile(state, work)) };
    let (result, took) = with_other_work(
        |other_work| ranks.sum_exact_during(sums.numbers_mut(), other_work),
        || meanwhile(state, work),
    );
    work.timers.add(Phase::Gas, took);
    (Some(sums), result)
}

/// Looks at the agglomerates before a step of the gas if a look is due, while contacts are those of the step before. Collective.
pub(super) fn look_at_agglomerates(
    state: &mut State,
    domain: &Domain,
    models: &Models,
    work: &mut Workspace,
    ranks: &dyn Communicator,
) {
    if models.physics.gas.is_due(state.clock.step) {
        work.timers.time(Phase::Gas, || agglomerates::look_if_due(state, domain, models, ranks));
    }
}

/// A step of the gas from the particles as they are now, with their sums of [`while_bed_is_summed`] if they still hold. Collective.
pub(super) fn advance_gas(
    bed: Option<NodeSums>,
    state: &mut State,
    models: &Models,
    work: &mut Workspace,
    ranks: &dyn Communicator,
) {
    let State { particles, gas, clock, .. } = state;
    let time = clock.time();
    let dt = models.physics.time_step * models.physics.gas.substeps() as f64;
    let step = GasStep { time, dt, gravity: models.physics.gravity.at(time) };
    let advanced =
        work.timers.time(Phase::Gas, || work.gas.advance(gas, particles, bed, &step, ranks));
    work.note_fault(advanced);
}
