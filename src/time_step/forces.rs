//! The forces of a step: of pairs of particles, of walls and of the gas.

use super::energy;
use super::laws::force_laws;
use crate::contact::{
    self, ForceLaws, add_contact_forces, add_flows, find_contacts, prepare_pairs, work_of_pairs,
};
use crate::domain::PosedWalls;
use crate::particles::{PairGroup, Part};
use crate::state::{Domain, Models, State, Workspace};
use crate::timers::Phase;

/// An evaluation of forces that has begun.
pub(super) struct Evaluation<'a> {
    laws: ForceLaws<'a>,
    /// Pairs of this rank's own particles whose forces are still to be added.
    own: Part,
}

/// Adds the forces of the first half of the pairs of this rank's own particles while the velocities of ghosts come from another machine,
/// if these pairs are known without ghosts and nobody needs contacts as they were before: new lists, a ledger of energies,
/// or the drag of agglomerates at a step of the gas.
///
/// Before: forces are those that [`kick_and_drift`](crate::particles::kick_and_drift) leaves.
pub(super) fn begin_early<'a>(
    rebuild: bool,
    state: &mut State,
    models: &'a Models,
    work: &mut Workspace,
    dt: f64,
) -> Option<Evaluation<'a>> {
    let gas = &models.physics.gas;
    let finds_agglomerates = gas.agglomerates().is_some() && gas.is_due(state.clock.step);
    if rebuild || !work.halo.comes_from_far() || finds_agglomerates || state.energy.is_some() {
        return None;
    }
    let laws = force_laws(state, models, work, dt);
    if !state.contacts.inner_list_is_valid(laws.ranges) {
        return None;
    }
    let State { particles, contacts, .. } = state;
    let added = work.timers.time(Phase::Contacts, || {
        prepare_pairs(particles, contacts, &laws);
        find_contacts(particles, contacts, &laws, PairGroup::Own)?;
        add_contact_forces(particles, contacts, &laws, (PairGroup::Own, Part::HALVES[0]))
    });
    work.note_fault(added);
    Some(Evaluation { laws, own: Part::HALVES[1] })
}

/// Begins an evaluation of forces, unless it has begun early: the laws of all contacts now, which advance histories by `dt`, and the
/// pairs within their ranges.
///
/// Before: forces are those of the weight and of a volume-averaged gas as of its last step; they are zero on copies, and
/// contributions are added in any order, since each is rounded to the quantum of force. A force without meaning is kept
/// as this rank's fault until the ranks agree at the next step.
pub(super) fn begin_forces<'a>(
    early: Option<Evaluation<'a>>,
    state: &mut State,
    domain: &Domain,
    models: &'a Models,
    work: &mut Workspace,
    dt: f64,
) -> Evaluation<'a> {
    early.unwrap_or_else(|| {
        let laws = force_laws(state, models, work, dt);
        energy::before_forces(state, domain, models, work, &laws);
        let State { particles, contacts, .. } = state;
        work.timers.time(Phase::Contacts, || prepare_pairs(particles, contacts, &laws));
        Evaluation { laws, own: Part::WHOLE }
    })
}

/// Adds the forces of pairs with a particle of another rank.
pub(super) fn add_shared_forces(now: &Evaluation, state: &mut State, work: &mut Workspace) {
    add_pair_forces((PairGroup::Shared, Part::WHOLE), &now.laws, state, work);
}

/// Adds the forces of the pairs of this rank's own particles that are left, and of walls.
pub(super) fn add_own_forces(
    now: &Evaluation,
    state: &mut State,
    domain: &Domain,
    work: &mut Workspace,
) {
    add_pair_forces((PairGroup::Own, now.own), &now.laws, state, work);
    add_wall_forces(&now.laws, state, domain, work);
}

/// Finds the pairs of a group that are in contact, unless that has been done with the first half of them, enters their work in the ledger
/// of energies, and adds their forces at the current positions and half-step velocities, and what flows between them.
fn add_pair_forces(
    (group, part): (PairGroup, Part),
    laws: &ForceLaws,
    state: &mut State,
    work: &mut Workspace,
) {
    let State { particles, contacts, energy, .. } = state;
    let added = work.timers.time(Phase::Contacts, || {
        if part == Part::WHOLE {
            find_contacts(particles, contacts, laws, group)?;
        }
        if let Some(ledger) = energy.as_mut().filter(|_| laws.dt > 0.0) {
            let add = |work| energy::add_contact_work(ledger, work);
            work_of_pairs(particles, contacts, laws, group, add);
        }
        add_contact_forces(particles, contacts, laws, (group, part))
    });
    work.note_fault(added);
    let exchanged =
        work.timers.time(Phase::Contacts, || add_flows(particles, contacts, laws.exchanges, group));
    work.note_fault(exchanged);
}

/// Adds the forces of walls on particles of this rank.
fn add_wall_forces(laws: &ForceLaws, state: &mut State, domain: &Domain, work: &mut Workspace) {
    let State { particles, contacts, .. } = state;
    let added = work.timers.time(Phase::Walls, || {
        let walls = PosedWalls { walls: &domain.walls, poses: &work.wall_poses };
        contact::add_wall_forces(particles, contacts, walls, laws, &mut work.on_walls)
    });
    work.note_fault(added);
}

/// Adds the forces of a column gas, and ends the evaluation of all forces in the ledger of energies.
///
/// Before: all other forces have been added, those of a volume-averaged gas as of its last step.
pub(super) fn add_gas_forces(state: &mut State, models: &Models, work: &mut Workspace, dt: f64) {
    let before_gas = state.energy.as_ref().map(|_| energy::forces_before_gas(&state.particles));
    let particles = &mut state.particles;
    let added = work.timers.time(Phase::GasForce, || work.gas.add_forces(particles));
    work.note_fault(added);
    if let Some(before_gas) = before_gas {
        energy::after_forces(state, models, &before_gas, dt);
    }
}

/// Advances the fields that touching particles exchange by what has flowed to each particle in a step of this length.
pub(super) fn advance_fields(state: &mut State, models: &Models, work: &mut Workspace, dt: f64) {
    let exchanges = &models.physics.exchanges;
    work.time(Phase::Contacts, |_| {
        contact::advance_fields(&mut state.particles, exchanges, dt);
    });
}
