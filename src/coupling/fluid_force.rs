//! Grid to particles: the force of the one-dimensional gas, Moon 2006 eqs (11), (12) and (18).

use super::{Bed, CoarseGraining};
use crate::domain::Bounds;
use crate::gas::{ColumnFields, ColumnGas, DragLaw, Drive, ParticleDrag, WeightBalance};
use crate::grid::ColumnGrid;
use crate::numbers::{Quantum, VectorWork, in_wide_vectors, within};
use crate::parallel::Communicator;
use crate::particles::Particles;
use nalgebra::Vector3;
use thiserror::Error;

/// A gas force that has no meaning.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum GasForceOutOfRange {
    /// On one particle.
    #[error(
        "the gas force on particle {particle} is {force:.3e} (limit {limit:.3e}) at a solids fraction of \
         {solids_fraction:.3}: particles overlap too much, or time.step is too long"
    )]
    Particle {
        /// Its id.
        particle: u64,
        /// Largest component of the force.
        force: f64,
        /// What it may be.
        limit: f64,
        /// Solids fraction at the particle.
        solids_fraction: f64,
    },
    /// On the whole bed.
    #[error("no superficial velocity lets the gas carry the bed's weight (last tried: {0:.6e})")]
    NoBalance(f64),
}

/// Iterations that the superficial velocity of a weight-carrying gas may take; 5 to 10 are usual.
const MOST_ITERATIONS: usize = 100;

/// The column gas at work: its grid, the bed on it, and the superficial velocity of the moment.
#[derive(Clone, Debug)]
pub struct FluidForce {
    grid: ColumnGrid,
    coarse_graining: CoarseGraining,
    bed: Bed,
    superficial_velocity: f64,
    lattice: Quantum,
    slope_lattice: Quantum,
    limit: f64,
    local: AtParticles,
}

/// The fields at each owned particle, and the drag on it per velocity.
#[derive(Clone, Debug, Default)]
struct AtParticles {
    solids_fraction: Vec<f64>,
    solids_velocity: Vec<f64>,
    drag: Vec<f64>,
}

impl FluidForce {
    /// For forces up to `force_limit` on a lattice, and speeds up to `speed_limit`.
    pub fn new(
        gas: &ColumnGas,
        bounds: &Bounds,
        lattice: Quantum,
        force_limit: f64,
        speed_limit: f64,
    ) -> Self {
        let grid = gas.grid(bounds);
        let coarse_graining = CoarseGraining::new(&grid, speed_limit);
        // Drag per velocity, with room for the densest beds at the creeping speeds of fine powders.
        let slope_lattice = Quantum::spanning(1024.0 * force_limit / speed_limit);
        Self {
            grid,
            coarse_graining,
            bed: Bed::default(),
            superficial_velocity: 0.0,
            lattice,
            slope_lattice,
            limit: force_limit,
            local: AtParticles::default(),
        }
    }

    /// The grid.
    pub fn grid(&self) -> &ColumnGrid {
        &self.grid
    }

    /// The bed on the grid, as of the last [`FluidForce::coarse_grain`].
    pub fn bed(&self) -> &Bed {
        &self.bed
    }

    /// U_s, volume of gas per area and time relative to the frame of the box.
    pub fn superficial_velocity(&self) -> f64 {
        self.superficial_velocity
    }

    /// phi and u_s of the bed now, on the grid and at the particles. Collective.
    pub fn coarse_grain(&mut self, particles: &Particles, ranks: &dyn Communicator) {
        self.coarse_graining.deposit(particles, &self.grid, &mut self.bed, ranks);
        let AtParticles { solids_fraction, solids_velocity, .. } = &mut self.local;
        let (phi, velocity) = (&self.bed.solids_fraction, &self.bed.solids_velocity);
        solids_fraction.clear();
        solids_velocity.clear();
        for position in &particles.position[..particles.owned_count()] {
            let weights = self.grid.weights(position.z);
            let interpolate = |field: &[f64]| {
                let (lower, upper) = (field[weights.lower], field[weights.upper]);
                lower + weights.of_upper * (upper - lower)
            };
            solids_fraction.push(interpolate(phi));
            solids_velocity.push(interpolate(velocity));
        }
    }

