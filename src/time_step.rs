//! The step: velocity Verlet for the particles, the gas of the moment, and all forces.

use crate::contact::{ForceLaws, add_pair_forces, add_wall_forces};
use crate::domain::{Bounds, Decomposition, Face, PosedWalls};
use crate::gas::{GasLayout, GasStep, ParticleLimits};
use crate::numbers::ExactSum;
use crate::parallel::{CollectiveError, Communicator, RankLoad, agree, migrate, share_with_all};
use crate::particles::{
    ContactHistories, Particles, Ranges, Step, begin_with_weight, kick, kick_and_drift,
};
use crate::state::{Domain, Models, Requests, State, Workspace};
use crate::timers::{Phase, processor_time};
use std::collections::HashSet;
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

/// One step of length `models.time_step`, but for its second kick, which [`complete`] does, or the next step
/// together with its first.
///
/// Before: forces are those of the current positions. After: the same, one step later. Returns what any
/// rank was asked for.
///
/// # Errors
/// If a force or a speed has no meaning, or a particle passes a face of kind "stop".
pub fn advance(
    state: &mut State,
    domain: &Domain,
    models: &Models,
    work: &mut Workspace,
    ranks: &dyn Communicator,
) -> Result<Requests, StepError> {
    let dt = models.time_step;
    let quantum = domain.bounds.position_quantum();
    let late = state.kick_due.take();
    state.clock.tick();
    let weight = models.weight_at(state.clock.time());
    let integrate = || kick_and_drift(&mut state.particles, late, Step { dt, quantum, weight });
    let displacement = work.timers.time(Phase::Integrate, integrate);
    work.move_walls(domain, state.clock.time(), dt);
    let decision = decide(state, displacement, domain, work, ranks)?;
    if decision.rebuild {
        rebuild(state, domain, models, work, ranks)?;
    } else {
        work.timers.time(Phase::Halo, || work.halo.refresh(&mut state.particles, ranks));
    }
    evaluate_forces(state, domain, models, work, dt, ranks);
    state.kick_due = Some(dt);
    Ok(decision.requests)
}

/// Does the second kick of the last step if it is still due: velocities are then those of the clock's time. Before
/// anybody looks at them.
pub fn complete(state: &mut State, work: &mut Workspace) {
    if let Some(dt) = state.kick_due.take() {
        work.timers.time(Phase::Integrate, || kick(&mut state.particles, dt));
    }
}

/// Makes lists and ghosts for the first step, and, for a new bed, the forces it begins with.
///
/// # Errors
/// As [`advance`].
pub fn begin(
    state: &mut State,
    domain: &Domain,
    models: &Models,
    work: &mut Workspace,
    histories: ContactHistories,
    new_bed: bool,
    ranks: &dyn Communicator,
) -> Result<(), StepError> {
    work.move_walls(domain, state.clock.time(), 0.0);
    arrange(state, domain, models, work, histories, ranks)?;
    if new_bed {
        begin_with_weight(&mut state.particles, models.weight_at(state.clock.time()));
        evaluate_forces(state, domain, models, work, 0.0, ranks);
    }
    Ok(())
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
    let message = agreed_words(work.fault.take(), ranks);
    Err(StepError::Unstable { step: state.clock.step, message })
}

/// What all ranks do next.
struct StepDecision {
    rebuild: bool,
    requests: Requests,
}

/// One reduction per step: how far have particles moved, is any list outdated, has any particle left, has anything
/// gone wrong, was any rank asked to stop? No particle of this rank has moved farther than `displacement`.
fn decide(
    state: &mut State,
    displacement: f64,
    domain: &Domain,
    work: &mut Workspace,
    ranks: &dyn Communicator,
) -> Result<StepDecision, StepError> {
    let Workspace { neighbours, wall_poses, timers, reach, fault, requests, .. } = work;
    let step = state.clock.step;
    let balance_due = work.balance.is_some_and(|balance| balance.is_overdue(step));
    timers.time(Phase::Decide, || {
        let particles = &state.particles;
        let near_faces = neighbours.may_have_passed(displacement);
        let beyond = |kind| if near_faces { first_beyond(particles, domain, kind) } else { None };
        let (stopped, left) = (beyond(Face::Stop), beyond(Face::Open).is_some());
        let by_walls = neighbours
            .outdated_by_walls(PosedWalls { walls: &domain.walls, poses: wall_poses }, *reach);
        let faulty = fault.is_some();
        let Requests { stop, checkpoint } = *requests;
        let flags = [left || by_walls, faulty, stopped.is_some(), stop, checkpoint];
        let [outdated, faulty, any_stopped, stop, checkpoint] = flags.map(f64::from);
        let mut said = [displacement, outdated, faulty, any_stopped, stop, checkpoint];
        ranks.maximum(&mut said);
        let [displacement, flags @ ..] = said;
        let [outdated, faulty, any_stopped, stop, checkpoint] = flags.map(|flag| flag > 0.0);
        state.contacts.moved(displacement);
        neighbours.moved(displacement);
        let outdated = outdated || neighbours.outdated(*reach);
        if faulty {
            let message = agreed_words(fault.take(), ranks);
            return Err(StepError::Unstable { step: step - 1, message });
        }
        if any_stopped {
            return Err(StepError::Stopped { step, message: agreed_words(stopped, ranks) });
        }
        let requests = Requests { stop, checkpoint };
        Ok(StepDecision { rebuild: outdated || balance_due, requests })
    })
}

