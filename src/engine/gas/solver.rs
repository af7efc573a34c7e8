//! The gas in a run, of any kind: it advances, acts on the particles, and provides results.

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

/// The gas of the present stage on one rank. It is not part of the state of a run.
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

/// Surroundings of the gas, and its present and future distribution over the ranks.
#[derive(Clone, Copy, Debug)]
pub struct GasLayout<'a> {
    /// The walls that particles touch.
    pub walls: &'a [Wall],
    /// Bounds for which sums over particles must have room.
    pub limits: ParticleLimits,
    /// Present decomposition of the state of the gas.
    pub before: &'a Decomposition,
    /// Future subdomain of this rank.
    pub subdomain: Subdomain<'a>,
    /// The time now.
    pub time: f64,
}

/// Values of the gas for the time series.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GasObservables {
    /// U_s; for the volume-averaged gas its mean over the bottom; 0 without gas.
    pub superficial_velocity: f64,
    /// Pressure drop over the column; for the volume-averaged gas the mean pressure at the bottom less that at the top,
    /// without the hydrostatic head.
    pub pressure_drop: f64,
    /// Pressure of the plenum less that above the bed; 0 without a plenum.
    pub plenum_pressure: f64,
    /// Report on the last step.
    pub report: GasReport,
}

impl GasSolver {
    /// Prepares the gas for a decomposition: starts it when it is switched on, sends its cells to their owners when cut
    /// planes have moved, and ends it when it is switched off. Collective.
    ///
    /// Before: particles are with their owners.
    ///
    /// # Errors
    /// If its cells are too small for the distance that particles may drift; the same error on all ranks.
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

    /// Sums over the particles of this rank that a step of a column gas needs, to be added over the ranks; `None` for
    /// other gases.
    pub fn sum_bed(&mut self, particles: &Particles) -> Option<NodeSums> {
        match self {
            Self::Column(solver) => Some(solver.sum_bed(particles)),
            Self::None | Self::VolumeAveraged(_) => None,
        }
    }

    /// Advances the gas by a step with the present particles. `bed` are their sums over all ranks, if these have been
    /// found by [`GasSolver::sum_bed`] since the particles moved or changed their ranks. Collective.
    ///
    /// # Errors
    /// If the step is not possible or a force exceeds its limit; may differ between ranks.
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

    /// Adds the force of a column gas to each owned particle; that of a volume-averaged gas, which is constant between
    /// its steps, has been added already.
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

    /// Whether the next step of the gas will most likely be refused as too long; equal on all ranks.
    pub fn next_is_too_long(&self) -> bool {
        matches!(self, Self::VolumeAveraged(solver) if solver.next_is_too_long())
    }

    /// The sum of the forces of [`GasSolver::forces_on`], in quanta of force.
    pub fn total_force(&self, particles: &Particles, quantum: Quantum) -> [i64; 3] {
        let mut total = [0; 3];
        for force in self.forces_on(particles) {
            (0..3).for_each(|axis| total[axis] += quantum.count(force[axis]));
        }
        total
    }

    /// Values for the time series. Collective.
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

    /// Records for a checkpoint: this rank's cells, and on rank 0 those of a column gas.
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

    /// Records for snapshots of this rank's cells; none for a gas without cells. Collective.
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

    /// The column gas, if the gas is of this kind.
    pub fn column(&self) -> Option<&ColumnSolver> {
        match self {
            Self::Column(solver) => Some(solver),
            Self::None | Self::VolumeAveraged(_) => None,
        }
    }
}

/// Solver and state of the volume-averaged gas on a new decomposition; the gas is at rest if there was none.
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
