//! The gas in a run: it advances, acts on the particles, and is read off, whichever it is.

use super::step::GasStep;
use super::volume_averaged::{VolumeAveragedModel, VolumeAveragedSolver, VolumeAveragedState};
use super::{
    ColumnSolver, ColumnState, GasError, GasForceOutOfRange, GasModel, GasReport, GasState,
    ParticleLimits,
};
use crate::coupling::NodeSums;
use crate::domain::{Decomposition, Subdomain, Wall};
use crate::numbers::Quantum;
use crate::parallel::{CellRecord, CellSample, CollectiveError, Communicator};
use crate::particles::{GAS_FORCE, Particles};
use nalgebra::Vector3;

/// The gas of the present stage on one rank. Disposable.
#[derive(Clone, Debug, Default)]
#[allow(clippy::large_enum_variant, reason = "one in a run")]
pub enum GasSolver {
    /// No gas.
    #[default]
    None,
    /// The column gas.
    Column(ColumnSolver),
    /// The volume-averaged gas.
    VolumeAveraged(VolumeAveragedSolver),
}

/// Where the gas is to be, and how it is spread over the ranks now.
#[derive(Clone, Copy, Debug)]
pub struct GasLayout<'a> {
    /// The walls that particles touch.
    pub walls: &'a [Wall],
    /// What sums over particles must have room for.
    pub limits: ParticleLimits,
    /// By which the state of the gas is spread now.
    pub before: &'a Decomposition,
    /// By which it is spread afterwards.
    pub subdomain: Subdomain<'a>,
    /// The time now.
    pub time: f64,
}

/// What is read off the gas for the time series.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GasObservables {
    /// U_s; of the volume-averaged gas its mean over the bottom; 0 without gas.
    pub superficial_velocity: f64,
    /// Pressure drop over the column; of the volume-averaged gas the mean pressure at the bottom less that at the
    /// top, hydrostatic head left out.
    pub pressure_drop: f64,
    /// Pressure of the plenum less that above the bed; 0 without a plenum.
    pub plenum_pressure: f64,
    /// How the last step went.
    pub report: GasReport,
}

impl GasSolver {
    /// Makes the gas ready on a decomposition: begins it when it is switched on, brings its cells to their owners
    /// when cut planes have moved, ends it when it is switched off. Collective.
    ///
    /// Before: particles are with their owners.
    ///
    /// # Errors
    /// If its cells are too small for how far particles may drift; the same on all ranks.
    pub fn distribute(
        &mut self,
        model: &GasModel,
        state: &mut GasState,
        particles: &mut Particles,
        layout: &GasLayout,
        ranks: &dyn Communicator,
    ) -> Result<(), CollectiveError> {
        match model {
            GasModel::None => *self = Self::None,
            GasModel::Column(gas) => {
                if !matches!(self, Self::Column(_)) {
                    let solver = ColumnSolver::new(gas, layout.subdomain.bounds, &layout.limits);
                    *self = Self::Column(solver);
                }
                if let (Self::Column(solver), GasState::Column(before)) = (&*self, &mut *state) {
                    solver.keep_what_fits(before);
                    if !before.is_empty() {
                        return Ok(());
                    }
                }
            }
            GasModel::VolumeAveraged(model) => {
                if matches!(self, Self::VolumeAveraged(_))
                    && layout.before == layout.subdomain.decomposition
                {
                    return Ok(());
                }
                let (solver, new) = volume_averaged(model, state, particles, layout, ranks)?;
                *self = Self::VolumeAveraged(solver);
                *state = GasState::VolumeAveraged(new);
                return Ok(());
            }
        }
        if *state != GasState::None {
            *state = GasState::None;
            particles.columns.at_mut(GAS_FORCE).reset();
        }
        Ok(())
    }

    /// What a column gas has to know of the particles of this rank in a step of it, to be added over the ranks; none of other gases.
    pub fn sum_bed(&mut self, particles: &Particles) -> Option<NodeSums> {
        match self {
            Self::Column(solver) => Some(solver.sum_bed(particles)),
            Self::None | Self::VolumeAveraged(_) => None,
        }
    }

    /// A step of the gas from the particles as they are now. `bed` are their sums over all ranks, if they have been found by
    /// [`GasSolver::sum_bed`] since the particles moved or changed their ranks. Collective.
    ///
    /// # Errors
    /// If the step or a force has no meaning; may differ between ranks.
    pub fn advance(
        &mut self,
        state: &mut GasState,
        particles: &mut Particles,
        bed: Option<NodeSums>,
        step: &GasStep,
        ranks: &dyn Communicator,
    ) -> Result<(), GasError> {
        match (self, state) {
            (Self::Column(solver), state) => {
                let none = ColumnState::default();
                let before = state.column().unwrap_or(&none);
                let after = solver.advance(before, (particles, bed), step, ranks)?;
                *state = if after.is_empty() { GasState::None } else { GasState::Column(after) };
                Ok(())
            }
            (Self::VolumeAveraged(solver), GasState::VolumeAveraged(state)) => {
                solver.advance(state, particles, step, ranks)
            }
            (Self::None | Self::VolumeAveraged(_), _) => Ok(()),
        }
    }

