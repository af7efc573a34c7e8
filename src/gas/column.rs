//! A column of gas: one-dimensional, incompressible, without inertia.

use super::DragLaw;
use crate::numbers::Schedule;

/// The gas as the case chose it. Continuity of the mixture gives (1 - phi) u_g + phi u_s = U_s, Darcy's law
/// -dp/dz = beta (u_g - u_s) / (1 - phi) (Moon 2006 eqs (6), (7), (11)).
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnGas {
    /// Distance dz of the grid nodes; a divisor of the box length where the box is periodic.
    pub spacing: f64,
    /// Drag law.
    pub drag: DragLaw,
    /// Gas viscosity mu_g.
    pub viscosity: f64,
    /// Gas density rho_g; only drag laws with a Reynolds number use it.
    pub density: f64,
    /// What sets the superficial velocity.
    pub drive: Drive,
    /// Whether the gas, which has no lateral velocity, resists lateral motion: -(V / phi) beta v.
    pub lateral_drag: bool,
    /// Volume of the node on the plate.
    pub base_node: BaseNode,
}

/// What sets the superficial velocity U_s.
#[derive(Clone, Debug, PartialEq)]
pub enum Drive {
    /// The case prescribes it.
    Velocity(Schedule),
    /// The gas carries the weight of a fully periodic box at every instant (Moon 2006 eq. (18)).
    Weight(WeightBalance),
}

/// Which pressure drop equals the weight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WeightBalance {
    /// The total gas force on the particles: exact balance, no drift.
    ParticleForce,
    /// The integral of beta (U_s - u_s) / (1 - phi)^2 over the grid, as the equation is written; the
    /// box drifts by up to 1 % of gravity.
    GridIntegral,
}

/// The averaging volume of the node that lies on the plate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BaseNode {
    /// A full cell of which half lies below the plate: phi is halved there (Moon 2006 eq. (9) as written).
    FullCell,
    /// The half cell above the plate.
    HalfCell,
}
