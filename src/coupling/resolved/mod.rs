//! Particles in a gas that flows in three dimensions: what the gas sees of them, and what it does to them.
//!
//! One set of weights serves both directions: hats around cell centres, then the filter if there is one, then
//! means of the two cells of a face. What the gas loses at faces is what particles gain, to round-off:
//! sum_i b_i (u_i - v_i) = sum_f V (beta_f u_f - (beta v)_f), and likewise for the pressure gradient.

mod exchange;
mod filter;
mod flow;
mod transfer;

pub use filter::Filter;
pub use flow::{Flow, FlowModel, FlowReport, FlowSolver, FlowStep};

use super::GasForceOutOfRange;
use crate::domain::{Bounds, Subdomain};
use crate::gas::ParticleDrag;
use crate::gas::volume_averaged::{BedOnGrid, GAS_HALO, GasState};
use crate::grid::{BoxGrid, CellLocator, Field, LocalCells};
use crate::numbers::{Quantum, within};
use crate::parallel::{Communicator, FieldHalo};
use crate::particles::Particles;
use crate::rules::{LARGEST_DRAG_RESPONSE, drag_response};
use exchange::Exchanged;
use nalgebra::Vector3;
use std::f64::consts::PI;
use transfer::{Corners, deposit, interpolate, mean_gradient, mean_of_faces, within_reach};

/// How particles and gas see each other, as the case chose it.
#[derive(Clone, Debug, PartialEq)]
pub struct CouplingModel {
    /// Drag on particles.
    pub drag: ParticleDrag,
    /// Full width at half maximum of the filter; 0 for none.
    pub filter_width: f64,
    /// Voidage below which cells are not let; each such cell is counted.
    pub least_voidage: f64,
}

/// Bounds of what the particles are and do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParticleLimits {
    /// Smallest and largest diameter.
    pub diameters: [f64; 2],
    /// Largest component of one particle's gas force.
    pub force: f64,
    /// Largest speed of particles, and of gas relative to them.
    pub speed: f64,
    /// How far a particle may be from where it was given to its rank.
    pub stray: f64,
}

/// The exchange of momentum between particles and cells on one rank. Disposable.
#[derive(Clone, Debug)]
pub struct CellCoupling {
    model: CouplingModel,
    limits: ParticleLimits,
    bounds: Bounds,
    spacing: Vector3<f64>,
    ends: [[bool; 2]; 3],
    locator: CellLocator,
    halo: FieldHalo,
    filter: Option<Filter>,
    /// Of volumes, drag coefficients, and their products with velocities.
    quanta: [Quantum; 3],
    largest_drag: f64,
    bed: BedOnGrid,
    /// Where each owned particle was at the last observation.
    corners: Vec<Corners>,
    /// b of each owned particle, force per velocity.
    drag: Vec<f64>,
    /// Velocity of the gas and pressure gradient in cells.
    seen: [Field; 6],
    raised_cells: u64,
    exchanged: Exchanged,
}

impl CellCoupling {
    /// For one rank's part of a grid.
    ///
    /// # Errors
    /// If cells are so small that particles may stray beyond their rank's halo between two sortings.
    pub fn new(
        model: &CouplingModel,
        limits: ParticleLimits,
        grid: &BoxGrid,
        subdomain: Subdomain,
    ) -> Result<Self, String> {
        let smallest = grid.spacing().min();
        if !within_reach(limits.stray, smallest) {
            return Err(format!(
                "a cell of the gas is {smallest:.3e} wide, but particles may stray {:.3e} before they are \
                 sorted anew: use larger cells or a smaller parallel.skin",
                limits.stray
            ));
        }
        let part = grid.local_cells(subdomain);
        let [smallest, largest] = limits.diameters;
        let slip = 2.0 * limits.speed;
        let largest_drag = model.drag.per_velocity(largest, 1.0 - model.least_voidage, slip);
        // A cell has room for this many of the smallest particles; lattices have for four times as many.
        let room = 1.0 + grid.cell_volume() / (PI / 6.0 * smallest.powi(3));
        let drag = room * largest_drag;
        let ranges = [grid.cell_volume() + largest.powi(3), drag, drag * limits.speed];
        let zero = Field::new(&part, GAS_HALO);
        Ok(Self {
            model: model.clone(),
            limits,
            bounds: subdomain.bounds.clone(),
            spacing: grid.spacing(),
            ends: std::array::from_fn(|axis| part.at_ends(axis)),
            locator: CellLocator::new(grid, part),
            halo: FieldHalo::new(subdomain),
            filter: Filter::new(grid, model.filter_width),
            quanta: ranges.map(Quantum::spanning),
            largest_drag,
            bed: BedOnGrid::empty(&part),
            corners: Vec::new(),
            drag: Vec::new(),
            seen: std::array::from_fn(|_| zero.clone()),
            raised_cells: 0,
            exchanged: Exchanged::default(),
        })
    }

