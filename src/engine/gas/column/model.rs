//! The model of the column gas that a case chooses: one-dimensional, without inertia, compressible or not.

use super::plenum::Plenum;
use crate::coupling::DragShare;
use crate::domain::Bounds;
use crate::gas::{DragLaw, ParticleDrag};
use crate::grid::ColumnGrid;
use crate::numbers::Schedule;

/// The column gas chosen by the case. Continuity of the mixture gives (1 - phi) u_g + phi u_s = U_s, Darcy's law
/// -dp/dz = beta (u_g - u_s) / (1 - phi) (Moon 2006 eqs (6), (7), (11)).
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnGas {
    /// Distance dz of the grid nodes; a divisor of the box length if the box is periodic.
    pub spacing: f64,
    /// Drag law.
    pub drag: DragLaw,
    /// xi, the ratio of the drag to that of the law; usually 1.
    pub drag_factor: f64,
    /// Gas viscosity mu_g.
    pub viscosity: f64,
    /// Rule by which particles of different sizes share the drag.
    pub drag_share: DragShare,
    /// Gas density rho_g; only drag laws with a Reynolds number use it.
    pub density: f64,
    /// Size ratio l of parcels; 1 for particles.
    pub parcel_size: f64,
    /// The drive that sets the superficial velocity.
    pub drive: Drive,
    /// Whether the gas, which has no lateral velocity, resists lateral motion: -(V / phi) beta v.
    pub lateral_drag: bool,
    /// Volume of the node on the plate.
    pub base_node: BaseNode,
    /// P, absolute pressure above the bed, for a compressible gas (isothermal and ideal); `None` for an incompressible
    /// one. A gas without a plate, in a periodic box, is always incompressible.
    pub ambient_pressure: Option<f64>,
}

/// The drive that sets the superficial velocity U_s.
#[derive(Clone, Debug, PartialEq)]
pub enum Drive {
    /// A velocity prescribed by the case.
    Velocity(Schedule),
    /// Gas that comes out of a plenum.
    Plenum(Plenum),
    /// The gas carries the weight of a fully periodic box at every instant (Moon 2006 eq. (18)).
    Weight(WeightBalance),
}

/// The pressure drop that balances the weight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WeightBalance {
    /// The total gas force on the particles: exact balance, no drift.
    ParticleForce,
    /// The integral of beta (U_s - u_s) / (1 - phi)^2 over the grid, as the equation is written; the box drifts by up
    /// to 1 % of gravity.
    GridIntegral,
}

/// The averaging volume of the node on the plate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BaseNode {
    /// A full cell, half of which lies below the plate: phi is halved there (Moon 2006 eq. (9) as written).
    FullCell,
    /// The half cell above the plate.
    HalfCell,
}

impl ColumnGas {
    /// The plenum from which it comes, if there is one.
    pub fn plenum(&self) -> Option<&Plenum> {
        match &self.drive {
            Drive::Plenum(plenum) => Some(plenum),
            Drive::Velocity(_) | Drive::Weight(_) => None,
        }
    }

    /// Inflow at a plate; `None` for a gas that carries a weight.
    pub(super) fn supply(&self) -> Option<&Schedule> {
        match &self.drive {
            Drive::Velocity(schedule) => Some(schedule),
            Drive::Plenum(plenum) => Some(&plenum.supply),
            Drive::Weight(_) => None,
        }
    }

    /// The grid of this gas.
    pub fn grid(&self, bounds: &Bounds) -> ColumnGrid {
        let base_part = match self.base_node {
            BaseNode::FullCell => 1.0,
            BaseNode::HalfCell => 0.5,
        };
        ColumnGrid::new(bounds, self.spacing, base_part)
    }

    /// The drag on one particle, as a function of its size and surroundings.
    pub fn particle_drag(&self) -> ParticleDrag {
        ParticleDrag {
            law: self.drag.clone(),
            factor: self.drag_factor,
            share: self.drag_share,
            viscosity: self.viscosity,
            density: self.density,
            parcel_size: self.parcel_size,
        }
    }

    /// Pressure drop over the column: the integral of -dp/dz = B (u_g - u_d) / (1 - phi), which for particles of
    /// one size is beta (U_s - u_s) / (1 - phi)^2.
    ///
    /// Node 0 on the plate counts in full width if it averages over a full cell, so that the integral of phi is the
    /// solids' volume per area. `velocity_at` gives U_s at a node.
    pub fn pressure_drop(
        &self,
        grid: &ColumnGrid,
        fields: &ColumnFields,
        velocity_at: impl Fn(usize) -> f64,
    ) -> f64 {
        let drag = self.particle_drag();
        (0..grid.nodes())
            .filter(|&node| fields.solids_fraction[node] > 0.0)
            .map(|node| {
                let (phi, u_s) = (fields.solids_fraction[node], fields.solids_velocity[node]);
                let (shares, velocity) = (fields.share_density[node], velocity_at(node));
                let diameter = drag.share.diameter_of_equals(phi, shares);
                let beta = shares / drag.share.of(diameter)
                    * drag.per_velocity(diameter, phi, velocity - u_s);
                let width = grid.volume_of(node) / grid.cell_volume() * grid.spacing();
                let gas_velocity = u_s + (velocity - u_s) / (1.0 - phi);
                beta * (gas_velocity - fields.drag_velocity[node]) / (1.0 - phi) * width
            })
            .sum()
    }
}

/// Fields of the bed at the nodes of the column grid.
#[derive(Clone, Copy, Debug)]
pub struct ColumnFields<'a> {
    /// phi.
    pub solids_fraction: &'a [f64],
    /// u_s.
    pub solids_velocity: &'a [f64],
    /// Sum of the particles' shares of drag per volume.
    pub share_density: &'a [f64],
    /// u_d, drag-weighted mean velocity of the solids.
    pub drag_velocity: &'a [f64],
}
