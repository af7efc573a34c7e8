//! The solids fraction around each particle on finer cells than those of the gas, for the drag law only.
//!
//! Drag grows so steeply with the solids fraction that a cell half of which lies above a bed has far less than half the
//! drag of a full one: on cells of 3 diameters the two surfaces of a bed take 3 diameters of its pressure drop. The gas
//! itself is less sensitive, since its superficial velocity passes a surface unchanged. The law is therefore evaluated
//! with the voidage eps_l of cells that are finer by a whole number, without the filter, and with the superficial slip
//! of the gas's own cells,
//!
//! ```math
//! b' = b\!\left(1 - \varepsilon_l,\; \varepsilon |\mathbf{u} - \mathbf{v}|\right) \left( \frac{\varepsilon}{\varepsilon_l} \right)^2 .
//! ```
//!
//! In model A the whole force on the particles of a bed, drag and their part of the pressure gradient, is b U_s / eps^2
//! for each particle, with U_s = eps |u - v|: the last factor gives the force of a bed at eps_l, although the gas flows
//! at eps. In a uniform bed nothing changes. b' replaces b on both sides, so that the gas loses what the particles
//! gain.
//!
//! The finer cells are so small that a lone particle fills part of them: S(phi) times its own share is subtracted from
//! phi_l, where S is the structure factor of [`own_disturbance`](super::own_disturbance).

use super::super::GAS_HALO;
use super::own_disturbance::structure_factor;
use crate::coupling::{CellTransfer, interpolate};
use crate::domain::Subdomain;
use crate::grid::{BoxGrid, Field, RoundColumn};
use crate::numbers::Quantum;
use crate::parallel::Communicator;
use crate::particles::Particles;

/// Solids fractions on finer cells. They are not part of the state of a run.
#[derive(Clone, Debug)]
pub(super) struct LocalVoidage {
    transfer: CellTransfer,
    solids_fraction: Field,
    quantum: Quantum,
    cell_volume: f64,
    least_voidage: f64,
}

impl LocalVoidage {
    /// Cells `factor` times as fine as those of `grid` along each axis; no voidage is below the smallest one.
    ///
    /// # Errors
    /// If the finer cells of a round column are not valid.
    pub(super) fn new(
        factor: usize,
        (grid, column): (&BoxGrid, Option<&RoundColumn>),
        subdomain: Subdomain,
        (largest_diameter, least_voidage): (f64, f64),
    ) -> Result<Self, String> {
        let fine = grid.refined(factor);
        let column = column.map(|column| column.on(&fine)).transpose()?;
        let solids_fraction = Field::new(&fine.local_cells(subdomain), GAS_HALO);
        Ok(Self {
            transfer: CellTransfer::new((&fine, column.as_ref()), 0.0, subdomain, &solids_fraction),
            solids_fraction,
            quantum: Quantum::spanning(fine.cell_volume() + largest_diameter.powi(3)),
            cell_volume: fine.cell_volume(),
            least_voidage,
        })
    }

    /// Deposits the particles' volume. Collective.
    pub(super) fn deposit(&mut self, particles: &Particles, ranks: &dyn Communicator) {
        let field = &mut self.solids_fraction;
        self.transfer.deposit_volume(particles, self.quantum, field, ranks);
        self.transfer.refresh(&mut [field], ranks);
    }

    /// phi_l around an owned particle of this volume, at the last [`LocalVoidage::deposit`].
    pub(super) fn around(&self, index: usize, volume: f64) -> f64 {
        let corners = &self.transfer.corners()[index];
        let [seen] = interpolate([&self.solids_fraction], corners);
        let own = volume / self.cell_volume * corners.own_share();
        let structure = structure_factor((seen - own).clamp(0.0, 1.0));
        (seen - own * structure).clamp(0.0, 1.0 - self.least_voidage)
    }

    /// Factor by which the coefficient of the law at the cells' voidage `eps` is multiplied.
    #[inline(always)]
    pub(super) fn factor(eps: f64, solids_fraction: f64) -> f64 {
        let ratio = eps / (1.0 - solids_fraction);
        ratio * ratio
    }
}
