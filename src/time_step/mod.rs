//! The step: velocity Verlet for the particles, the gas, and all forces.

mod agglomerates;
mod decision;
mod energy;
mod rebuild;
mod staggered;

pub use energy::stored_energy;
pub use staggered::Staggered;

use crate::contact::{
    ByPair, ContactWork, ForceLaws, VanDerWaalsNow, add_pair_forces, add_wall_forces,
};
use crate::domain::PosedWalls;
use crate::gas::GasStep;
use crate::parallel::{CollectiveError, Communicator};
use crate::particles::{
    self, ContactHistories, DriftStep, InteractionRanges, set_forces_to_weight,
};
use crate::state::{Domain, EnergyLedger, Models, Requests, State, Workspace};
use crate::timers::Phase;
use decision::{Displacement, agreed_message, decide};
use rebuild::arrange;
use thiserror::Error;

/// Why a run cannot go on. The same on all ranks.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum StepError {
    /// Numbers have lost their meaning.
    #[error("step {step}: {message}")]
    Unstable {
        /// At which step it was noticed.
        step: u64,
        /// On the lowest rank that noticed.
        message: String,
    },
    /// A particle passed a face at which the case ends the run.
    #[error("step {step}: {message}; the case ends the run there (box faces of kind \"stop\")")]
    Stopped {
        /// At which step.
        step: u64,
        /// Which particle, which face.
        message: String,
    },
}

impl StepError {
    /// What went wrong at a step.
    fn unstable(step: u64, error: CollectiveError) -> Self {
        Self::Unstable { step, message: error.0 }
    }
}

/// One step of length `models.physics.time_step`, but for its second half-kick, which [`Staggered`] owes.
///
/// Before: forces are those of the current positions. After: the same, one step later. Returns what any
/// rank was asked for. Collective.
///
/// # Errors
/// If a force or a speed has no meaning, or a particle passes a face of kind "stop".
pub fn advance(
    staggered: &mut Staggered,
    domain: &Domain,
    models: &Models,
    work: &mut Workspace,
    ranks: &dyn Communicator,
) -> Result<Requests, StepError> {
    let dt = models.physics.time_step;
    // [step]
    let (state, kick_due) = staggered.take();
    state.clock.tick();
    let displacement = kick_and_drift(state, kick_due, domain, models, work);
    work.move_walls(domain, state.clock.time(), dt);
    let decision = decide(state, displacement, domain, work, ranks)?;
    if decision.rebuild {
        rebuild(state, domain, models, work, ranks)?;
    } else {
        refresh_ghosts(state, work, ranks);
    }
    if state.clock.step.is_multiple_of(models.physics.gas.substeps()) {
        advance_gas(state, domain, models, work, ranks);
    }
    add_forces(state, domain, models, work, dt);
    staggered.leave_kick(dt);
    // [/step]
    Ok(decision.requests)
}

/// Makes lists and ghosts for the first step. Collective.
///
/// # Errors
/// As [`advance`].
pub fn begin(
    state: &mut State,
    domain: &Domain,
    models: &Models,
    work: &mut Workspace,
    histories: ContactHistories,
    ranks: &dyn Communicator,
) -> Result<(), StepError> {
    let step = state.clock.step;
    work.move_walls(domain, state.clock.time(), 0.0);
    work.time(Phase::Rebuild, |work| arrange(state, domain, models, work, histories, ranks))
        .map_err(|error| StepError::unstable(step, error))
}

/// Finds the forces that a new bed begins with, after [`begin`]. Collective.
pub fn find_first_forces(
    state: &mut State,
    domain: &Domain,
    models: &Models,
    work: &mut Workspace,
    ranks: &dyn Communicator,
) {
    set_forces_to_weight(&mut state.particles, models.weight_at(state.clock.time()));
    advance_gas(state, domain, models, work, ranks);
    add_forces(state, domain, models, work, 0.0);
}

/// Particles to their owners, new ghosts, new lists; in a step, and when the models have changed. Collective.
///
/// # Errors
/// If a particle is too fast, or the program loses a contact.
pub fn rebuild(
    state: &mut State,
    domain: &Domain,
    models: &Models,
    work: &mut Workspace,
    ranks: &dyn Communicator,
) -> Result<(), StepError> {
    let step = state.clock.step;
    work.time(Phase::Rebuild, |work| rebuild::rebuild(state, domain, models, work, ranks))
        .map_err(|error| StepError::unstable(step, error))
}

