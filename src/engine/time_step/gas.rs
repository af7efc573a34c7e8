//! The step of the gas, and the sums over the particles of all ranks that a column gas needs.

use super::agglomerates;
use crate::gas::{GasStep, NodeSums};
use crate::parallel::{Communicator, Pending};
use crate::state::{Domain, Models, State, Workspace};
use crate::timers::Phase;

/// Pending sums over the particles of all ranks; `None` unless the gas is a column gas.
pub(super) type BedSum<'r> = Option<Pending<'r, Vec<f64>>>;

/// Deposits this rank's particles on the grid of a column gas, and begins to sum the numbers at its nodes over the
/// ranks. Collective.
///
/// Before: particles have the positions and velocities to be used by the gas.
pub(super) fn start_bed_sum<'r>(
    state: &State,
    work: &mut Workspace,
    ranks: &'r dyn Communicator,
) -> BedSum<'r> {
    work.time(Phase::Gas, |work| {
        let sums = work.gas.sum_bed(&state.particles)?;
        Some(ranks.start_sum_exact(sums.into()))
    })
}

/// Finds the agglomerates if a search is due before this step of the gas, while contacts are still those of the
/// previous step. Collective.
pub(super) fn find_agglomerates(
    state: &mut State,
    domain: &Domain,
    models: &Models,
    work: &mut Workspace,
    ranks: &dyn Communicator,
) {
    if models.physics.gas.is_due(state.clock.step) {
        work.timers.time(Phase::Gas, || agglomerates::find_if_due(state, domain, models, ranks));
    }
}

/// Advances the gas by a step, if one is due, from the present particles, with the sums of [`start_bed_sum`] if these
/// are still valid. Collective.
pub(super) fn advance_gas(
    bed: BedSum<'_>,
    state: &mut State,
    models: &Models,
    work: &mut Workspace,
    ranks: &dyn Communicator,
) {
    let State { particles, gas, clock, .. } = state;
    if !models.physics.gas.is_due(clock.step) {
        return;
    }
    let time = clock.time();
    let dt = models.physics.time_step * models.physics.gas.substeps() as f64;
    let step = GasStep { time, dt, gravity: models.physics.gravity.at(time) };
    let advanced = work.time(Phase::Gas, |work| {
        let bed = bed.map(|sums| NodeSums::from(sums.finish()));
        work.gas.advance(gas, particles, bed, &step, ranks)
    });
    work.note_fault(advanced);
}
