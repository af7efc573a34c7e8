//! One step of the gas, coupled to the particles.

use super::exchange::ParticleExchange;
use super::navier_stokes::{NavierStokesReport, NavierStokesSolver, NavierStokesStep};
use super::{GasFields, VolumeAveragedModel, VolumeAveragedState};
use crate::domain::{Subdomain, Wall};
use crate::gas::{GasError, GasReport, GasStep, ParticleLimits};
use crate::grid::Field;
use crate::numbers::ExactSum;
use crate::parallel::{CellRecord, CellSample, Communicator};
use crate::particles::Particles;

/// The gas and its coupling to the particles on one rank's cells. It is not part of the state of a run.
#[derive(Clone, Debug)]
pub struct VolumeAveragedSolver {
    model: VolumeAveragedModel,
    exchange: ParticleExchange,
    equations: NavierStokesSolver,
    next_is_too_long: bool,
}

impl VolumeAveragedSolver {
    /// A solver for a decomposition whose cut planes lie on cell faces, with the walls that particles touch.
    ///
    /// # Errors
    /// If cells are too small for the distance that particles may drift, or a wall in a face of the box moves out of
    /// its plane; the same error on all ranks.
    pub fn new(
        model: &VolumeAveragedModel,
        limits: ParticleLimits,
        walls: &[Wall],
        subdomain: Subdomain,
    ) -> Result<Self, String> {
        let mut model = model.clone();
        model.gas = model.gas.with_walls(subdomain.bounds, walls);
        model.gas.check(&model.grid)?;
        let (grid, column) = (&model.grid, model.column.as_ref());
        let exchange = ParticleExchange::new(&model.coupling, limits, (grid, column), subdomain)?;
        let mut equations = NavierStokesSolver::new(grid, subdomain);
        if let Some(column) = column {
            equations = equations.in_column(grid, column, model.gas.viscosity);
        }
        Ok(Self { model, exchange, equations, next_is_too_long: false })
    }

    /// Gas at rest between the particles. Collective.
    pub fn at_rest(
        &mut self,
        particles: &Particles,
        time: f64,
        ranks: &dyn Communicator,
    ) -> VolumeAveragedState {
        let mut fields = GasFields::at_rest(self.equations.part());
        self.exchange.deposit_volume(particles, ranks);
        fields.voidage = self.exchange.bed().voidage.clone();
        self.equations.complete(&self.model.gas, &mut fields, time, ranks);
        VolumeAveragedState { fields, report: GasReport::default() }
    }

    /// Fills the halos of a state whose cells have come from a checkpoint or from other ranks. Collective.
    pub fn fill_halos(&mut self, state: &mut VolumeAveragedState, ranks: &dyn Communicator) {
        self.equations.fill_halos(&self.model.gas, &mut state.fields, ranks);
    }

    /// Advances the gas by a step, and sets the forces on particles until the next one. Collective.
    ///
    /// The gas step uses the present positions and velocities of the particles; its drag is implicit in its own
    /// velocity. The forces follow from its new velocity and pressure, so that particles gain the momentum that the gas
    /// loses.
    ///
    /// # Errors
    /// If the step is not possible or a force exceeds its limit; may differ between ranks.
    pub fn advance(
        &mut self,
        state: &mut VolumeAveragedState,
        particles: &mut Particles,
        step: &GasStep,
        ranks: &dyn Communicator,
    ) -> Result<(), GasError> {
        let &GasStep { time, dt, gravity } = step;
        let (gas, fields) = (&self.model.gas, &mut state.fields);
        let deposited = self.exchange.deposit(particles, fields, dt, ranks);
        let step = NavierStokesStep { time, dt, driving: self.model.driving, source: None };
        let bed = &mut self.exchange.bed;
        let solved = self.equations.advance(gas, fields, bed, &step, ranks)?;
        let forces = self.exchange.set_forces(particles, fields, gravity, ranks);
        self.next_is_too_long = self.equations.next_is_too_long(fields, &solved, dt, ranks);
        self.update_report(&mut state.report, &solved, time, ranks);
        Ok(deposited.and(forces)?)
    }