    /// Adds the force of a column gas to each owned particle; that of a volume-averaged gas, which is constant between its
    /// steps, has been added already.
    ///
    /// # Errors
    /// If a force exceeds the limit or is undefined.
    pub fn add_forces(&self, particles: &mut Particles) -> Result<(), GasForceOutOfRange> {
        match self {
            Self::None | Self::VolumeAveraged(_) => Ok(()),
            Self::Column(solver) => solver.add_forces(particles),
        }
    }

    /// The force of the gas on each owned particle in the last step.
    pub fn forces_on(&self, particles: &Particles) -> Vec<Vector3<f64>> {
        match self {
            Self::None => vec![Vector3::zeros(); particles.owned_count()],
            Self::Column(solver) => solver.forces_on(particles),
            Self::VolumeAveraged(_) => particles.columns.at(GAS_FORCE).iter().collect(),
        }
    }

    /// Whether the next step of the gas will most likely be refused as too long; the same on all ranks.
    pub fn next_is_too_long(&self) -> bool {
        matches!(self, Self::VolumeAveraged(solver) if solver.next_is_too_long())
    }

    /// The sum of these forces, in quanta of force.
    pub fn total_force(&self, particles: &Particles, quantum: Quantum) -> [i64; 3] {
        let mut total = [0; 3];
        for force in self.forces_on(particles) {
            (0..3).for_each(|axis| total[axis] += quantum.count(force[axis]));
        }
        total
    }

    /// What the time series shows. Collective.
    pub fn observables(&self, state: &GasState, ranks: &dyn Communicator) -> GasObservables {
        let (superficial_velocity, pressure_drop) = match (self, state) {
            (Self::Column(solver), _) => (solver.superficial_velocity(), solver.pressure_drop()),
            (Self::VolumeAveraged(solver), GasState::VolumeAveraged(state)) => {
                solver.flow_through(state, ranks)
            }
            (Self::None | Self::VolumeAveraged(_), _) => (0.0, 0.0),
        };
        let plenum_pressure = state.plenum().unwrap_or(0.0);
        GasObservables {
            superficial_velocity,
            pressure_drop,
            plenum_pressure,
            report: state.report(),
        }
    }

    /// What a checkpoint keeps of this rank's cells, and on rank 0 of a column gas.
    pub fn records(&self, state: &GasState, ranks: &dyn Communicator) -> Vec<CellRecord> {
        match (self, state) {
            (_, GasState::Column(state)) if ranks.is_root() => state.records(),
            (Self::VolumeAveraged(solver), GasState::VolumeAveraged(state)) => {
                solver.records(state)
            }
            (Self::None | Self::Column(_), _) | (_, GasState::None | GasState::Column(_)) => {
                Vec::new()
            }
        }
    }

    /// What snapshots show of this rank's cells; nothing of a gas without cells. Collective.
    pub fn sample(
        &mut self,
        state: &GasState,
        particles: &Particles,
        ranks: &dyn Communicator,
    ) -> Option<Vec<CellSample>> {
        match (self, state) {
            (Self::VolumeAveraged(solver), GasState::VolumeAveraged(state)) => {
                Some(solver.sample(state, particles, ranks))
            }
            (Self::None | Self::Column(_), _) | (_, GasState::None | GasState::Column(_)) => None,
        }
    }

    /// The column gas, if it is that.
    pub fn column(&self) -> Option<&ColumnSolver> {
        match self {
            Self::Column(solver) => Some(solver),
            Self::None | Self::VolumeAveraged(_) => None,
        }
    }
}

/// Solver and state of the volume-averaged gas on a new decomposition: at rest if there was none.
fn volume_averaged(
    model: &VolumeAveragedModel,
    state: &GasState,
    particles: &Particles,
    layout: &GasLayout,
    ranks: &dyn Communicator,
) -> Result<(VolumeAveragedSolver, VolumeAveragedState), CollectiveError> {
    let GasLayout { walls, limits, before, subdomain, time } = *layout;
    let solver = VolumeAveragedSolver::new(model, limits, walls, subdomain);
    let mut solver = solver.map_err(CollectiveError)?;
    let state = match state {
        GasState::None | GasState::Column(_) => solver.at_rest(particles, time, ranks),
        GasState::VolumeAveraged(state) => {
            let before = before.subdomain(subdomain.bounds, ranks.rank());
            let records = state.records(&model.grid.local_cells(before));
            let mut state =
                VolumeAveragedState::from_records(model, &records, state.report, subdomain, ranks);
            solver.fill_halos(&mut state, ranks);
            state
        }
    };
    Ok((solver, state))
}
