//! The volume-averaged gas, which flows in three dimensions between the particles: volume-averaged Navier-Stokes
//! equations of model A, with constant density.
//!
//! ```math
//! \begin{aligned}
//! \frac{\partial \varepsilon}{\partial t} + \nabla \cdot (\varepsilon \mathbf{u}) &= 0 \\
//! \rho \left[ \frac{\partial (\varepsilon \mathbf{u})}{\partial t} + \nabla \cdot (\varepsilon \mathbf{u} \mathbf{u}) \right]
//!   &= -\varepsilon \nabla p + \nabla \cdot (\varepsilon \boldsymbol{\tau}) - \beta \mathbf{u} + (\beta \mathbf{v})
//!   + \varepsilon (\rho \mathbf{g} + \mathbf{f}) \\
//! \boldsymbol{\tau} &= \mu \left[ \nabla \mathbf{u} + (\nabla \mathbf{u})^T - \tfrac{2}{3} (\nabla \cdot \mathbf{u}) \mathbf{I} \right]
//! \end{aligned}
//! ```
//!
//! eps is the voidage, u the velocity of the gas between the particles, p the pressure, rho the density, mu the
//! viscosity, beta the drag coefficient per volume, (beta v) its product with the velocities of the particles, g the
//! effective gravity and f the driving force. (Anderson & Jackson, Ind. Eng. Chem. Fundam. 6 (1967) 527-539; model A of
//! Gidaspow, Multiphase Flow and Fluidization, Academic Press (1994).)
//!
//! # On the grid
//!
//! * Velocities are stored on the faces of cells along their axis (Harlow & Welch, Phys. Fluids 8 (1965) 2182-2189),
//!   all other fields in cells. In a face eps, beta and (beta v) are the means of its two cells. The mean of two faces,
//!   with which u and grad p are interpolated to particles, is thus the adjoint of the action of the particles on the
//!   gas.
//! * Second order in space: the limiter of Koren for advection, central differences for the rest. Voidage and drag are
//!   mirrored beyond the box.
//! * The step is explicit for advection and viscosity, with a limit that is checked, and implicit for drag
//!   ([`NavierStokesSolver::advance`]). It is of second order in time if the voidage is steady and drag is weak,
//!   otherwise of first order, since drag and d(eps)/dt are those of the end of the step.
//! * The pressure is stored without the hydrostatic head rho g.x: gravity, even if it varies in time, is balanced to
//!   the last bit, and does not appear here. The force of this pressure on a particle of volume V is -V (grad p + rho
//!   g). Gas in a periodic box is held by the mean gradient that balances its weight.
//! * For the faces of the box, see [`Boundary`]; for a round column, see `round_wall`.

mod advection;
mod boundaries;
mod boundary;
mod exchange;
mod faces;
mod model;
mod momentum;
mod momentum_balance;
mod navier_stokes;
mod round_wall;
mod solver;
mod state;
mod viscosity;

pub use boundary::{
    Boundary, FaceConditions, Inlet, Jet, NormalVelocity, PressureCondition, Profile,
    TangentialVelocity, across,
};
pub use exchange::ParticleExchange;
pub use model::{CouplingModel, GAS_HALO, LargestInflow, VolumeAveragedGas, VolumeAveragedModel};
pub use navier_stokes::{NavierStokesReport, NavierStokesSolver, NavierStokesStep};
pub use solver::VolumeAveragedSolver;
pub use state::{BedOnGrid, GasFields, VolumeAveragedState};
