//! The column gas in a run: superficial velocity and force on particles, Moon 2006 eqs (11), (12) and (18).

use super::block::{ParticlesInColumn, SuperficialVelocity, add_forces, sum_slopes};
use super::model::{ColumnFields, ColumnGas, Drive, WeightBalance};
use super::plenum::{BedResistance, Plenum};
use super::state::ColumnState;
use crate::coupling::{Bed, ColumnDeposition, NodeSums, interval_fields};
use crate::domain::Bounds;
use crate::gas::{DragCorrelation, GasForceOutOfRange, GasStep, ParticleLimits};
use crate::grid::ColumnGrid;
use crate::numbers::Quantum;
use crate::parallel::Communicator;
use crate::particles::{ForceTorque, Particles};
use nalgebra::Vector3;

/// Largest number of iterations for the superficial velocity of a weight-carrying gas; 5 to 10 are usual.
const MOST_ITERATIONS: usize = 100;

/// The column gas in a run: its grid, the bed on it, and the present superficial velocity. It is not part
/// of the state of a run.
#[derive(Clone, Debug)]
pub struct ColumnSolver {
    pub(super) gas: ColumnGas,
    pub(super) grid: ColumnGrid,
    deposition: ColumnDeposition,
    pub(super) bed: Bed,
    pub(super) superficial_velocity: f64,
    /// U at the nodes of a compressible gas; empty if it is `superficial_velocity` at all heights.
    pub(super) velocities: Vec<f64>,
    /// U between the nodes.
    pub(super) between_velocities: Vec<[f64; 2]>,
    /// Outflow above.
    pub(super) outflow: f64,
    pub(super) quantum: Quantum,
    pub(super) slope_quantum: Quantum,
    limit: f64,
    /// The bed between nodes: phi and u_s; then, only if sizes differ, diameters per volume and u_d.
    between_nodes: [Vec<[f64; 4]>; 2],
}

/// The gas force on all particles: `at_rest` + `slope` U_s.
#[derive(Clone, Copy, Debug)]
struct BedForce {
    at_rest: f64,
    slope: f64,
    /// Number of particles.
    particles: f64,
}

impl BedForce {
    fn per(self, area: f64) -> BedResistance {
        BedResistance { at_rest: self.at_rest / area, slope: self.slope / area }
    }
}

impl ColumnSolver {
    /// A solver for a gas in a box, and particles within limits.
    pub fn new(gas: &ColumnGas, bounds: &Bounds, limits: &ParticleLimits) -> Self {
        let grid = gas.grid(bounds);
        // The quantum of drag per velocity, with room for the densest beds at the creeping speeds of fine powders.
        let slope_quantum = Quantum::spanning(1024.0 * limits.force / limits.speed);
        Self {
            deposition: ColumnDeposition::new(
                &grid,
                limits.speed,
                limits.diameters,
                gas.drag_share,
            ),
            gas: gas.clone(),
            grid,
            bed: Bed::default(),
            superficial_velocity: 0.0,
            velocities: Vec::new(),
            between_velocities: Vec::new(),
            outflow: 0.0,
            quantum: limits.force_quantum,
            slope_quantum,
            limit: limits.force,
            between_nodes: Default::default(),
        }
    }

    /// The grid.
    pub fn grid(&self) -> &ColumnGrid {
        &self.grid
    }

    /// The bed on the grid, at the last [`ColumnSolver::advance`].
    pub fn bed(&self) -> &Bed {
        &self.bed
    }

    /// U_s, volume of gas per area and time relative to the frame of the box; for a compressible gas the inflow at the
    /// plate, as volume at the pressure above the bed.
    pub fn superficial_velocity(&self) -> f64 {
        self.superficial_velocity
    }

    /// Outflow above, as volume at the pressure there; it differs from U_s only for a compressible gas.
    pub fn outflow(&self) -> f64 {
        self.outflow
    }