    /// Sets U_s: what the case says for this time, or what carries the weight. Collective.
    ///
    /// # Errors
    /// If no velocity carries the weight; the same on all ranks.
    pub fn set_superficial_velocity(
        &mut self,
        gas: &ColumnGas,
        particles: &Particles,
        time_and_gravity: (f64, f64),
        ranks: &dyn Communicator,
    ) -> Result<(), GasForceOutOfRange> {
        let (time, gravity) = time_and_gravity;
        self.superficial_velocity = match &gas.drive {
            Drive::Velocity(schedule) => schedule.at(time),
            Drive::Weight(balance) => {
                let weight = self.weight_of(particles, gravity, ranks);
                match balance {
                    WeightBalance::ParticleForce => {
                        self.velocity_by_particle_force(gas, particles, weight, ranks)?
                    }
                    WeightBalance::GridIntegral => {
                        self.velocity_by_grid_integral(gas, particles, weight, ranks)?
                    }
                }
            }
        };
        Ok(())
    }

    /// Adds the gas force to each owned particle; returns their sum here, as counts of the force lattice.
    ///
    /// F = (V / phi) beta [ (u_s - v) - (u_s - U_s) / (1 - phi)^2 ] upwards (Moon 2006 eq. (12)); laterally
    /// -(V / phi) beta v if the gas has lateral drag.
    ///
    /// # Errors
    /// If a force exceeds the limit or is undefined.
    pub fn add_to(
        &mut self,
        gas: &ColumnGas,
        particles: &mut Particles,
    ) -> Result<[i64; 3], GasForceOutOfRange> {
        self.find_drag(gas, particles, self.superficial_velocity);
        let local = &self.local;
        let mut total = [0; 3];
        for i in 0..particles.owned_count() {
            let (drag, u) = (local.drag[i], local.solids_velocity[i]);
            let voidage = 1.0 - local.solids_fraction[i];
            let velocity = particles.velocity[i];
            let slip = self.superficial_velocity - u;
            let lateral = if gas.lateral_drag { drag } else { 0.0 };
            let force = self.lattice.round_vector(Vector3::new(
                -lateral * velocity.x,
                -lateral * velocity.y,
                drag * ((u - velocity.z) + slip / (voidage * voidage)),
            ));
            if !within(&force, self.limit) {
                return Err(GasForceOutOfRange::Particle {
                    particle: particles.id[i],
                    force: force.amax(),
                    limit: self.limit,
                    solids_fraction: local.solids_fraction[i],
                });
            }
            particles.force[i] += force;
            for axis in 0..3 {
                total[axis] += self.lattice.count(force[axis]);
            }
        }
        Ok(total)
    }

    /// The pressure drop over the column by the grid integral, for results. Collective.
    pub fn pressure_drop(
        &mut self,
        gas: &ColumnGas,
        particles: &Particles,
        ranks: &dyn Communicator,
    ) -> f64 {
        self.coarse_graining.deposit_diameters(particles, &self.grid, &mut self.bed, ranks);
        gas.pressure_drop(&self.grid, &self.fields(), self.superficial_velocity)
    }

