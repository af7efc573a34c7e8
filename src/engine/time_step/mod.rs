//! The step: velocity Verlet for the particles, the gas, and all forces.

mod agglomerates;
mod decision;
mod energy;
mod forces;
mod gas;
mod halo;
mod laws;
mod rebuild;
mod staggered;

pub use energy::stored_energy;
pub use halo::refresh_ghosts;
pub use staggered::Staggered;

use crate::parallel::{CollectiveError, Communicator};
use crate::particles::{self, ContactHistories, DriftStep, set_first_forces};
use crate::state::{Domain, Models, Requests, State, Workspace};
use crate::timers::Phase;
use decision::{Displacement, agreed_message, decide};
use forces::{add_gas_forces, add_own_forces, add_shared_forces, advance_fields, begin_forces};
use gas::{advance_gas, find_agglomerates, start_bed_sum};
use halo::{receive_forces, receive_ghosts, return_forces, send_ghosts};
use rebuild::arrange;
use thiserror::Error;

/// The reason why a run cannot continue; it is equal on all ranks.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum StepError {
    /// A force, a speed or another number is no longer meaningful.
    #[error("step {step}: {message}")]
    Unstable {
        /// Step at which it was noticed.
        step: u64,
        /// Message of the lowest rank that noticed it.
        message: String,
    },
    /// A particle has passed a face at which the case ends the run.
    #[error("step {step}: {message}; the case ends the run there (box faces of kind \"stop\")")]
    Stopped {
        /// Step at which it passed.
        step: u64,
        /// Names the particle and the face.
        message: String,
    },
}

impl StepError {
    /// An error that occurred at a step.
    fn unstable(step: u64, error: CollectiveError) -> Self {
        Self::Unstable { step, message: error.0 }
    }
}

/// Advances the state by one step of length `models.physics.time_step`, except for its second half-kick, which
/// [`Staggered`] does later.
///
/// Before: forces are those of the current positions. After: this holds again, one step later. Returns the requests
/// made to any rank. Collective.
///
/// # Errors
/// If a force or a speed is not meaningful, or a particle passes a face of kind "stop".
pub fn advance(
    staggered: &mut Staggered,
    domain: &Domain,
    models: &Models,
    work: &mut Workspace,
    ranks: &dyn Communicator,
) -> Result<Requests, StepError> {
    let dt = models.physics.time_step;
    // [step]
    let (state, kick_due) = staggered.begin_step();
    let moved = move_bodies(state, kick_due, domain, models, work);
    let bed = start_bed_sum(state, work, ranks);
    let ghosts = send_ghosts(state, work, ranks);
    let decision = decide(state, moved, domain, work, ranks)?;
    receive_ghosts(ghosts, moved, state, work);
    if decision.rebuild {
        rebuild(state, domain, models, work, ranks)?;
    }
    find_agglomerates(state, domain, models, work, ranks);
    let laws = begin_forces(state, domain, models, work, dt);
    add_shared_forces(&laws, state, work);
    let forces = return_forces(state, work, ranks);
    add_own_forces(&laws, state, domain, work);
    receive_forces(forces, state, work);
    advance_fields(state, models, work, dt);
    advance_gas(bed.filter(|_| !decision.rebuild), state, models, work, ranks);
    add_gas_forces(state, models, work, dt);
    staggered.leave_kick(dt);
    // [/step]
    Ok(decision.requests)
}

/// Makes lists and ghosts for the first step. Collective.
///
/// # Errors
/// The errors of [`advance`].
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
    work.balance.begin(step);
    work.time(Phase::Rebuild, |work| arrange(state, domain, models, work, histories, ranks))
        .map_err(|error| StepError::unstable(step, error))
}

/// Computes the forces with which a new bed starts, after [`begin`]. Collective.
pub fn find_first_forces(
    state: &mut State,
    domain: &Domain,
    models: &Models,
    work: &mut Workspace,
    ranks: &dyn Communicator,
) {
    set_first_forces(&mut state.particles, models.weight_at(state.clock.time()));
    find_agglomerates(state, domain, models, work, ranks);
    let laws = begin_forces(state, domain, models, work, 0.0);
    add_shared_forces(&laws, state, work);
    let forces = return_forces(state, work, ranks);
    add_own_forces(&laws, state, domain, work);
    receive_forces(forces, state, work);
    advance_fields(state, models, work, 0.0);
    advance_gas(None, state, models, work, ranks);
    add_gas_forces(state, models, work, 0.0);
}

/// Sends particles to their owners and makes new ghosts and lists; called in a step, and when the models have changed.
/// Collective.
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

/// Checks that the last forces are meaningful, before they are written anywhere. Collective.
///
/// # Errors
/// The errors that [`advance`] would return at the next step.
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

/// v += (dt/2) F/m, after the second half-kick of the previous step if it is due, and x += dt v. Forces are then those
/// of the weight, and of a volume-averaged gas at its last step. Walls move to their positions at the end of the step.
/// Returns how far particles have moved.
fn move_bodies(
    state: &mut State,
    kick_due: Option<f64>,
    domain: &Domain,
    models: &Models,
    work: &mut Workspace,
) -> Displacement {
    work.balance.note_step(&work.timers);
    let quantum = domain.bounds.position_quantum();
    let weight = models.weight_at(state.clock.time());
    let step = DriftStep { dt: models.physics.time_step, quantum, weight };
    let particles = &mut state.particles;
    let largest =
        work.time(Phase::Integrate, |_| particles::kick_and_drift(particles, kick_due, step));
    work.move_walls(domain, state.clock.time(), step.dt);
    Displacement { step, largest, allowed: step.dt * models.limits.speed }
}
