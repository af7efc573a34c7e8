//! New lists: particles are sent to their owners, and ghosts and neighbours are found again; the histories of contacts
//! move with the particles.

use super::energy::add_departure;
use crate::contact::find_mesh_contacts;
use crate::domain::{Bounds, Decomposition, Face, PosedWalls};
use crate::gas::{GasLayout, ParticleLimits};
use crate::numbers::ExactSum;
use crate::parallel::{CollectiveError, Communicator, agree, migrate, share_with_all};
use crate::particles::{ContactHistories, Particles};
use crate::state::{Domain, Models, State, Workspace};
use std::collections::HashSet;

/// Discards the lists and makes new ones; the histories of contacts are kept. Collective.
///
/// # Errors
/// If a particle is too fast, or the program loses a contact.
pub(super) fn rebuild(
    state: &mut State,
    domain: &Domain,
    models: &Models,
    work: &mut Workspace,
    ranks: &dyn Communicator,
) -> Result<(), CollectiveError> {
    work.check_loads(true, state, &domain.bounds, ranks);
    let histories = state.contacts.histories(&state.particles);
    state.particles.drop_ghosts();
    check_speeds(&state.particles, models.limits.speed, ranks)?;
    arrange(state, domain, models, work, histories, ranks)
}

/// Makes lists and ghosts of owned particles, wherever they are. Collective.
///
/// Before: there are no ghosts. After: each particle is on its owner; lists, ghosts and the gas's cells are those of
/// the present positions.
///
/// # Errors
/// If the program loses a contact, or the gas cannot be divided among the ranks.
pub(super) fn arrange(
    state: &mut State,
    domain: &Domain,
    models: &Models,
    work: &mut Workspace,
    mut histories: ContactHistories,
    ranks: &dyn Communicator,
) -> Result<(), CollectiveError> {
    let before = work.decomposition.clone();
    remove_departed(state, domain, &mut histories, ranks);
    wrap_positions(&mut state.particles, &mut histories, &domain.bounds);
    if let Some(planned) = work.balance.take_plan() {
        work.decomposition = planned;
    }
    work.decomposition = models.physics.gas.align(&work.decomposition, work.least_width)?;
    choose_skin(state, domain, models, work);
    migrate(&mut state.particles, &mut histories, &work.decomposition, ranks);
    rebuild_lists(state, domain, work, &histories, ranks)?;
    distribute_gas(state, domain, models, work, &before, ranks)
}

/// Chooses the skin from the speeds since the lists were last made; the narrowest if these are not known.
fn choose_skin(state: &State, domain: &Domain, models: &Models, work: &mut Workspace) {
    let ghosts = room_for_ghosts(&work.decomposition, &domain.bounds);
    let bare = state.sizes.largest_diameter + work.list_range.interaction;
    let room = (ghosts - bare).min(2.0 * models.physics.gas.reach());
    let cheapest = |displacement| work.skin.cheapest(displacement, room);
    let displacement = work.neighbours.displacement_in_a_step();
    work.list_range.skin = displacement.map_or(work.skin.narrowest(), cheapest);
}

/// Largest width of a ghost layer such that two layers fit into the narrowest subdomain. In a periodic box a particle
/// then has only one image, and ranks with small subdomains have no more ghosts than particles.
fn room_for_ghosts(decomposition: &Decomposition, bounds: &Bounds) -> f64 {
    let has_ghosts = |axis: &usize| bounds.is_periodic(*axis) || decomposition.grid().0[*axis] > 1;
    let narrowest = (0..3).filter(has_ghosts).map(|axis| decomposition.narrowest(axis));
    0.499 * narrowest.fold(f64::INFINITY, f64::min)
}

/// Brings positions back into the box along periodic axes.
fn wrap_positions(particles: &mut Particles, histories: &mut ContactHistories, bounds: &Bounds) {
    let of_particles = particles.body.iter_mut().map(|body| &mut body.position);
    let of_partners = histories.partners.iter_mut().map(|(_, position)| position);
    for position in of_particles.chain(of_partners) {
        *position = bounds.wrap(*position);
    }
}

/// Sorts owned particles by cells, makes ghosts, finds neighbours, and puts the histories of contacts into their
/// places. Collective.
fn rebuild_lists(
    state: &mut State,
    domain: &Domain,
    work: &mut Workspace,
    histories: &ContactHistories,
    ranks: &dyn Communicator,
) -> Result<(), CollectiveError> {
    let State { particles, contacts, sizes, .. } = state;
    let (bounds, width) = (&domain.bounds, work.list_range.ghost_width(sizes.largest_diameter));
    work.neighbours.sort_by_cells(particles, width);
    work.neighbours.measure_clearance(bounds);
    let subdomain = work.decomposition.subdomain(bounds, ranks.rank());
    work.halo.make_ghosts(particles, subdomain, width, ranks);
    let walls = PosedWalls { walls: &domain.walls, poses: &work.wall_poses };
    let rebuilt = work.neighbours.rebuild(particles, contacts, walls, work.list_range, histories);
    agree(rebuilt, ranks)?;
    find_mesh_contacts(particles, contacts, walls, work.list_range.interaction);
    let are_partners = contacts.are_partners(particles);
    work.halo.follow(particles, |ghost| are_partners[ghost], ranks);
    Ok(())
}

/// Takes particles beyond open faces out of the run, with the histories of their contacts. Collective.
fn remove_departed(
    state: &mut State,
    domain: &Domain,
    histories: &mut ContactHistories,
    ranks: &dyn Communicator,
) {
    let particles = &mut state.particles;
    let is_outside =
        |i: u32| domain.bounds.passed(Face::Open, &particles.body[i as usize].position).is_some();
    let (leaving, staying): (Vec<u32>, Vec<u32>) =
        (0..particles.owned_count() as u32).partition(|&i| is_outside(i));
    if !ranks.any(!leaving.is_empty()) {
        return;
    }
    if let Some(ledger) = &mut state.energy {
        leaving.iter().for_each(|&i| add_departure(ledger, particles, i as usize));
    }
    let ids: Vec<u64> = leaving.iter().map(|&i| particles.id[i as usize]).collect();
    let mut volume = ExactSum::default();
    leaving.iter().for_each(|&i| volume.add(particles.volume(i as usize)));
    let mut integers = volume.to_integers();
    ranks.sum_integers(&mut integers);
    let departed: HashSet<u64> = share_with_all(ids, ranks).into_iter().collect();
    state.departed.count += departed.len() as u64;
    state.departed.volume += ExactSum::from_integers(&integers).value();
    histories.retain_particles(|id| !departed.contains(&id));
    particles.select(&staying);
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
        walls: &domain.walls,
        limits: ParticleLimits {
            diameters: [state.sizes.smallest_diameter, state.sizes.largest_diameter],
            force: models.limits.force,
            force_quantum: models.force_quantum,
            speed: models.limits.speed,
            drift: 0.5 * work.list_range.skin,
        },
        before,
        subdomain: work.decomposition.subdomain(&domain.bounds, ranks.rank()),
        time: state.clock.time(),
    };
    let State { particles, gas, .. } = state;
    work.gas.distribute(&models.physics.gas, gas, particles, &layout, ranks)
}

/// Checks the speeds: a particle that moves more than a tenth of the smallest diameter in one step could pass through
/// others.
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
