//! The exchange of momentum between particles and gas: the fields of the particles that the gas needs, and its force on
//! them.
//!
//! One set of weights serves both directions: hat functions around cell centres, then the filter if there is one, then
//! means of the two cells of a face. The momentum that the gas loses at faces is gained by the particles, to round-off:
//! sum_i b_i (u_i - v_i) = sum_f V (beta_f u_f - (beta v)_f), and likewise for the pressure gradient.

mod drag_at_place;
mod drag_deposition;
mod forces;
mod local_voidage;
mod mean_diameter;
mod own_disturbance;

use self::drag_at_place::DragAtPlace;
use self::drag_deposition::{DragBounds, DragDeposition, deposit_drag};
use self::forces::set_forces;
use self::local_voidage::LocalVoidage;
use self::mean_diameter::MeanDiameter;
use self::own_disturbance::OwnDisturbance;
use super::momentum_balance::{CellVolumes, Exchanged, force_lost};
use super::{BedOnGrid, CouplingModel, GAS_HALO, GasFields};
use crate::coupling::{
    CellTransfer, DragShare, FourFields, deposit, mean_gradient, mean_of_faces,
    mend_gradient_at_wall,
};
use crate::domain::Subdomain;
use crate::gas::{GasForceOutOfRange, ParticleLimits};
use crate::grid::{BoxGrid, Field, LocalCells, RoundColumn};
use crate::numbers::Quantum;
use crate::parallel::Communicator;
use crate::particles::Particles;
use nalgebra::Vector3;
use std::f64::consts::PI;

/// The exchange of momentum between the particles and the gas of one rank. It is not part of the state of a run.
#[derive(Clone, Debug)]
pub struct ParticleExchange {
    model: CouplingModel,
    limits: ParticleLimits,
    spacing: Vector3<f64>,
    transfer: CellTransfer,
    /// Set if particles of different sizes share the drag by surface.
    mean_diameter: Option<MeanDiameter>,
    /// Set if drag laws use the slip and the voidage without the particle's own disturbance.
    own_disturbance: Option<OwnDisturbance>,
    /// Set if drag laws use the voidage of finer cells.
    local_voidage: Option<LocalVoidage>,
    quanta: Quanta,
    largest_drag: f64,
    pub(super) bed: BedOnGrid,
    /// b of each owned particle, force per velocity.
    drag: Vec<f64>,
    /// The gas in cell centres: velocity, then pressure gradient.
    in_cells: [Field; 6],
    /// Values given to particles, or contributed by them, in the cells around them.
    at_places: [FourFields; 2],
    raised_cells: u64,
    exchanged: Exchanged,
}

/// Quanta to which shares of particles are rounded.
#[derive(Clone, Copy, Debug)]
struct Quanta {
    volume: Quantum,
    drag: Quantum,
    /// Drag coefficient times velocity.
    drag_flux: Quantum,
}

impl ParticleExchange {
    /// An exchange for one rank's part of a grid, in the box or in a round column in it.
    ///
    /// # Errors
    /// If cells are so small that particles may drift beyond their rank's halo between two sortings.
    pub fn new(
        model: &CouplingModel,
        limits: ParticleLimits,
        (grid, column): (&BoxGrid, Option<&RoundColumn>),
        subdomain: Subdomain,
    ) -> Result<Self, String> {
        let finest = grid.refined(model.local_voidage.unwrap_or(1));
        if limits.drift > CellTransfer::reach(&finest) {
            return Err(format!(
                "a cell of the gas is {:.3e} wide, but particles may drift {:.3e} before they are sorted to ranks \
                 again: use larger cells or a smaller parallel.skin",
                finest.spacing().min(),
                limits.drift
            ));
        }
        let part = grid.local_cells(subdomain);
        let [smallest, largest] = limits.diameters;
        let shares_surface = model.drag.share == DragShare::Surface && smallest != largest;
        let largest_drag = largest_drag(model, &limits, shares_surface);
        // A cell has room for this number of the smallest particles; quanta allow for four times as many.
        let room = 1.0 + grid.cell_volume() / (PI / 6.0 * smallest.powi(3));
        let drag = room * largest_drag;
        let quanta = Quanta {
            volume: Quantum::spanning(grid.cell_volume() + largest.powi(3)),
            drag: Quantum::spanning(drag),
            drag_flux: Quantum::spanning(drag * limits.speed),
        };
        let zero = Field::new(&part, GAS_HALO);
        let transfer = CellTransfer::new((grid, column), model.filter_width, subdomain, &zero);
        let gas = [model.drag.density, model.drag.viscosity];
        let own_disturbance = model.undisturbed.then(|| OwnDisturbance::new(grid, &transfer, gas));
        let on_finer_cells = |factor| {
            let limits = (largest, model.least_voidage);
            LocalVoidage::new(factor, (grid, column), subdomain, limits)
        };
        let local_voidage = model.local_voidage.map(on_finer_cells).transpose()?;
        Ok(Self {
            model: model.clone(),
            limits,
            spacing: grid.spacing(),
            transfer,
            own_disturbance,
            local_voidage,
            mean_diameter: shares_surface
                .then(|| MeanDiameter::new(&part, grid.cell_volume(), limits.diameters)),
            quanta,
            largest_drag,
            bed: BedOnGrid::empty(&part),
            drag: Vec::new(),
            in_cells: std::array::from_fn(|_| zero.clone()),
            at_places: Default::default(),
            raised_cells: 0,
            exchanged: Exchanged::default(),
        })
    }