    /// The cells of this rank.
    pub fn part(&self) -> &LocalCells {
        self.locator.part()
    }

    /// What the gas sees of the particles, as of the last [`CellCoupling::observe`].
    pub fn bed(&self) -> &BedOnGrid {
        &self.bed
    }

    /// The same for the gas, which fills its halos.
    pub(super) fn bed_mut(&mut self) -> &mut BedOnGrid {
        &mut self.bed
    }

    /// The voidage alone. Collective.
    pub(super) fn observe_voidage(
        &mut self,
        particles: &Particles,
        ranks: &dyn Communicator,
    ) -> &Field {
        self.observe_volume(particles, ranks);
        &self.bed.voidage
    }

    /// Number of cells on this rank whose voidage was raised to the least one at the last observation.
    pub fn raised_cells(&self) -> u64 {
        self.raised_cells
    }

    /// Largest velocity change over velocity relative to the gas in a gas step of length `dt`.
    fn check_response(
        &self,
        particles: &Particles,
        (index, drag, voidage): (usize, f64, f64),
        dt: f64,
    ) -> Result<(), GasForceOutOfRange> {
        let response = drag_response(drag, dt, particles.body[index].mass, voidage);
        let (particle, limit) = (particles.id[index], self.largest_drag);
        if drag.is_nan() || drag > limit {
            return Err(GasForceOutOfRange::Drag { particle, drag, limit });
        }
        if response.is_nan() || response > LARGEST_DRAG_RESPONSE {
            let limit = LARGEST_DRAG_RESPONSE;
            return Err(GasForceOutOfRange::Response { particle, response, limit });
        }
        Ok(())
    }

