//! One step of gas and particles together.

use super::{CellCoupling, CouplingModel, ParticleLimits};
use crate::domain::{Decomposition, Subdomain};
use crate::gas::volume_averaged::{
    GAS_HALO, GasReport, GasSolver, GasState, GasStep, VolumeAveragedGas,
};
use crate::grid::{BoxGrid, LocalCells};
use crate::numbers::Quantum;
use crate::parallel::{CellRecord, Communicator};
use crate::particles::Particles;
use nalgebra::Vector3;

/// A gas in three dimensions and how it meets the particles, as the case chose it.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowModel {
    /// Its cells.
    pub grid: BoxGrid,
    /// What it is made of, and what happens at the faces of the box.
    pub gas: VolumeAveragedGas,
    /// How particles and gas see each other.
    pub coupling: CouplingModel,
    /// Steps of the particles in one of the gas.
    pub substeps: u64,
    /// Driving force per volume of gas, for boxes through which nothing else moves it.
    pub driving: Vector3<f64>,
}

impl FlowModel {
    /// A cut with its planes on cell faces, blocks being at least `width` and two cells wide; none if there are
    /// too few cells.
    pub fn aligned(&self, decomposition: &Decomposition, width: f64) -> Option<Decomposition> {
        let cut_axes = (0..3).filter(|&axis| decomposition.grid().0[axis] > 1);
        let cells = cut_axes.map(|axis| (width / self.grid.spacing()[axis]).ceil() as usize);
        self.grid.aligned(decomposition, cells.max().unwrap_or(0).max(GAS_HALO))
    }
}

/// The gas on a rank's cells, and how its last step went. Part of the state.
#[derive(Clone, Debug, PartialEq)]
pub struct Flow {
    /// Velocity, pressure, voidage.
    pub fields: GasState,
    /// The last step, over all ranks.
    pub report: FlowReport,
}

/// How a step of gas and particles went, over all ranks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FlowReport {
    /// Iterations of the pressure equation.
    pub iterations: u64,
    /// Cells whose voidage was raised to the least one.
    pub raised_cells: u64,
    /// Courant number.
    pub courant: f64,
    /// Largest component of the force on particles less what the gas loses at its faces.
    pub momentum_error: f64,
}

/// When and in what a step is done.
#[derive(Clone, Copy, Debug)]
pub struct FlowStep {
    /// Time at its beginning.
    pub time: f64,
    /// Its length.
    pub dt: f64,
    /// Downward acceleration.
    pub gravity: f64,
    /// Lattice of forces.
    pub quantum: Quantum,
}

/// Gas and particles at work on one rank's cells. Disposable.
#[derive(Clone, Debug)]
pub struct FlowSolver {
    coupling: CellCoupling,
    solver: GasSolver,
}

impl FlowSolver {
    /// For a cut whose planes lie on cell faces.
    ///
    /// # Errors
    /// If cells are too small for how far particles may stray.
    pub fn new(
        model: &FlowModel,
        limits: ParticleLimits,
        subdomain: Subdomain,
    ) -> Result<Self, String> {
        let coupling = CellCoupling::new(&model.coupling, limits, &model.grid, subdomain)?;
        let solver = GasSolver::new(&model.grid, subdomain);
        Ok(Self { coupling, solver })
    }

    /// Gas at rest between the particles. Collective.
    pub fn at_rest(
        &mut self,
        model: &FlowModel,
        particles: &Particles,
        time: f64,
        ranks: &dyn Communicator,
    ) -> Flow {
        let mut fields = GasState::at_rest(self.solver.part());
        fields.voidage = self.coupling.observe_voidage(particles, ranks).clone();
        let mut flow = Flow { fields, report: FlowReport::default() };
        self.complete(model, &mut flow, time, ranks);
        flow
    }