    /// The cells of this rank.
    pub fn part(&self) -> &LocalCells {
        self.transfer.part()
    }

    /// Fields of the particles for the gas, at the last [`ParticleExchange::deposit`].
    pub fn bed(&self) -> &BedOnGrid {
        &self.bed
    }

    /// Number of cells on this rank whose voidage was raised to the least one at the last deposition.
    pub fn raised_cells(&self) -> u64 {
        self.raised_cells
    }

    /// Largest component of the difference between the force on all particles and the force that the gas loses, at the
    /// last [`ParticleExchange::set_forces`]. Collective.
    pub fn momentum_error(&self, ranks: &dyn Communicator) -> f64 {
        self.exchanged.error(self.limits.force_quantum, ranks)
    }

    /// Deposits the particles on the grid: voidage eps, drag coefficient beta = sum_i w_i b_i / V_c, and
    /// (beta v) = sum_i w_i b_i v_i / V_c, with V_c the open volume of the cell. b_i is computed from the present
    /// solids fraction and the gas velocity of the last gas step. `dt` is the length of the next step. Collective.
    ///
    /// Before: halos of the gas are current. After: halos of voidage are current; the gas fills those of the other
    /// fields.
    ///
    /// # Errors
    /// If a drag coefficient exceeds its limit or is undefined, or the gas step is too long for it; may differ between
    /// ranks.
    pub fn deposit(
        &mut self,
        particles: &mut Particles,
        gas: &GasFields,
        dt: f64,
        ranks: &dyn Communicator,
    ) -> Result<(), GasForceOutOfRange> {
        self.deposit_volume(particles, ranks);
        if let Some(mean) = &mut self.mean_diameter {
            mean.deposit(&mut self.transfer, particles, ranks);
        }
        if let Some(local) = &mut self.local_voidage {
            local.deposit(particles, ranks);
        }
        self.centre_velocity(gas);
        let [x, y, z, _, _, _] = &mut self.in_cells;
        self.transfer.prepare_interpolation(&mut [x, y, z], ranks);
        let result = self.deposit_drag(particles, dt);
        let BedOnGrid { momentum_transfer, transferred_velocity: [x, y, z], .. } = &mut self.bed;
        self.transfer.sum_per_volume(&mut [momentum_transfer, x, y, z], ranks);
        let coefficients = self.bed.momentum_transfer.values_mut();
        coefficients.iter_mut().for_each(|value| *value = value.max(0.0)); // the filter rounds
        result
    }

    /// Deposits the particles' volume alone: the voidage. Collective.
    pub fn deposit_volume(&mut self, particles: &Particles, ranks: &dyn Communicator) {
        let voidage = &mut self.bed.voidage;
        self.transfer.deposit_volume(particles, self.quanta.volume, voidage, ranks);
        self.raised_cells = 0;
        let length = voidage.row_length();
        for row in voidage.rows() {
            for value in &mut voidage.values_mut()[row..row + length] {
                let eps = (1.0 - *value).min(1.0); // the filter rounds
                self.raised_cells += u64::from(eps < self.model.least_voidage);
                *value = eps.max(self.model.least_voidage);
            }
        }
        self.transfer.refresh(&mut [voidage], ranks);
    }

    /// Finds the drag coefficient of each owned particle and adds its shares to the cells around.
    fn deposit_drag(
        &mut self,
        particles: &mut Particles,
        dt: f64,
    ) -> Result<(), GasForceOutOfRange> {
        let BedOnGrid { voidage, momentum_transfer, transferred_velocity: [x, y, z] } =
            &mut self.bed;
        let [gas, shares] = &mut self.at_places;
        let [gas_x, gas_y, gas_z, _, _, _] = &self.in_cells;
        gas.copy_from([gas_x, gas_y, gas_z, voidage], self.transfer.places());
        shares.clear(self.transfer.places());
        let Quanta { drag: of_drag, drag_flux, .. } = self.quanta;
        self.drag.clear();
        let result = deposit_drag(DragDeposition {
            corners: self.transfer.corners(),
            gas,
            law: DragAtPlace {
                law: &self.model.drag,
                mean_diameter: self.mean_diameter.as_ref(),
                local_voidage: self.local_voidage.as_ref(),
                own_disturbance: self.own_disturbance.as_ref(),
            },
            by_agglomerate: self.model.agglomerates.is_some(),
            bounds: DragBounds { dt, largest_drag: self.largest_drag },
            particles,
            drag: &mut self.drag,
            shares,
            quanta: [drag_flux, drag_flux, drag_flux, of_drag],
        });
        shares.copy_to([x, y, z, momentum_transfer]);
        result
    }