    /// Brings the particles onto the grid: voidage eps, drag coefficient beta = sum_i w_i b_i / V_cell, and
    /// (beta v) = sum_i w_i b_i v_i / V_cell, with b_i by the solids fraction of now and the gas velocity of the
    /// last gas step. `dt` is the length of the next. Collective.
    ///
    /// Before: halos of the gas are current. After: halos of voidage are; those of the rest are the gas's task.
    ///
    /// # Errors
    /// If a drag coefficient has no meaning, or the gas step is too long for it; may differ between ranks.
    pub fn observe(
        &mut self,
        particles: &Particles,
        gas: &GasState,
        dt: f64,
        ranks: &dyn Communicator,
    ) -> Result<(), GasForceOutOfRange> {
        self.observe_volume(particles, ranks);
        self.see_velocity(gas, ranks);
        self.drag.clear();
        let mut result = Ok(());
        for field in std::iter::once(&mut self.bed.momentum_transfer)
            .chain(&mut self.bed.transferred_velocity)
        {
            field.values_mut().fill(0.0);
        }
        for i in 0..particles.owned_count() {
            let corners = self.corners[i];
            let [x, y, z, _, _, _] = &self.seen;
            let [u, v, w, eps] = interpolate([x, y, z, &self.bed.voidage], &corners);
            let velocity = particles.body[i].velocity;
            let slip = eps * (Vector3::new(u, v, w) - velocity).norm();
            let drag =
                self.model.drag.per_velocity(2.0 * particles.body[i].radius, 1.0 - eps, slip);
            result = result.and(self.check_response(particles, (i, drag, eps), dt));
            self.drag.push(drag);
            let BedOnGrid { momentum_transfer, transferred_velocity: [x, y, z], .. } =
                &mut self.bed;
            let [_, of_drag, of_flux] = self.quanta;
            deposit(
                [momentum_transfer, x, y, z],
                [of_drag, of_flux, of_flux, of_flux],
                &corners,
                [drag, drag * velocity.x, drag * velocity.y, drag * velocity.z],
            );
        }
        let BedOnGrid { momentum_transfer, transferred_velocity: [x, y, z], .. } = &mut self.bed;
        let mut fields = [momentum_transfer, x, y, z];
        self.halo.add_to_owners(&mut fields, ranks);
        let volume = self.spacing.x * self.spacing.y * self.spacing.z;
        for field in fields.iter_mut() {
            field.values_mut().iter_mut().for_each(|value| *value /= volume);
        }
        if let Some(filter) = &mut self.filter {
            filter.apply(&mut fields, &self.ends, &mut self.halo, ranks);
        }
        let coefficients = self.bed.momentum_transfer.values_mut();
        coefficients.iter_mut().for_each(|value| *value = value.max(0.0)); // the filter rounds
        result
    }

    /// Sets the force of the gas on each owned particle,
    /// F_i = b_i (u_i - v_i) - V_i (grad p)_i, rounded to the lattice of forces. Collective.
    ///
    /// `gravity` is the downward acceleration: the pressure of the gas is less its hydrostatic head, which acts
    /// on particles as buoyancy rho_g V g. Before: the bed is that of [`CellCoupling::observe`] at the same
    /// positions and velocities, and halos of the gas are current.
    ///
    /// # Errors
    /// If a force exceeds the limit or is undefined; may differ between ranks.
    pub fn press(
        &mut self,
        particles: &mut Particles,
        gas: &GasState,
        (gravity, quantum): (f64, Quantum),
        ranks: &dyn Communicator,
    ) -> Result<(), GasForceOutOfRange> {
        let buoyancy = self.model.drag.density * gravity;
        self.see_velocity_and_gradient(gas, buoyancy, ranks);
        let mut total = [0; 3];
        let mut result = Ok(());
        for i in 0..particles.owned_count() {
            let corners = &self.corners[i];
            let [x, y, z, gx, gy, gz] = &self.seen;
            let [u, v, w, gx, gy, gz] = interpolate([x, y, z, gx, gy, gz], corners);
            let slip = Vector3::new(u, v, w) - particles.body[i].velocity;
            let gradient = Vector3::new(gx, gy, gz - buoyancy);
            let force = self.drag[i] * slip - particles.volume(i) * gradient;
            let force = quantum.round_vector(force);
            if !within(&force, self.limits.force) {
                let [eps] = interpolate([&self.bed.voidage], corners);
                result = result.and(Err(GasForceOutOfRange::Particle {
                    particle: particles.id[i],
                    force: force.amax(),
                    limit: self.limits.force,
                    solids_fraction: 1.0 - eps,
                }));
            }
            particles.gas_force[i] = force;
            for axis in 0..3 {
                total[axis] += quantum.count(force[axis]);
            }
        }
        self.exchanged.gained = total;
        result
    }

