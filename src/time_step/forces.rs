//! The forces of a step: of pairs of particles, of walls and of the gas.

use super::energy;
use super::halo::while_forces_return;
use super::laws::force_laws;
use crate::contact::{
    ForceLaws, ForceOutOfRange, add_contact_forces, add_wall_forces, find_contacts, prepare_pairs,
    work_of_pairs,
};
use crate::domain::PosedWalls;
use crate::parallel::Communicator;
use crate::particles::{PairGroup, Part};
use crate::state::{Domain, EnergyLedger, Models, State, Workspace};
use crate::timers::Phase;

/// Pairs whose forces have not been added at a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PairsDue {
    /// All.
    All,
    /// Those with a particle of another rank, and the second half of the others.
    SharedAndSecondHalf,
}

impl PairsDue {
    fn part_of_own(self) -> Part {
        match self {
            Self::All => Part::WHOLE,
            Self::SharedAndSecondHalf => Part::HALVES[1],
        }
    }
}

/// Adds the forces of the first half of the pairs of this rank's own particles if these are known without a look at ghosts,
/// and nobody needs contacts as they were before, of all pairs alike: an account of energies, or the drag of agglomerates at a
/// step of the gas. Returns what is left to [`add_forces_of_contacts`].
///
/// Before: forces are those that [`kick_and_drift`](crate::particles::kick_and_drift) leaves.
pub(super) fn add_own_pairs(
    state: &mut State,
    models: &Models,
    work: &mut Workspace,
    dt: f64,
) -> PairsDue {
    let cohesion = models.physics.cohesion_at(state.clock.time());
    let laws = force_laws(state, models, work, cohesion.as_ref(), dt);
    let gas = &models.physics.gas;
    let gas_looks = gas.agglomerates().is_some() && gas.is_due(state.clock.step);
    if gas_looks || state.energy.is_some() || !state.contacts.inner_list_is_valid(laws.ranges) {
        return PairsDue::All;
    }
    let State { particles, contacts, .. } = state;
    time_contacts(work, || {
        prepare_pairs(particles, contacts, &laws);
        find_contacts(particles, contacts, &laws, PairGroup::Own)?;
        add_contact_forces(particles, contacts, &laws, (PairGroup::Own, Part::HALVES[0]))
    });
    PairsDue::SharedAndSecondHalf
}

/// Adds the forces of contacts and walls at the current positions and half-step velocities; the histories of contacts are
/// advanced by `dt`. Pairs with particles of other ranks come first: the forces on these travel to their owners while this
/// rank's own pairs are evaluated. Collective.
///
/// Before: forces are those of the weight, of the pairs that are not due, and of a gas in three dimensions as of its last step; they are
/// zero on copies. The order changes nothing, since every contribution is rounded to the quantum of force. A force without meaning is
/// kept as this rank's fault until the ranks agree at the next step.
pub(super) fn add_forces_of_contacts(
    pairs: PairsDue,
    state: &mut State,
    domain: &Domain,
    models: &Models,
    work: &mut Workspace,
    ranks: &dyn Communicator,
    dt: f64,
) {
    let cohesion = models.physics.cohesion_at(state.clock.time());
    let laws = force_laws(state, models, work, cohesion.as_ref(), dt);
    let mut ledger = state.energy.take();
    if let Some(ledger) = &mut ledger {
        energy::before_forces(ledger, state, domain, models, work, &laws);
    }
    let account = ledger.as_deref_mut().filter(|_| dt > 0.0);
    let (found_first, found_last): (&[PairGroup], &[PairGroup]) = match (pairs, &account) {
        (PairsDue::All, Some(_)) => (&PairGroup::ALL, &[]), // the account is of all, as they were before
        (PairsDue::All, None) => (&[PairGroup::Shared], &[PairGroup::Own]),
        (PairsDue::SharedAndSecondHalf, _) => (&[PairGroup::Shared], &[]),
    };
    time_contacts(work, || {
        if pairs == PairsDue::All {
            prepare_pairs(&state.particles, &mut state.contacts, &laws);
        }
        find_pairs(found_first, state, &laws)?;
        account.into_iter().for_each(|ledger| account_for_contacts(ledger, state, &laws));
        let State { particles, contacts, .. } = state;
        add_contact_forces(particles, contacts, &laws, (PairGroup::Shared, Part::WHOLE))
    });
    while_forces_return(state, work, ranks, |state, work| {
        time_contacts(work, || {
            find_pairs(found_last, state, &laws)?;
            let State { particles, contacts, .. } = state;
            add_contact_forces(particles, contacts, &laws, (PairGroup::Own, pairs.part_of_own()))
        });
        add_forces_of_walls(state, domain, &laws, work);
    });
    state.energy = ledger;
}

/// Adds the forces of a column gas, and ends the evaluation of all forces in the account of energies.
///
/// Before: all other forces have been added, those of a gas in three dimensions as of its last step.
pub(super) fn add_forces_of_gas(state: &mut State, models: &Models, work: &mut Workspace, dt: f64) {
    let mut ledger = state.energy.take();
    let before_gas = ledger.as_ref().map(|_| energy::forces_before_gas(&state.particles));
    let particles = &mut state.particles;
    let added = work.timers.time(Phase::GasForce, || work.gas.add_forces(particles));
    work.note_fault(added);
    if let Some((ledger, before_gas)) = ledger.as_deref_mut().zip(before_gas) {
        energy::after_forces(ledger, state, models, &before_gas, dt);
    }
    state.energy = ledger;
}

/// Does work on contacts, and keeps what goes wrong.
fn time_contacts(work: &mut Workspace, of_contacts: impl FnOnce() -> Result<(), ForceOutOfRange>) {
    let done = work.timers.time(Phase::Contacts, of_contacts);
    work.note_fault(done);
}

/// Finds the pairs of these groups that are in contact.
fn find_pairs(
    groups: &[PairGroup],
    State { particles, contacts, .. }: &mut State,
    laws: &ForceLaws,
) -> Result<(), ForceOutOfRange> {
    groups.iter().try_for_each(|&group| find_contacts(particles, contacts, laws, group))
}

fn account_for_contacts(ledger: &mut EnergyLedger, state: &State, laws: &ForceLaws) {
    let add = |work| energy::add_contact_work(ledger, work);
    work_of_pairs(&state.particles, &state.contacts, laws, add);
}

fn add_forces_of_walls(state: &mut State, domain: &Domain, laws: &ForceLaws, work: &mut Workspace) {
    let State { particles, contacts, .. } = state;
    let added = work.timers.time(Phase::Walls, || {
        let walls = PosedWalls { walls: &domain.walls, poses: &work.wall_poses };
        add_wall_forces(particles, contacts, walls, laws, &mut work.on_walls)
    });
    work.note_fault(added);
}