    /// Updates the report on the step, over all ranks. Collective.
    fn update_report(
        &self,
        report: &mut GasReport,
        solved: &NavierStokesReport,
        time: f64,
        ranks: &dyn Communicator,
    ) {
        let momentum_error = self.exchange.momentum_error(ranks);
        let before = report.raised_cells;
        let raised_cells = ranks.total(self.exchange.raised_cells() as usize) as u64;
        if raised_cells > 0 && before == 0 && ranks.is_root() {
            log::warn!(
                "time {time}: the voidage of {raised_cells} cells was below gas.least_voidage and was raised to it \
                 (column raised_cells)"
            );
        }
        let iterations = solved.convergence.iterations as u64;
        *report = GasReport { iterations, raised_cells, courant: solved.courant, momentum_error };
    }

    /// Whether the next step will be refused as too long if the voidage does not change; equal on all ranks.
    pub fn next_is_too_long(&self) -> bool {
        self.next_is_too_long
    }

    /// Superficial velocity through the bottom, and pressure drop from bottom to top, without the hydrostatic head. In
    /// a periodic box both faces coincide, and the drop is the one that the driving force compensates. Collective.
    pub fn flow_through(
        &self,
        state: &VolumeAveragedState,
        ranks: &dyn Communicator,
    ) -> (f64, f64) {
        let part = self.equations.part();
        let [nx, ny, nz] = part.count.map(|count| count as isize);
        let [at_bottom, at_top] = part.at_ends(2);
        let columns = || (0..ny).flat_map(move |j| (0..nx).map(move |i| (i, j)));
        let mut sums = [(); 2].map(|()| ExactSum::default());
        let fields = &state.fields;
        let mean = |field: &Field, [i, j, k]: [isize; 3]| {
            0.5 * (field.at([i, j, k - 1]) + field.at([i, j, k]))
        };
        for (i, j) in columns().filter(|_| at_bottom) {
            let (face, open) = ([i, j, 0], self.open_fraction([i, j, 0]));
            sums[0].add(open * (mean(&fields.voidage, face) * fields.velocity[2].at(face)));
            sums[1].add(open * mean(&fields.pressure, face));
        }
        for (i, j) in columns().filter(|_| at_top) {
            sums[1].add(-(self.open_fraction([i, j, 0]) * mean(&fields.pressure, [i, j, nz])));
        }
        let mut integers: Vec<i64> = sums.iter().flat_map(ExactSum::to_integers).collect();
        ranks.sum_integers(&mut integers);
        let mut totals = integers.chunks(ExactSum::INTEGERS).map(ExactSum::from_integers);
        let faces = match &self.model.column {
            None => (part.counts[0] * part.counts[1]) as f64,
            Some(column) => column.cross_section_in_cells(),
        };
        let mut total = || totals.next().map_or(0.0, |sum| sum.value()) / faces;
        let (velocity, drop) = (total(), total());
        let driven = self.model.driving.z * self.model.grid.spacing().z * part.counts[2] as f64;
        (velocity, drop + driven)
    }

    /// Open fraction of a cell: less than 1 outside and at the wall of a round column.
    fn open_fraction(&self, [i, j, _]: [isize; 3]) -> f64 {
        let (part, column) = (self.equations.part(), self.model.column.as_ref());
        column.map_or(1.0, |column| column.open_fraction_in(part, [i, j]))
    }

    /// Values of each owned cell for snapshots. Collective.
    pub fn sample(
        &mut self,
        state: &VolumeAveragedState,
        particles: &Particles,
        ranks: &dyn Communicator,
    ) -> Vec<CellSample> {
        let solids = &self.exchange.solids_velocity(particles, ranks);
        let GasFields { velocity, pressure, voidage } = &state.fields;
        let part = self.exchange.part();
        let mean = |axis: usize, cell: [isize; 3]| {
            let mut above = cell;
            above[axis] += 1;
            0.5 * (velocity[axis].at(cell) + velocity[axis].at(above))
        };
        // Pressure and voidage of closed cells mean nothing.
        let if_open = |field: &Field, cell: [isize; 3]| {
            if self.open_fraction(cell) > 0.0 { field.at(cell) } else { 0.0 }
        };
        let sample = |cell: [isize; 3]| CellSample {
            cell: part.number_of(cell),
            pressure: if_open(pressure, cell),
            velocity: std::array::from_fn(|axis| mean(axis, cell)),
            voidage: if_open(voidage, cell),
            open_fraction: self.open_fraction(cell),
            solids_velocity: std::array::from_fn(|axis| solids[axis].at(cell)),
        };
        part.owned().map(sample).collect()
    }

    /// Records of the gas in the owned cells.
    pub fn records(&self, state: &VolumeAveragedState) -> Vec<CellRecord> {
        state.records(self.equations.part())
    }
}
