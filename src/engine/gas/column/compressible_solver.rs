//! The compressible column gas in a run.

use super::block::SuperficialVelocity;
use super::compressible::{ColumnCell, CompressibleStep, NodeForces};
use super::node_forces::{at_nodes, sum_by_nodes};
use super::plenum::{BedResistance, Plenum};
use super::solver::ColumnSolver;
use super::state::ColumnState;
use crate::gas::{DragCorrelation, GasForceOutOfRange, GasStep};
use crate::parallel::Communicator;
use crate::particles::Particles;

/// A compressible gas at one time.
#[derive(Clone, Copy)]
pub(super) struct Compressible {
    /// P.
    ambient: f64,
    /// Inflow at the plate or into the plenum, as volume at P.
    supply: f64,
}

impl ColumnSolver {
    /// The gas at this time, if it is compressible.
    pub(super) fn compressible(&self, time: f64) -> Option<Compressible> {
        let (ambient, supply) = (self.gas.ambient_pressure?, self.gas.supply()?.at(time));
        (!self.grid.is_periodic()).then_some(Compressible { ambient, supply })
    }

    /// The gas with the pressures of an incompressible one that flows with the present U_s. Collective.
    ///
    /// # Errors
    /// If a pressure is not above 0; the same on all ranks.
    pub(super) fn first_cells(
        &self,
        gas: Compressible,
        particles: &Particles,
        ranks: &dyn Communicator,
    ) -> Result<Vec<ColumnCell>, GasForceOutOfRange> {
        let velocities = vec![self.superficial_velocity; self.grid.nodes()];
        let forces = self.forces_around_nodes(&velocities, particles, ranks);
        self.cells(gas, &forces.pressures(&velocities), &self.voidages())
    }

    /// A step with the bed as it is deposited. Collective.
    ///
    /// # Errors
    /// If a pressure is not above 0, or the velocities do not settle; the same on all ranks.
    pub(super) fn advance_compressible(
        &mut self,
        gas: Compressible,
        before: &ColumnState,
        particles: &Particles,
        step: &GasStep,
        ranks: &dyn Communicator,
    ) -> Result<ColumnState, GasForceOutOfRange> {
        let voidages = self.voidages();
        let rate = step.dt / self.grid.spacing();
        let model = CompressibleStep::new(gas.ambient, &before.cells, &voidages, rate);
        let inflow = |forces: &NodeForces| match self.gas.plenum() {
            None => (gas.supply, None),
            Some(plenum) => {
                let bed = model.resistance(forces);
                out_of(plenum, before.plenum, gas.supply, bed, step.dt)
            }
        };
        let settled = model.settled(
            self.gas.drag.depends_on_reynolds(),
            |velocities| self.forces_around_nodes(velocities, particles, ranks),
            |forces| inflow(forces).0,
        );
        let (velocities, forces) = settled.ok_or(GasForceOutOfRange::NotSettled)?;
        let (inflow, plenum) = inflow(&forces);
        let cells = self.cells(gas, &forces.pressures(&velocities), &voidages)?;
        self.superficial_velocity = inflow;
        self.outflow = model.outflow(&velocities);
        self.between_velocities = between_nodes(&velocities);
        self.velocities = velocities;
        Ok(ColumnState { plenum, cells })
    }

    /// The gas force around the nodes, with the drag at these velocities. Collective.
    fn forces_around_nodes(
        &self,
        velocities: &[f64],
        particles: &Particles,
        ranks: &dyn Communicator,
    ) -> NodeForces {
        let quanta = [self.quantum, self.slope_quantum];
        let between = between_nodes(velocities);
        let count = particles.owned_count();
        let column = self.particles_in(SuperficialVelocity::Between(&between));
        let mut sums = sum_by_nodes(column, quanta, count, self.grid.intervals());
        sums.push(count as i64);
        ranks.sum_integers(&mut sums);
        at_nodes(&sums, &self.grid, quanta)
    }

    /// 1 - phi in the intervals: half of the solids of a node is above it and half below, but all solids are in the
    /// box.
    fn voidages(&self) -> Vec<f64> {
        let (grid, last) = (&self.grid, self.grid.nodes() - 1);
        let solids = |node: usize| {
            let part = if node == 0 || node == last { 1.0 } else { 0.5 };
            part * self.bed.solids_fraction[node] * grid.volume_of(node) / grid.cell_volume()
        };
        (0..last).map(|node| 1.0 - (solids(node) + solids(node + 1))).collect()
    }

    /// The state at the end of a step.
    fn cells(
        &self,
        gas: Compressible,
        below_nodes: &[f64],
        voidages: &[f64],
    ) -> Result<Vec<ColumnCell>, GasForceOutOfRange> {
        let ambient = gas.ambient;
        let possible = |pressure: f64| pressure.is_finite() && ambient + pressure > 0.0;
        if let Some(node) = below_nodes.iter().position(|&pressure| !possible(pressure)) {
            let (pressure, height) = (below_nodes[node], self.grid.height_of(node));
            return Err(GasForceOutOfRange::Pressure { pressure, height, ambient });
        }
        let cell = |(&pressure, &voidage)| ColumnCell { pressure, voidage };
        Ok(below_nodes[1..].iter().zip(voidages).map(cell).collect())
    }
}

/// Outflow of a plenum, and its pressure at the end of the step. The first gas flows as fast as it is supplied.
fn out_of(
    plenum: &Plenum,
    pressure: Option<f64>,
    supply: f64,
    bed: BedResistance,
    dt: f64,
) -> (f64, Option<f64>) {
    let Some(pressure) = pressure else {
        return (supply, Some(plenum.pressure_for(supply, bed)));
    };
    let outflow = plenum.outflow(pressure, supply, dt, bed);
    (outflow, Some(plenum.pressure_after(pressure, supply, outflow, dt)))
}

/// Values at the nodes, as values and changes of the intervals.
fn between_nodes(values: &[f64]) -> Vec<[f64; 2]> {
    values.windows(2).map(|pair| [pair[0], pair[1] - pair[0]]).collect()
}
