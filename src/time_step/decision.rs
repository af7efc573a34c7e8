//! What all ranks do next: the one reduction of a step, and looks at their loads where lists live long.

use super::StepError;
use crate::domain::{Face, PosedWalls};
use crate::parallel::{CollectiveError, Communicator, agree};
use crate::particles::{DriftStep, PairCounts, Particles};
use crate::state::{Domain, Requests, State, Workspace};
use crate::timers::Phase;

/// What all ranks do next.
pub(super) struct StepDecision {
    /// Whether lists are outdated.
    pub(super) rebuild: bool,
    /// What any rank was asked for.
    pub(super) requests: Requests,
}

/// How particles move in a step.
#[derive(Clone, Copy)]
pub(super) struct Displacement {
    /// How velocities become displacements.
    pub(super) step: DriftStep,
    /// Farthest that any particle of this rank has moved; length.
    pub(super) largest: f64,
    /// Farthest that one may move; length.
    pub(super) allowed: f64,
}

/// One reduction per step: how far have particles moved, how many pairs are near, is any list outdated, has any particle left, has anything
/// gone wrong, was any rank asked to stop? If a particle may have moved farther than allowed, lists
/// are rebuilt at once, where it is found: at the same step with any skin.
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
