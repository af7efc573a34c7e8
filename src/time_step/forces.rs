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
use crate::particles::{Half, PairGroup};
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
    /// Groups in which it is not known which pairs are in contact.
    fn groups_to_search(self) -> &'static [PairGroup] {
        match self {
            Self::All => &PairGroup::ALL,
            Self::SharedAndSecondHalf => &[PairGroup::Shared],
        }
    }

    fn halves_of_own(self) -> &'static [Half] {
        match self {
            Self::All => &Half::BOTH,
            Self::SharedAndSecondHalf => &[Half::Second],
        }
    }
}

/// Adds the forces of the first half of the pairs of this rank's own particles if these are known without a look at ghosts,
/// and nobody needs contacts as they were before, of all pairs alike: an account of energies, or the drag of agglomerates at a
/// step of the gas. Returns what is left to [`add_forces`].
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
    let gas_looks = gas.agglomerates().is_some() && state.clock.step.is_multiple_of(gas.substeps());
    if gas_looks || state.energy.is_some() || !state.contacts.inner_list_is_valid(laws.ranges) {
        return PairsDue::All;
    }
    let State { particles, contacts, .. } = state;
    work.on_particles(|work| {
        let added = work.timers.time(Phase::Contacts, || {
            prepare_pairs(particles, contacts, &laws);
            find_contacts(particles, contacts, &laws, PairGroup::Own)?;
            add_contact_forces(particles, contacts, &laws, (PairGroup::Own, Half::First))
        });
        work.note_fault(added);
    });
    PairsDue::SharedAndSecondHalf
}

/// Adds the forces of contacts, walls and gas at the current positions and half-step velocities; the histories of
/// contacts are advanced by `dt`. Forces on particles of other ranks travel to their owners while this rank's own pairs are
/// evaluated. Collective.
///
/// Before: forces are those of the weight, of the pairs that are not due, and of a gas in three dimensions; they are zero on
/// copies. The order changes nothing, since every contribution is rounded to the quantum of force. A force without meaning is
/// kept as this rank's fault until the ranks agree at the next step.
pub(super) fn add_forces(
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
    work.on_particles(|work| {
        let of_contacts = ledger.as_deref_mut().filter(|_| dt > 0.0);
        find_due_contacts(pairs, state, &laws, work, of_contacts);
        let shared = Half::BOTH.into_iter().map(|half| (PairGroup::Shared, half));
        add_forces_of_pairs(shared, state, &laws, work);
    });
    while_forces_return(state, work, ranks, |state, work| {
        work.on_particles(|work| {
            let own = pairs.halves_of_own().iter().map(|&half| (PairGroup::Own, half));
            add_forces_of_pairs(own, state, &laws, work);
            add_forces_of_walls(state, domain, &laws, work);
        });
    });
    work.on_particles(|work| {
        let before_gas = ledger.as_ref().map(|_| energy::forces_before_gas(&state.particles));
        add_gas_forces(state, work);
        if let Some((ledger, before_gas)) = ledger.as_deref_mut().zip(before_gas) {
            energy::after_forces(ledger, state, models, &before_gas, dt);
        }
    });
    state.energy = ledger;
}

/// Finds the contacts of the pairs that are due, and accounts for their work if there is a ledger.
fn find_due_contacts(
    pairs: PairsDue,
    state: &mut State,
    laws: &ForceLaws,
    work: &mut Workspace,
    ledger: Option<&mut EnergyLedger>,
) {
    let State { particles, contacts, .. } = state;
    let found = work.timers.time(Phase::Contacts, || {
        if pairs == PairsDue::All {
            prepare_pairs(particles, contacts, laws);
        }
        let mut groups = pairs.groups_to_search().iter();
        groups.try_for_each(|&group| find_contacts(particles, contacts, laws, group))?;
        if let Some(ledger) = ledger {
            let account = |work| energy::add_contact_work(ledger, work);
            work_of_pairs(particles, contacts, laws, account);
        }
        Ok::<(), ForceOutOfRange>(())
    });
    work.note_fault(found);
}

fn add_forces_of_pairs(
    mut parts: impl Iterator<Item = (PairGroup, Half)>,
    state: &mut State,
    laws: &ForceLaws,
    work: &mut Workspace,
) {
    let State { particles, contacts, .. } = state;
    let added = work.timers.time(Phase::Contacts, || {
        parts.try_for_each(|part| add_contact_forces(particles, contacts, laws, part))
    });
    work.note_fault(added);
}

fn add_forces_of_walls(state: &mut State, domain: &Domain, laws: &ForceLaws, work: &mut Workspace) {
    let State { particles, contacts, .. } = state;
    let added = work.timers.time(Phase::Walls, || {
        let walls = PosedWalls { walls: &domain.walls, poses: &work.wall_poses };
        add_wall_forces(particles, contacts, walls, laws, &mut work.on_walls)
    });
    work.note_fault(added);
}

fn add_gas_forces(state: &mut State, work: &mut Workspace) {
    let particles = &mut state.particles;
    let added = work.timers.time(Phase::GasForce, || work.gas.add_forces(particles));
    work.note_fault(added);
}
