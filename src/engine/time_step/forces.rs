//! Forces of a step: of pairs of particles, of walls and of the gas.

use super::energy;
use super::laws::force_laws;
use crate::contact::{
    self, ForceLaws, add_contact_forces, add_flows, find_contacts, find_mesh_contacts,
    prepare_pairs, work_of_pairs,
};
use crate::domain::PosedWalls;
use crate::particles::PairGroup;
use crate::state::{Domain, Models, State, Workspace};
use crate::timers::Phase;

/// Begins an evaluation of forces: sets up the present laws of all contacts, which advance histories by `dt`, and finds
/// the pairs within their ranges.
///
/// Before: forces are those of the weight and of a volume-averaged gas at its last step. They are zero on copies.
/// Contributions are added in any order, since each is rounded to the quantum of force. A force that is not finite or
/// too large is kept as this rank's fault until the ranks agree at the next step.
pub(super) fn begin_forces<'a>(
    state: &mut State,
    domain: &Domain,
    models: &'a Models,
    work: &mut Workspace,
    dt: f64,
) -> ForceLaws<'a> {
    let laws = force_laws(state, models, work, dt);
    let walls = PosedWalls { walls: &domain.walls, poses: &work.wall_poses };
    let State { particles, contacts, .. } = state;
    work.timers.time(Phase::Walls, || {
        find_mesh_contacts(particles, contacts, walls, laws.ranges.any);
    });
    energy::before_forces(state, domain, models, work, &laws);
    let State { particles, contacts, .. } = state;
    work.timers.time(Phase::Contacts, || prepare_pairs(particles, contacts, &laws));
    laws
}

/// Adds the forces of pairs with a particle of another rank.
pub(super) fn add_shared_forces(laws: &ForceLaws, state: &mut State, work: &mut Workspace) {
    add_pair_forces(PairGroup::Shared, laws, state, work);
}

/// Adds the forces of the pairs of this rank's own particles, and of walls.
pub(super) fn add_own_forces(
    laws: &ForceLaws,
    state: &mut State,
    domain: &Domain,
    work: &mut Workspace,
) {
    add_pair_forces(PairGroup::Own, laws, state, work);
    add_wall_forces(laws, state, domain, work);
}

/// Finds the pairs of a group that are in contact, enters their work in the energy ledger, and adds their forces at the
/// current positions and half-step velocities, and the flows between them.
fn add_pair_forces(group: PairGroup, laws: &ForceLaws, state: &mut State, work: &mut Workspace) {
    let State { particles, contacts, energy, .. } = state;
    let added = work.timers.time(Phase::Contacts, || {
        find_contacts(particles, contacts, laws, group)?;
        if let Some(ledger) = energy.as_mut().filter(|_| laws.dt > 0.0) {
            let add = |work| energy::add_contact_work(ledger, work);
            work_of_pairs(particles, contacts, laws, group, add);
        }
        add_contact_forces(particles, contacts, laws, group)
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

/// Adds the forces of a column gas, and ends the evaluation of all forces in the energy ledger.
///
/// Before: all other forces have been added, including those of a volume-averaged gas at its last step.
pub(super) fn add_gas_forces(state: &mut State, models: &Models, work: &mut Workspace, dt: f64) {
    let before_gas = state.energy.as_ref().map(|_| energy::forces_before_gas(&state.particles));
    let particles = &mut state.particles;
    let added = work.timers.time(Phase::GasForce, || work.gas.add_forces(particles));
    work.note_fault(added);
    if let Some(before_gas) = before_gas {
        energy::after_forces(state, models, &before_gas, dt);
    }
}

/// Advances the fields that touching particles exchange by the amount that has flowed to each particle in a step of
/// this length.
pub(super) fn advance_fields(state: &mut State, models: &Models, work: &mut Workspace, dt: f64) {
    let exchanges = &models.physics.exchanges;
    work.time(Phase::Contacts, |_| {
        contact::advance_fields(&mut state.particles, exchanges, dt);
    });
}