/// The words of the lowest rank that has some.
fn agreed_words(message: Option<String>, ranks: &dyn Communicator) -> String {
    let result = message.map_or(Ok(()), |message| Err(CollectiveError(message)));
    agree(result, ranks).err().map(|error| error.0).unwrap_or_default()
}

/// The first owned particle beyond a face of this kind, in words.
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

/// Particles to their owners, new ghosts, new lists; what contacts remember goes along.
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
    complete(state, work);
    let histories = state.contacts.histories(&state.particles);
    state.particles.drop_ghosts();
    let step = state.clock.step;
    check_speeds(&state.particles, models.limits.speed, ranks)
        .map_err(|error| StepError::Unstable { step, message: error.0 })?;
    arrange(state, domain, models, work, histories, ranks)
}

fn arrange(
    state: &mut State,
    domain: &Domain,
    models: &Models,
    work: &mut Workspace,
    mut histories: ContactHistories,
    ranks: &dyn Communicator,
) -> Result<(), StepError> {
    let begin = std::time::Instant::now();
    let bounds = &domain.bounds;
    let width = work.reach.ghost_width(state.sizes.largest_diameter);
    let old_decomposition = work.decomposition.clone();
    depart(state, domain, &mut histories, ranks);
    let unstable =
        |step: u64| move |error: CollectiveError| StepError::Unstable { step, message: error.0 };
    let unstable = unstable(state.clock.step);
    let State { particles, contacts, clock, .. } = state;
    for body in &mut particles.body {
        body.position = bounds.wrap(body.position);
    }
    if work.balance.as_mut().is_some_and(|balance| balance.look(clock.step)) {
        rebalance(particles, bounds, work, width, ranks);
    }
    work.decomposition = models.gas.align(&work.decomposition, width).map_err(unstable)?;
    migrate(particles, &mut histories, &work.decomposition, ranks);
    let before = processor_time();
    work.neighbours.sort_by_cells(particles, width);
    work.neighbours.note_faces(particles, bounds);
    work.timers.on_particles += processor_time() - before;
    let subdomain = work.decomposition.subdomain(bounds, ranks.rank());
    work.halo.rebuild(particles, subdomain, width, ranks);
    let before = processor_time();
    let walls = PosedWalls { walls: &domain.walls, poses: &work.wall_poses };
    let rebuilt = work.neighbours.rebuild(particles, contacts, walls, work.reach, &histories);
    work.timers.on_particles += processor_time() - before;
    agree(rebuilt, ranks).map_err(unstable)?;
    let settled = distribute_gas(state, domain, models, work, &old_decomposition, ranks);
    work.timers.add(Phase::Rebuild, begin.elapsed());
    settled.map_err(unstable)
}

/// Brings the gas to the ranks of the new decomposition. Collective.
fn distribute_gas(
    state: &mut State,
    domain: &Domain,
    models: &Models,
    work: &mut Workspace,
    before: &Decomposition,
    ranks: &dyn Communicator,
) -> Result<(), CollectiveError> {
    let layout = GasLayout {
        limits: ParticleLimits {
            diameters: [state.sizes.smallest_diameter, state.sizes.largest_diameter],
            force: models.limits.force,
            force_quantum: models.force_quantum,
            speed: models.limits.speed,
            drift: 0.5 * work.reach.skin,
        },
        before,
        subdomain: work.decomposition.subdomain(&domain.bounds, ranks.rank()),
        time: state.clock.time(),
    };
    let State { particles, gas, .. } = state;
    work.gas.distribute(&models.gas, gas, particles, &layout, ranks)
}

