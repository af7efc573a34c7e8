//! The decision of all ranks on what to do next: the one reduction of a step, and checks of their loads where lists are
//! kept for long.

use super::StepError;
use crate::domain::{Face, PosedWalls};
use crate::parallel::{CollectiveError, Communicator, agree};
use crate::particles::{DriftStep, PairCounts, Particles};
use crate::state::{Domain, Requests, State, Workspace};
use crate::timers::Phase;

/// The common decision of all ranks.
pub(super) struct StepDecision {
    /// Whether lists are outdated.
    pub(super) rebuild: bool,
    /// The requests made to any rank.
    pub(super) requests: Requests,
}

/// The displacement of particles in a step.
#[derive(Clone, Copy)]
pub(super) struct Displacement {
    /// The rule by which velocities become displacements.
    pub(super) step: DriftStep,
    /// Largest displacement of any particle of this rank since the lists were built; length.
    pub(super) largest: f64,
    /// Largest displacement allowed; length.
    pub(super) allowed: f64,
}

/// The one reduction of a step. The ranks learn how far particles have moved, how many pairs are near, whether any list
/// is outdated, whether any particle has left, whether anything has gone wrong, and whether any rank was asked to stop.
/// If a particle may have moved farther than allowed, lists are rebuilt at once, at the step at which this is found;
/// with any skin this is the same step.
pub(super) fn decide(
    state: &mut State,
    Displacement { largest: displacement, allowed, .. }: Displacement,
    domain: &Domain,
    work: &mut Workspace,
    ranks: &dyn Communicator,
) -> Result<StepDecision, StepError> {
    if work.balance.is_overdue(state.clock.step) {
        work.time(Phase::Decide, |work| work.check_loads(false, state, &domain.bounds, ranks));
    }
    let uneven = work.balance.has_plan();
    let Workspace { neighbours, wall_poses, timers, list_range, fault, requests, .. } = work;
    let step = state.clock.step;
    timers.time(Phase::Decide, || {
        let particles = &state.particles;
        let near_faces = neighbours.may_have_passed(displacement);
        let beyond = |kind| if near_faces { first_beyond(particles, domain, kind) } else { None };
        let (stopped, left) = (beyond(Face::Stop), beyond(Face::Open).is_some());
        let by_walls = neighbours
            .outdated_by_walls(PosedWalls { walls: &domain.walls, poses: wall_poses }, *list_range);
        let faulty = fault.is_some();
        let Requests { stop, checkpoint } = *requests;
        let flags = [left || by_walls, faulty, stopped.is_some(), stop, checkpoint];
        let [outdated, faulty, any_stopped, stop, checkpoint] = flags.map(f64::from);
        let PairCounts { listed, candidates } = state.contacts.pair_counts();
        let mut numbers =
            [displacement, listed, candidates, outdated, faulty, any_stopped, stop, checkpoint];
        ranks.maximum(&mut numbers);
        let [displacement, listed, candidates, flags @ ..] = numbers;
        let [outdated, faulty, any_stopped, stop, checkpoint] = flags.map(|flag| flag > 0.0);
        state.contacts.moved(displacement, PairCounts { listed, candidates });
        neighbours.moved(displacement);
        let too_far = displacement >= 0.999 * allowed;
        let outdated = outdated || too_far || neighbours.outdated(*list_range);
        if faulty {
            let message = agreed_message(fault.take(), ranks);
            return Err(StepError::Unstable { step: step - 1, message });
        }
        if any_stopped {
            return Err(StepError::Stopped { step, message: agreed_message(stopped, ranks) });
        }
        let requests = Requests { stop, checkpoint };
        Ok(StepDecision { rebuild: outdated || uneven, requests })
    })
}

/// The message of the lowest rank that has one.
pub(super) fn agreed_message(message: Option<String>, ranks: &dyn Communicator) -> String {
    let result = message.map_or(Ok(()), |message| Err(CollectiveError(message)));
    agree(result, ranks).err().map(|error| error.0).unwrap_or_default()
}

/// The first owned particle beyond a face of this kind.
fn first_beyond(particles: &Particles, domain: &Domain, kind: Face) -> Option<String> {
    let bounds = &domain.bounds;
    if !(0..3).any(|axis| bounds.faces(axis).contains(&kind)) {
        return None;
    }
    (0..particles.owned_count()).find_map(|i| {
        let face = bounds.passed(kind, &particles.body[i].position)?;
        Some(format!("particle {} passed the face \"{face}\" of the box", particles.id[i]))
    })
}