    /// Mean velocity of the solids in each owned cell, by volume; 0 where there are none. Collective.
    pub(super) fn solids_velocity(
        &self,
        particles: &Particles,
        ranks: &dyn Communicator,
    ) -> [Field; 3] {
        let zero = Field::new(self.part(), GAS_HALO);
        let [mut volume, mut x, mut y, mut z] = std::array::from_fn(|_| zero.clone());
        let of_flux = Quantum::spanning(self.quanta[0].range() * self.limits.speed);
        for i in 0..particles.owned_count() {
            let corners = self.corners_of(&particles.body[i].position);
            let (amount, v) = (particles.volume(i), particles.body[i].velocity);
            let amounts = [amount, amount * v.x, amount * v.y, amount * v.z];
            let quanta = [self.quanta[0], of_flux, of_flux, of_flux];
            deposit([&mut volume, &mut x, &mut y, &mut z], quanta, &corners, amounts);
        }
        self.halo.clone().add_to_owners(&mut [&mut volume, &mut x, &mut y, &mut z], ranks);
        [x, y, z].map(|mut flux| {
            for (flux, &volume) in flux.values_mut().iter_mut().zip(volume.values()) {
                *flux = if volume > 0.0 { *flux / volume } else { 0.0 };
            }
            flux
        })
    }

    fn corners_of(&self, position: &Vector3<f64>) -> Corners {
        let weights = self.locator.weights(&self.bounds.wrap(*position));
        Corners::of(&weights, &self.bed.voidage)
    }

    fn observe_volume(&mut self, particles: &Particles, ranks: &dyn Communicator) {
        self.bed.voidage.values_mut().fill(0.0);
        self.corners.clear();
        for i in 0..particles.owned_count() {
            let corners = self.corners_of(&particles.body[i].position);
            self.corners.push(corners);
            let (field, quantum) = (&mut self.bed.voidage, self.quanta[0]);
            deposit([field], [quantum], &corners, [particles.volume(i)]);
        }
        let voidage = &mut self.bed.voidage;
        self.halo.add_to_owners(&mut [voidage], ranks);
        let volume = self.spacing.x * self.spacing.y * self.spacing.z;
        voidage.values_mut().iter_mut().for_each(|value| *value /= volume);
        if let Some(filter) = &mut self.filter {
            filter.apply(&mut [voidage], &self.ends, &mut self.halo, ranks);
        }
        self.raised_cells = 0;
        let along_x = voidage.count()[0];
        for row in voidage.rows() {
            for value in &mut voidage.values_mut()[row..row + along_x] {
                let eps = (1.0 - *value).min(1.0); // the filter rounds
                self.raised_cells += u64::from(eps < self.model.least_voidage);
                *value = eps.max(self.model.least_voidage);
            }
        }
        self.halo.refresh(&mut [voidage], ranks);
    }

    /// Velocity of the gas in cells.
    fn see_velocity(&mut self, gas: &GasState, ranks: &dyn Communicator) {
        for axis in 0..3 {
            mean_of_faces(&gas.velocity[axis], axis, &mut self.seen[axis]);
        }
        let [x, y, z, _, _, _] = &mut self.seen;
        let fields = &mut [x, y, z];
        if let Some(filter) = &mut self.filter {
            filter.apply(fields, &self.ends, &mut self.halo, ranks);
        }
        self.halo.refresh(fields, ranks);
    }

    /// Velocity of the gas and pressure gradient in cells; before they are filtered, what the gas loses:
    /// sum_c V (beta u - (beta v) - (1 - eps) (grad p - rho_g g)), the sum over faces of what it solves for.
    fn see_velocity_and_gradient(
        &mut self,
        gas: &GasState,
        buoyancy: f64,
        ranks: &dyn Communicator,
    ) {
        for axis in 0..3 {
            mean_of_faces(&gas.velocity[axis], axis, &mut self.seen[axis]);
            let distance = self.spacing[axis];
            mean_gradient(&gas.pressure, axis, distance, &mut self.seen[3 + axis]);
            self.exchanged.lost[axis] = self.lost(axis, if axis == 2 { buoyancy } else { 0.0 });
        }
        let fields = &mut self.seen.each_mut();
        if let Some(filter) = &mut self.filter {
            filter.apply(fields, &self.ends, &mut self.halo, ranks);
        }
        self.halo.refresh(fields, ranks);
    }
}

#[cfg(test)]
mod tests;