    /// Keeps the parts of a state that fit this gas: not the plenum of another stage, nor cells of another grid.
    pub(in crate::gas) fn keep_what_fits(&self, state: &mut ColumnState) {
        if self.gas.plenum().is_none() {
            state.plenum = None;
        }
        if self.compressible(0.0).is_none() || state.cells.len() != self.grid.intervals() {
            state.cells.clear();
        }
    }

    /// Contributions of the particles of this rank to the nodes of the grid; their sums over the ranks are an argument
    /// of [`ColumnSolver::advance`].
    pub(in crate::gas) fn sum_bed(&mut self, particles: &Particles) -> NodeSums {
        self.deposition.sum_own(particles, &self.grid)
    }

    /// Sets the superficial velocity at a time, for the present bed, whose sums over all ranks are computed first if
    /// they are not given. `before` is the state at the beginning of the step, empty if the gas has just been turned
    /// on. Returns the state at the end of the step, which is empty for a gas that needs none. The first step of a
    /// compressible gas is that of an incompressible one, whose pressures it then takes over. Collective.
    ///
    /// # Errors
    /// If no velocity carries the weight, or the pressure is not above 0; the same error on all ranks.
    pub fn advance(
        &mut self,
        before: &ColumnState,
        (particles, sums): (&Particles, Option<NodeSums>),
        step: &GasStep,
        ranks: &dyn Communicator,
    ) -> Result<ColumnState, GasForceOutOfRange> {
        self.deposit(particles, sums, ranks);
        let compressible = self.compressible(step.time);
        if let Some(gas) = compressible
            && !before.cells.is_empty()
        {
            return self.advance_compressible(gas, before, particles, step, ranks);
        }
        let (velocity, plenum) = self.uniform_velocity(before.plenum, particles, step, ranks)?;
        self.superficial_velocity = velocity;
        self.outflow = velocity;
        self.velocities.clear();
        let cells = match compressible {
            Some(gas) => self.first_cells(gas, particles, ranks)?,
            None => Vec::new(),
        };
        Ok(ColumnState { plenum, cells })
    }

    /// U_s of an incompressible gas, and the pressure of its plenum at the end of the step. Collective.
    fn uniform_velocity(
        &self,
        plenum: Option<f64>,
        particles: &Particles,
        step: &GasStep,
        ranks: &dyn Communicator,
    ) -> Result<(f64, Option<f64>), GasForceOutOfRange> {
        match &self.gas.drive {
            Drive::Velocity(schedule) => Ok((schedule.at(step.time), None)),
            Drive::Plenum(model) => {
                let (velocity, after) = self.through(model, plenum, particles, step, ranks)?;
                Ok((velocity, Some(after)))
            }
            Drive::Weight(balance) => {
                let weight = self.weight_of(particles, step.gravity, ranks);
                let velocity = match balance {
                    WeightBalance::ParticleForce => {
                        self.velocity_by_particle_force(particles, weight, ranks)?
                    }
                    WeightBalance::GridIntegral => self.velocity_by_grid_integral(weight)?,
                };
                Ok((velocity, None))
            }
        }
    }

    /// U_s from a plenum, and the pressure of the plenum after the step. The first gas flows as fast as it is supplied.
    /// Collective.
    fn through(
        &self,
        plenum: &Plenum,
        pressure: Option<f64>,
        particles: &Particles,
        step: &GasStep,
        ranks: &dyn Communicator,
    ) -> Result<(f64, f64), GasForceOutOfRange> {
        let supply = plenum.supply.at(step.time);
        let area = self.cross_section();
        let Some(pressure) = pressure else {
            let bed = self.force_on_bed(supply, particles, ranks).per(area);
            return Ok((supply, plenum.pressure_for(supply, bed)));
        };
        let velocity = self.velocity_by(particles, pressure * area, ranks, |bed| {
            plenum.outflow(pressure, supply, step.dt, bed.per(area))
        })?;
        Ok((velocity, plenum.pressure_after(pressure, supply, velocity, step.dt)))
    }

