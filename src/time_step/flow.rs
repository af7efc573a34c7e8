//! The gas in three dimensions in the step: when it moves, who owns which of its cells.

use crate::coupling::{Flow, FlowModel, FlowSolver, FlowStep, ParticleLimits};
use crate::domain::Decomposition;
use crate::parallel::{CollectiveError, Communicator, send_cells_to_owners};
use crate::particles::Particles;
use crate::state::{Domain, GasModel, Models, State, Workspace};
use nalgebra::Vector3;

/// The cut with its planes on cell faces, if a gas asks for that.
///
/// # Errors
/// If the gas has too few cells for the ranks.
pub(super) fn aligned(
    decomposition: Decomposition,
    models: &Models,
    width: f64,
) -> Result<Decomposition, CollectiveError> {
    let Some(GasModel::VolumeAveraged(model)) = &models.gas else { return Ok(decomposition) };
    model.aligned(&decomposition, width).ok_or_else(|| {
        let cells = model.grid.counts();
        CollectiveError(format!(
            "the gas's cells, {cells:?}, are too few for {} ranks",
            decomposition.grid()
        ))
    })
}

/// Brings the gas to the ranks of a new cut, begins it when it is switched on, ends it when it is switched off.
/// Collective.
///
/// Before: particles are with their owners. `old` is the cut by which the gas is spread now.
pub(super) fn settle(
    state: &mut State,
    domain: &Domain,
    models: &Models,
    work: &mut Workspace,
    old: &Decomposition,
    ranks: &dyn Communicator,
) -> Result<(), CollectiveError> {
    let Some(GasModel::VolumeAveraged(model)) = &models.gas else {
        if state.flow.take().is_some() {
            state.particles.gas_force.fill(Vector3::zeros());
        }
        work.flow = None;
        return Ok(());
    };
    if work.flow.is_some() && *old == work.decomposition {
        return Ok(());
    }
    let limits = ParticleLimits {
        diameters: [state.sizes.smallest_diameter, state.sizes.largest_diameter],
        force: models.limits.force,
        speed: models.limits.speed,
        stray: 0.5 * work.reach.skin,
    };
    let subdomain = work.decomposition.subdomain(&domain.bounds, ranks.rank());
    let solver = FlowSolver::new(model, limits, subdomain).map_err(CollectiveError)?;
    let solver = work.flow.insert(solver);
    let time = state.clock.time();
    state.flow = Some(match &state.flow {
        None => solver.at_rest(model, &state.particles, time, ranks),
        Some(flow) => {
            let old = old.subdomain(&domain.bounds, ranks.rank());
            let records = flow.records(&model.grid.local_cells(old));
            let records = send_cells_to_owners(&records, &model.grid, &work.decomposition, ranks);
            let part = model.grid.local_cells(subdomain);
            let mut flow = Flow::of_records(&part, &records, flow.report);
            solver.complete(model, &mut flow, time, ranks);
            flow
        }
    });
    Ok(())
}

/// The step of the gas, if one is due; the forces that it gives the particles hold until the next. Collective.
pub(super) fn advance(
    state: &mut State,
    model: &FlowModel,
    models: &Models,
    solver: &mut FlowSolver,
    ranks: &dyn Communicator,
) -> Result<(), String> {
    let clock = &state.clock;
    let Some(flow) = state.flow.as_mut() else { return Ok(()) };
    if !clock.step.is_multiple_of(model.substeps) {
        return Ok(());
    }
    let time = clock.time();
    let step = FlowStep {
        time,
        dt: models.time_step * model.substeps as f64,
        gravity: models.gravity.at(time),
        quantum: models.force_quantum,
    };
    solver.step(model, &mut state.particles, flow, step, ranks)
}

/// Adds the force of the gas to each owned particle; returns the sum, as counts of the force lattice.
pub(super) fn add_held_forces(particles: &mut Particles, models: &Models) -> [i64; 3] {
    let mut total = [0; 3];
    for i in 0..particles.owned_count() {
        let force = particles.gas_force[i];
        particles.forces[i].force += force;
        for axis in 0..3 {
            total[axis] += models.force_quantum.count(force[axis]);
        }
    }
    total
}