    fn fields(&self) -> ColumnFields<'_> {
        ColumnFields {
            solids_fraction: &self.bed.solids_fraction,
            solids_velocity: &self.bed.solids_velocity,
            diameter_density: &self.bed.diameter_density,
        }
    }

    /// Drag per velocity on each owned particle at a superficial velocity.
    fn find_drag(&mut self, gas: &ColumnGas, particles: &Particles, velocity: f64) {
        let AtParticles { solids_fraction, solids_velocity, drag } = &mut self.local;
        drag.resize(solids_fraction.len(), 0.0);
        let radii = &particles.radius[..particles.owned_count()];
        in_wide_vectors(DragWork {
            drag_law: gas.particle_drag(),
            radii,
            solids_fraction,
            solids_velocity,
            velocity,
            drag,
        });
    }

    /// Weight of all particles, as the sum of their rounded weights: exact.
    fn weight_of(&self, particles: &Particles, gravity: f64, ranks: &dyn Communicator) -> f64 {
        let counts = (0..particles.owned_count())
            .map(|i| self.lattice.count(self.lattice.round(particles.mass[i] * gravity)));
        let mut sum = [counts.sum()];
        ranks.sum_integers(&mut sum);
        sum[0] as f64 * self.lattice.spacing()
    }

    /// U_s from sum_i F_i = W, each F_i = a_i + b_i U_s; repeated while b depends on the Reynolds number.
    ///
    /// Converged when what the last change of U_s does to the force on the bed is lost in the rounding of the
    /// particles' forces: nearer than that the sums do not settle.
    fn velocity_by_particle_force(
        &mut self,
        gas: &ColumnGas,
        particles: &Particles,
        weight: f64,
        ranks: &dyn Communicator,
    ) -> Result<f64, GasForceOutOfRange> {
        let mut velocity = 0.0;
        for _ in 0..MOST_ITERATIONS {
            self.find_drag(gas, particles, velocity);
            let local = &self.local;
            let mut sums = [0, 0, particles.owned_count() as i64];
            for i in 0..particles.owned_count() {
                let (u, v) = (local.solids_velocity[i], particles.velocity[i].z);
                let slope = local.drag[i] / (1.0 - local.solids_fraction[i]).powi(2);
                let constant = local.drag[i] * (u - v) - slope * u;
                sums[0] += self.lattice.count(self.lattice.round(constant));
                sums[1] += self.slope_lattice.count(self.slope_lattice.round(slope));
            }
            ranks.sum_integers(&mut sums);
            let constant = sums[0] as f64 * self.lattice.spacing();
            let slope = sums[1] as f64 * self.slope_lattice.spacing();
            let next = (weight - constant) / slope;
            let rounding = (sums[2] as f64 * self.lattice.spacing()).max(1.0e-13 * weight.abs());
            let converged = ((next - velocity) * slope).abs() <= rounding;
            velocity = next;
            if converged || !gas.drag.depends_on_reynolds() {
                return self.finite(velocity);
            }
        }
        Err(GasForceOutOfRange::NoBalance(velocity))
    }

    /// U_s from the grid integral = W / S, by the secant method: exact at once for a linear drag law.
    fn velocity_by_grid_integral(
        &mut self,
        gas: &ColumnGas,
        particles: &Particles,
        weight: f64,
        ranks: &dyn Communicator,
    ) -> Result<f64, GasForceOutOfRange> {
        self.coarse_graining.deposit_diameters(particles, &self.grid, &mut self.bed, ranks);
        let target = weight / (self.grid.cell_volume() / self.grid.spacing());
        let excess =
            |velocity: f64| gas.pressure_drop(&self.grid, &self.fields(), velocity) - target;
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

/// Drag per velocity on particles of these radii where the bed has this phi and u_s.
struct DragWork<'a> {
    drag_law: ParticleDrag,
    radii: &'a [f64],
    solids_fraction: &'a [f64],
    solids_velocity: &'a [f64],
    velocity: f64,
    drag: &'a mut [f64],
}

impl VectorWork for DragWork<'_> {
    type Output = ();

    /// The law is chosen once, so that the loop holds no branch.
    #[inline(always)]
    fn run(self) {
        match self.drag_law.law {
            DragLaw::WenYuCreeping => self.fill(DragLaw::WenYuCreeping),
            DragLaw::WenYu => self.fill(DragLaw::WenYu),
        }
    }
}

impl DragWork<'_> {
    #[inline(always)]
    fn fill(self, law: DragLaw) {
        let drag_law = ParticleDrag { law, ..self.drag_law };
        let bed = self.solids_fraction.iter().zip(self.solids_velocity);
        for ((drag, &radius), (&phi, &u)) in self.drag.iter_mut().zip(self.radii).zip(bed) {
            *drag = drag_law.per_velocity(2.0 * radius, phi, self.velocity - u);
        }
    }
}