    /// Computes phi and u_s of the present bed.
    fn deposit(&mut self, particles: &Particles, sums: Option<NodeSums>, ranks: &dyn Communicator) {
        let Self { deposition, grid, bed, .. } = self;
        match sums {
            Some(sums) => deposition.fill(bed, grid, &sums),
            None => deposition.deposit(particles, grid, bed, ranks),
        }
        let Bed { solids_fraction, solids_velocity, share_density, drag_velocity } = &self.bed;
        let [of_volume, of_diameter] = &mut self.between_nodes;
        interval_fields(&self.grid, [solids_fraction, solids_velocity], of_volume);
        if self.deposition.sizes_differ() {
            interval_fields(&self.grid, [share_density, drag_velocity], of_diameter);
        }
    }

    /// The particles, in a gas with this superficial velocity.
    pub(super) fn particles_in<'a>(
        &'a self,
        superficial_velocity: SuperficialVelocity<'a>,
    ) -> ParticlesInColumn<'a> {
        ParticlesInColumn {
            blocks: self.deposition.blocks(),
            between_nodes: &self.between_nodes,
            drag: self.gas.particle_drag(),
            superficial_velocity,
        }
    }

    /// Adds the gas force to each owned particle, at the position and velocity with which it was deposited.
    ///
    /// F = (V / phi) beta (u_g - v) - V dp/dz upwards, with u_g = u_s + (U_s - u_s) / (1 - phi) and
    /// -dp/dz = B (u_g - u_d) / (1 - phi), where B is the drag of all particles per volume; laterally -(V / phi) beta v
    /// if the gas has lateral drag. For particles of one size B = beta, u_d = u_s, and this is Moon 2006 eq. (12),
    /// F = (V / phi) beta [ (u_s - v) - (u_s - U_s) / (1 - phi)^2 ].
    ///
    /// # Errors
    /// If a force exceeds the limit or is undefined.
    pub fn add_forces(&self, particles: &mut Particles) -> Result<(), GasForceOutOfRange> {
        let owned = particles.owned_count();
        self.add_to(&mut particles.forces[..owned], &particles.id)
    }

    /// The gas force on each owned particle in the last step.
    pub fn forces_on(&self, particles: &Particles) -> Vec<Vector3<f64>> {
        let mut loads = vec![ForceTorque::default(); particles.owned_count()];
        // If a force is out of range, the step itself has already ended the run.
        let _ = self.add_to(&mut loads, &particles.id);
        loads.into_iter().map(|load| load.force).collect()
    }

    fn add_to(&self, loads: &mut [ForceTorque], ids: &[u64]) -> Result<(), GasForceOutOfRange> {
        let column = self.particles_in(if self.velocities.is_empty() {
            SuperficialVelocity::Uniform(self.superficial_velocity)
        } else {
            SuperficialVelocity::Between(&self.between_velocities)
        });
        let added = add_forces(column, self.gas.lateral_drag, self.quantum, self.limit, loads);
        added.map_err(|too_large| GasForceOutOfRange::Particle {
            particle: ids[too_large.index],
            force: too_large.force,
            limit: self.limit,
            solids_fraction: too_large.solids_fraction,
        })
    }

    /// The pressure drop over the column by the grid integral, for results.
    pub fn pressure_drop(&self) -> f64 {
        let velocity_at =
            |node: usize| *self.velocities.get(node).unwrap_or(&self.superficial_velocity);
        self.gas.pressure_drop(&self.grid, &self.fields(), velocity_at)
    }

    fn fields(&self) -> ColumnFields<'_> {
        ColumnFields {
            solids_fraction: &self.bed.solids_fraction,
            solids_velocity: &self.bed.solids_velocity,
            share_density: &self.bed.share_density,
            drag_velocity: &self.bed.drag_velocity,
        }
    }

    /// Weight of all particles, as the exact sum of their rounded weights.
    fn weight_of(&self, particles: &Particles, gravity: f64, ranks: &dyn Communicator) -> f64 {
        let counts = (0..particles.owned_count())
            .map(|i| self.quantum.count(self.quantum.round(particles.body[i].mass * gravity)));
        let mut sum = [counts.sum()];
        ranks.sum_integers(&mut sum);
        sum[0] as f64 * self.quantum.spacing()
    }

    /// U_s from sum_i F_i = W.
    fn velocity_by_particle_force(
        &self,
        particles: &Particles,
        weight: f64,
        ranks: &dyn Communicator,
    ) -> Result<f64, GasForceOutOfRange> {
        self.velocity_by(particles, weight, ranks, |bed| {
            // Without particles there is nothing to carry.
            if bed.particles == 0.0 { 0.0 } else { (weight - bed.at_rest) / bed.slope }
        })
    }

    /// U_s from the force on the bed, sum_i F_i with each F_i = a_i + b_i U_s; repeated if b depends on the Reynolds
    /// number. `force` is an estimate of the resulting force. Collective.
    ///
    /// The iteration has converged when the change of the force on the bed due to the last change of U_s is lost in the
    /// rounding of the particles' forces: the sums do not settle any closer.
    fn velocity_by(
        &self,
        particles: &Particles,
        force: f64,
        ranks: &dyn Communicator,
        next: impl Fn(BedForce) -> f64,
    ) -> Result<f64, GasForceOutOfRange> {
        let mut velocity = 0.0;
        for _ in 0..MOST_ITERATIONS {
            let bed = self.force_on_bed(velocity, particles, ranks);
            let next = next(bed);
            let rounding = (bed.particles * self.quantum.spacing()).max(1.0e-13 * force.abs());
            let converged = ((next - velocity) * bed.slope).abs() <= rounding;
            velocity = next;
            if converged || !self.gas.drag.depends_on_reynolds() {
                return self.finite(velocity);
            }
        }
        Err(GasForceOutOfRange::NoBalance(velocity))
    }

    /// The gas force on all particles with the drag at a superficial velocity. Collective.
    fn force_on_bed(
        &self,
        velocity: f64,
        particles: &Particles,
        ranks: &dyn Communicator,
    ) -> BedForce {
        let column = self.particles_in(SuperficialVelocity::Uniform(velocity));
        let count = particles.owned_count();
        let [constant, slope] = sum_slopes(column, [self.quantum, self.slope_quantum], count);
        let mut sums = [constant, slope, count as i64];
        ranks.sum_integers(&mut sums);
        BedForce {
            at_rest: sums[0] as f64 * self.quantum.spacing(),
            slope: sums[1] as f64 * self.slope_quantum.spacing(),
            particles: sums[2] as f64,
        }
    }

    pub(super) fn cross_section(&self) -> f64 {
        self.grid.cell_volume() / self.grid.spacing()
    }

    /// U_s from the grid integral = W / S, by the secant method: exact at once for a linear drag law.
    fn velocity_by_grid_integral(&self, weight: f64) -> Result<f64, GasForceOutOfRange> {
        let target = weight / self.cross_section();
        let excess = |velocity: f64| {
            self.gas.pressure_drop(&self.grid, &self.fields(), |_| velocity) - target
        };
        let (mut old, mut velocity) = (0.0, self.grid.spacing());
        let (mut excess_old, mut excess_now) = (excess(old), excess(velocity));
        for _ in 0..MOST_ITERATIONS {
            if excess_now.abs() <= 1.0e-13 * target.abs() || excess_now == excess_old {
                return self.finite(velocity);
            }
            let next = velocity - excess_now * (velocity - old) / (excess_now - excess_old);
            (old, excess_old) = (velocity, excess_now);
            (velocity, excess_now) = (next, excess(next));
        }
        Err(GasForceOutOfRange::NoBalance(velocity))
    }

    fn finite(&self, velocity: f64) -> Result<f64, GasForceOutOfRange> {
        if velocity.is_finite() {
            Ok(velocity)
        } else {
            Err(GasForceOutOfRange::NoBalance(velocity))
        }
    }
}