/// Makes sure that the last forces have a meaning, before they are written anywhere. Collective.
///
/// # Errors
/// As [`advance`] would say at the next step.
pub fn confirm(
    state: &State,
    work: &mut Workspace,
    ranks: &dyn Communicator,
) -> Result<(), StepError> {
    if !ranks.any(work.fault.is_some()) {
        return Ok(());
    }
    let message = agreed_message(work.fault.take(), ranks);
    Err(StepError::Unstable { step: state.clock.step, message })
}

/// v += (dt/2) F/m, after the second half-kick of the step before if it is due, and x += dt v; forces are then those of
/// the weight. Returns how far particles have moved.
fn kick_and_drift(
    state: &mut State,
    kick_due: Option<f64>,
    domain: &Domain,
    models: &Models,
    work: &mut Workspace,
) -> Displacement {
    let dt = models.physics.time_step;
    let quantum = domain.bounds.position_quantum();
    let weight = models.weight_at(state.clock.time());
    let step = DriftStep { dt, quantum, weight };
    let particles = &mut state.particles;
    let timers = &mut work.timers;
    let largest =
        timers.time(Phase::Integrate, || particles::kick_and_drift(particles, kick_due, step));
    Displacement { largest, allowed: dt * models.limits.speed }
}

/// Brings ghosts up to date. Collective.
pub fn refresh_ghosts(state: &mut State, work: &mut Workspace, ranks: &dyn Communicator) {
    work.timers.time(Phase::Halo, || work.halo.refresh(&mut state.particles, ranks));
}

/// A step of the gas from the particles as they are now. Collective.
fn advance_gas(
    state: &mut State,
    domain: &Domain,
    models: &Models,
    work: &mut Workspace,
    ranks: &dyn Communicator,
) {
    work.timers.time(Phase::Gas, || agglomerates::look_if_due(state, domain, models, ranks));
    let State { particles, gas, clock, .. } = state;
    let time = clock.time();
    let dt = models.physics.time_step * models.physics.gas.substeps() as f64;
    let step = GasStep { time, dt, gravity: models.physics.gravity.at(time) };
    let advanced = work.timers.time(Phase::Gas, || work.gas.advance(gas, particles, &step, ranks));
    work.note_fault(advanced);
}

/// Adds the forces of contacts, walls and gas at the current positions and half-step velocities; the histories of
/// contacts are advanced by `dt`.
///
/// Before: forces are those of the weight. The order changes nothing, since every contribution is rounded to the quantum
/// of force. A force without meaning is kept as this rank's fault until the ranks agree at the next step.
fn add_forces(state: &mut State, domain: &Domain, models: &Models, work: &mut Workspace, dt: f64) {
    let cohesion = models.physics.cohesion_at(state.clock.time());
    let laws = force_laws(state, models, work, cohesion.as_ref(), dt);
    let mut ledger = state.energy.take();
    if let Some(ledger) = &mut ledger {
        energy::before_forces(ledger, state, domain, models, work, &laws);
    }
    work.on_particles(|work| {
        let of_contacts = ledger.as_deref_mut().filter(|_| dt > 0.0);
        add_contact_forces(state, &laws, work, of_contacts);
        add_forces_of_walls(state, domain, &laws, work);
        let before_gas = ledger.as_ref().map(|_| energy::forces_so_far(&state.particles));
        add_gas_forces(state, work);
        if let Some((ledger, before_gas)) = ledger.as_deref_mut().zip(before_gas) {
            energy::after_forces(ledger, state, models, &before_gas, dt);
        }
    });
    state.energy = ledger;
}

/// The laws of all contacts now, with the attraction that there is now; they advance histories by `dt`.
fn force_laws<'a>(
    state: &State,
    models: &'a Models,
    work: &Workspace,
    cohesion: Option<&'a ByPair<VanDerWaalsNow>>,
    dt: f64,
) -> ForceLaws<'a> {
    ForceLaws {
        contact: &models.physics.contact,
        at_walls: &models.physics.at_walls,
        cohesion,
        ranges: InteractionRanges {
            contact: models.contact_range(&state.sizes),
            any: work.list_range.interaction,
        },
        dt,
        limit: models.limits.force,
        force_quantum: models.force_quantum,
        torque_quantum: models.torque_quantum,
    }
}

fn add_contact_forces(
    state: &mut State,
    laws: &ForceLaws,
    work: &mut Workspace,
    ledger: Option<&mut EnergyLedger>,
) {
    let State { particles, contacts, .. } = state;
    let mut account = ledger.map(|ledger| |work| energy::add_contact_work(ledger, work));
    let account = account.as_mut().map(|account| account as &mut dyn FnMut(ContactWork));
    let added =
        work.timers.time(Phase::Contacts, || add_pair_forces(particles, contacts, laws, account));
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
