//! The volume-averaged gas, which flows in three dimensions between the particles: volume-averaged Navier-Stokes equations of model A,
//! constant density.
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
//! eps voidage, u velocity of the gas between the particles, p pressure, rho density, mu viscosity, beta drag
//! coefficient per volume, (beta v) its product with the velocities of the particles, g effective gravity, f driving
//! force. (Anderson & Jackson, Ind. Eng. Chem. Fundam. 6 (1967) 527-539; model A of Gidaspow, Multiphase Flow and
//! Fluidization, Academic Press (1994).)
//!
//! # On the grid
//!
//! * Velocities live on the faces of cells along their axis (Harlow & Welch, Phys. Fluids 8 (1965) 2182-2189), all
//!   else in cells. In a face eps, beta and (beta v) are the means of its two cells: so the mean of two faces, with
//!   which particles see u and grad p, is the adjoint of how the gas feels them.
//! * Second order in space: the limiter of Koren for advection, central differences for the rest. Voidage and
//!   drag go on beyond the box as in a mirror.
//! * The step is explicit for advection and viscosity, with a limit that is checked, and implicit for drag
//!   ([`NavierStokesSolver::advance`]). Second order in time where the voidage is steady and drag is weak, otherwise
//!   first: drag and d(eps)/dt are those of the end of the step.
//! * The pressure is kept less the hydrostatic head rho g.x: gravity, whatever it does in time, is balanced to the
//!   last bit, and does not appear here. A particle of volume V feels -V (grad p + rho g) of this pressure. Gas in a
//!   periodic box is held by the mean gradient that balances its weight.
//! * At the faces of the box: see [`Boundary`]. In a round column: see `round_wall`.

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