    /// Sets the force of the gas on each owned particle, F_i = b_i (u_i - v_i) - V_i (grad p)_i, rounded to the quantum
    /// of force; it replaces the previous one in the total force. Collective.
    ///
    /// `gravity` is the downward acceleration: the pressure of the gas does not include its hydrostatic head, which
    /// acts on particles as buoyancy rho_g V g. Before: the bed is that of [`ParticleExchange::deposit`] at the same
    /// positions and velocities, and halos of the gas are current.
    ///
    /// # Errors
    /// If a force exceeds the limit or is undefined; may differ between ranks.
    pub fn set_forces(
        &mut self,
        particles: &mut Particles,
        gas: &GasFields,
        gravity: f64,
        ranks: &dyn Communicator,
    ) -> Result<(), GasForceOutOfRange> {
        let buoyancy = self.model.drag.density * gravity;
        self.interpolate_gas(gas, buoyancy, ranks);
        let [velocity, gradient] = &mut self.at_places;
        let ([u, v, w, gx, gy, gz], eps) = (&self.in_cells, &self.bed.voidage);
        velocity.copy_from([u, v, w, eps], self.transfer.places());
        gradient.copy_from([gx, gy, gz, eps], self.transfer.places());
        let Self { transfer, at_places, drag, limits, .. } = self;
        let corners = transfer.corners();
        let (total, result) = set_forces(corners, at_places, buoyancy, drag, *limits, particles);
        self.exchanged.gained = total;
        result
    }

    /// Mean velocity of the solids in each owned cell, by volume; 0 where there are none. Collective.
    pub fn solids_velocity(
        &mut self,
        particles: &Particles,
        ranks: &dyn Communicator,
    ) -> [Field; 3] {
        let zero = Field::new(self.part(), GAS_HALO);
        let [mut volume, mut x, mut y, mut z] = std::array::from_fn(|_| zero.clone());
        let of_flux = Quantum::spanning(self.quanta.volume.range() * self.limits.speed);
        let quanta = [self.quanta.volume, of_flux, of_flux, of_flux];
        for i in 0..particles.owned_count() {
            let corners = self.transfer.corners_at(&particles.body[i].position, &volume);
            let (amount, v) = (particles.volume(i), particles.body[i].velocity);
            let amounts = [amount, amount * v.x, amount * v.y, amount * v.z];
            deposit([&mut volume, &mut x, &mut y, &mut z], quanta, &corners, amounts);
        }
        self.transfer.add_to_owners(&mut [&mut volume, &mut x, &mut y, &mut z], ranks);
        [x, y, z].map(|mut flux| {
            for (flux, &volume) in flux.values_mut().iter_mut().zip(volume.values()) {
                *flux = if volume > 0.0 { *flux / volume } else { 0.0 };
            }
            flux
        })
    }

    /// Velocity of the gas in cells.
    fn centre_velocity(&mut self, gas: &GasFields) {
        for axis in 0..3 {
            mean_of_faces(&gas.velocity[axis], axis, &mut self.in_cells[axis]);
        }
    }

    /// Sets the velocity of the gas and the pressure gradient in cells, ready for interpolation; before they are
    /// filtered, computes the force that the gas loses.
    fn interpolate_gas(&mut self, gas: &GasFields, buoyancy: f64, ranks: &dyn Communicator) {
        self.centre_velocity(gas);
        for axis in 0..3 {
            let distance = self.spacing[axis];
            let gradient = &mut self.in_cells[3 + axis];
            mean_gradient(&gas.pressure, axis, distance, gradient);
            if let Some(column) = self.transfer.column().filter(|_| axis < 2) {
                mend_gradient_at_wall(&gas.pressure, (axis, distance), column, gradient);
            }
            let buoyancy = if axis == 2 { buoyancy } else { 0.0 };
            let volume = self.spacing.x * self.spacing.y * self.spacing.z;
            let volumes = CellVolumes { whole: volume, column: self.transfer.column() };
            self.exchanged.lost[axis] =
                force_lost(&self.bed, &self.in_cells, axis, buoyancy, volumes);
        }
        self.transfer.prepare_interpolation(&mut self.in_cells.each_mut(), ranks);
    }
}

/// The largest possible drag coefficient of a particle within these limits.
fn largest_drag(model: &CouplingModel, limits: &ParticleLimits, shares_surface: bool) -> f64 {
    let ([smallest, largest], slip) = (limits.diameters, 2.0 * limits.speed);
    let dense = 1.0 - model.least_voidage;
    let of_law = if shares_surface {
        // A large particle among small ones has the largest coefficient.
        model.drag.per_velocity_in_mixture([largest, smallest], dense, slip)
    } else {
        model.drag.per_velocity(largest, dense, slip)
    };
    let of_local = model.local_voidage.map_or(1.0, |_| LocalVoidage::factor(1.0, dense));
    let of_own = if model.undisturbed { OwnDisturbance::LARGEST_FACTOR } else { 1.0 };
    of_law * of_local * of_own
}

#[cfg(test)]
mod tests;