    /// Fills what the gas needs beyond owned cells. Collective.
    pub fn complete(
        &mut self,
        model: &FlowModel,
        flow: &mut Flow,
        time: f64,
        ranks: &dyn Communicator,
    ) {
        self.solver.complete(&model.gas, &mut flow.fields, time, ranks);
    }

    /// A step of the gas, and the forces on particles until the next. Collective.
    ///
    /// The gas meets the particles where and as fast as they are now; its drag is implicit in its own velocity.
    /// The forces follow from its new velocity and pressure, so that particles gain what the gas loses.
    ///
    /// # Errors
    /// In words, if a step or a force has no meaning; may differ between ranks.
    pub fn step(
        &mut self,
        model: &FlowModel,
        particles: &mut Particles,
        flow: &mut Flow,
        step: FlowStep,
        ranks: &dyn Communicator,
    ) -> Result<(), String> {
        let FlowStep { time, dt, gravity, quantum } = step;
        let observed = self.coupling.observe(particles, &flow.fields, dt, ranks);
        let gas_step = GasStep { time, dt, driving: model.driving, source: None };
        let bed = self.coupling.bed_mut();
        let GasReport { courant, convergence, .. } = self
            .solver
            .advance(&model.gas, &mut flow.fields, bed, &gas_step, ranks)
            .map_err(|error| error.to_string())?;
        let pressed = self.coupling.press(particles, &flow.fields, (gravity, quantum), ranks);
        let momentum_error = self.coupling.momentum_error(quantum, ranks);
        let before = flow.report.raised_cells;
        let raised_cells = ranks.total(self.coupling.raised_cells() as usize) as u64;
        if raised_cells > 0 && before == 0 && ranks.is_root() {
            log::warn!(
                "time {time}: the voidage of {raised_cells} cells was below gas.least_voidage and was raised to it \
                 (column raised_cells)"
            );
        }
        let iterations = convergence.iterations as u64;
        flow.report = FlowReport { iterations, raised_cells, courant, momentum_error };
        observed.and(pressed).map_err(|error| error.to_string())
    }
}

impl FlowSolver {
    /// What snapshots show of each owned cell: pressure, mean velocity of the gas at its faces, voidage, mean
    /// velocity of the solids by volume. Collective.
    pub fn picture(
        &mut self,
        particles: &Particles,
        flow: &Flow,
        ranks: &dyn Communicator,
    ) -> Vec<CellRecord> {
        let [x, y, z] = &self.coupling.solids_velocity(particles, ranks);
        let GasState { velocity, pressure, voidage } = &flow.fields;
        let part = self.coupling.part();
        let picture = |cell: [isize; 3]| {
            let mean = |axis: usize| {
                let mut above = cell;
                above[axis] += 1;
                0.5 * (velocity[axis].at(cell) + velocity[axis].at(above))
            };
            let solids = [x, y, z].map(|field| field.at(cell));
            let [p, eps] = [pressure, voidage].map(|field| field.at(cell));
            [p, mean(0), mean(1), mean(2), eps, solids[0], solids[1], solids[2]]
        };
        cells_of(part).map(|cell| CellRecord::new(part, cell, picture(cell))).collect()
    }
}

/// The owned cells of a part, x fastest.
fn cells_of(part: &LocalCells) -> impl Iterator<Item = [isize; 3]> + use<> {
    let [nx, ny, nz] = part.count.map(|count| count as isize);
    (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])))
}

impl Flow {
    /// From records of the owned cells of a part; to be completed before the next step.
    pub fn of_records(part: &LocalCells, records: &[CellRecord], report: FlowReport) -> Self {
        let mut fields = GasState::at_rest(part);
        for record in records {
            fields.restore(record.place_in(part), &record.numbers);
        }
        Self { fields, report }
    }

    /// Records of the owned cells of a part.
    pub fn records(&self, part: &LocalCells) -> Vec<CellRecord> {
        cells_of(part).map(|cell| CellRecord::new(part, cell, self.fields.record(cell))).collect()
    }
}