/// Moves the cut planes if the load on the ranks is uneven. Collective.
fn rebalance(
    particles: &Particles,
    bounds: &Bounds,
    work: &mut Workspace,
    width: f64,
    ranks: &dyn Communicator,
) {
    let threshold = work.balance.map_or(f64::INFINITY, |balance| balance.threshold);
    let load = RankLoad::measured(particles.owned_count(), work.time_since_last_look(), ranks);
    if ranks.is_root() {
        log::debug!("largest over mean load {:.3}", load.imbalance);
    }
    if load.imbalance > threshold {
        let positions = particles.body.iter().map(|body| body.position);
        work.decomposition = load.balanced(&work.decomposition, positions, bounds, width, ranks);
    }
}

/// Takes particles beyond open faces out of the run, with the histories of their contacts. Collective.
fn depart(
    state: &mut State,
    domain: &Domain,
    histories: &mut ContactHistories,
    ranks: &dyn Communicator,
) {
    let particles = &mut state.particles;
    let gone =
        |i: u32| domain.bounds.passed(Face::Open, &particles.body[i as usize].position).is_some();
    let (leaving, staying): (Vec<u32>, Vec<u32>) =
        (0..particles.owned_count() as u32).partition(|&i| gone(i));
    if !ranks.any(!leaving.is_empty()) {
        return;
    }
    let ids: Vec<u64> = leaving.iter().map(|&i| particles.id[i as usize]).collect();
    let mut volume = ExactSum::default();
    leaving.iter().for_each(|&i| volume.add(particles.volume(i as usize)));
    let mut integers = volume.to_integers();
    ranks.sum_integers(&mut integers);
    let gone: HashSet<u64> = share_with_all(ids, ranks).into_iter().collect();
    state.departed.count += gone.len() as u64;
    state.departed.volume += ExactSum::from_integers(&integers).value();
    histories.retain_particles(|id| !gone.contains(&id));
    particles.select(&staying);
}

/// A particle that moves a tenth of the smallest diameter in one step passes through others unseen.
fn check_speeds(
    particles: &Particles,
    limit: f64,
    ranks: &dyn Communicator,
) -> Result<(), CollectiveError> {
    let allowed = |i: usize| particles.body[i].velocity.norm() <= limit; // an undefined one is not
    let too_fast = (0..particles.owned_count()).find(|&i| !allowed(i));
    let result = match too_fast {
        None => Ok(()),
        Some(i) => Err(format!(
            "particle {} moves at {:.3e} (limit {limit:.3e}: a tenth of the smallest diameter per step): \
             shorten time.step",
            particles.id[i],
            particles.body[i].velocity.norm()
        )),
    };
    agree(result, ranks)
}

/// All forces at the current positions and half-step velocities; tangential springs move on by `dt`.
///
/// Before: forces are those of the weight. Contacts and walls are added first, then gas; the order changes nothing,
/// since every contribution lies on the lattice of forces. A force without meaning is kept as this
/// rank's fault until the ranks agree at the next step.
fn evaluate_forces(
    state: &mut State,
    domain: &Domain,
    models: &Models,
    work: &mut Workspace,
    dt: f64,
    ranks: &dyn Communicator,
) {
    let Workspace { gas, tallies, timers, fault, reach, wall_poses, .. } = work;
    let time = state.clock.time();
    let gravity = models.gravity.at(time);
    let laws = ForceLaws {
        contact: &models.contact,
        at_walls: &models.at_walls,
        cohesion: models.cohesion.as_ref().map(|cohesion| cohesion.at(time)),
        ranges: Ranges { contact: models.contact_range(&state.sizes), any: reach.range },
        dt,
        limit: models.limits.force,
        force_quantum: models.force_quantum,
        torque_quantum: models.torque_quantum,
    };
    let State { particles, contacts, gas: gas_state, clock, .. } = state;
    let advanced = timers.time(Phase::Gas, || {
        let substeps = models.gas.substeps();
        if !clock.step.is_multiple_of(substeps) {
            return Ok(()); // the force of the last gas step holds
        }
        let step = GasStep { time, dt: models.time_step * substeps as f64, gravity };
        gas.advance(gas_state, particles, &step, ranks)
    });
    let before = processor_time();
    let pairs = timers.time(Phase::Contacts, || add_pair_forces(particles, contacts, &laws));
    let walls = timers.time(Phase::Walls, || {
        let walls = PosedWalls { walls: &domain.walls, poses: wall_poses };
        add_wall_forces(particles, contacts, walls, &laws, &mut tallies.on_walls)
    });
    let by_gas = timers.time(Phase::GasForce, || gas.add_forces(particles));
    timers.on_particles += processor_time() - before;
    tallies.by_gas = *by_gas.as_ref().unwrap_or(&[0; 3]);
    let message = [
        advanced.err().map(|error| error.to_string()),
        pairs.err().map(|error| error.to_string()),
        walls.err().map(|error| error.to_string()),
        by_gas.err().map(|error| error.to_string()),
    ];
    *fault = message.into_iter().flatten().next();
}
