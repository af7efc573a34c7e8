//! Reasons why a gas step fails.

use crate::linear_solver::LinearSolverError;
use thiserror::Error;

/// A gas force that exceeds its limit or is undefined.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum GasForceOutOfRange {
    /// The force on one particle.
    #[error(
        "the gas force on particle {particle} is {force:.3e} (limit {limit:.3e}) at a solids fraction of \
         {solids_fraction:.3}: particles overlap too much, or time.step is too long"
    )]
    Particle {
        /// Its id.
        particle: u64,
        /// A component of the force.
        force: f64,
        /// Its limit.
        limit: f64,
        /// Solids fraction at the particle.
        solids_fraction: f64,
    },
    /// A drag coefficient, force per velocity.
    #[error(
        "the drag of the gas on particle {particle} is {drag:.3e} per velocity (limit {limit:.3e}): the gas there \
         is too fast or undefined"
    )]
    Drag {
        /// Id of the particle.
        particle: u64,
        /// Its drag coefficient.
        drag: f64,
        /// Its limit.
        limit: f64,
    },
    /// A gas step that is too long for the drag.
    #[error(
        "in one gas step the drag takes {response:.3} of the velocity of particle {particle} relative to the gas \
         (b dt / (m eps^2), limit {limit}): use fewer gas.substeps or a shorter time.step"
    )]
    Response {
        /// Id of the particle.
        particle: u64,
        /// The fraction taken.
        response: f64,
        /// Its limit.
        limit: f64,
    },
    /// The force on the whole bed.
    #[error("no superficial velocity lets the gas carry the bed's weight (last tried: {0:.6e})")]
    NoBalance(f64),
    /// The absolute pressure in a compressible column gas is not positive.
    #[error(
        "the compressible gas would have a pressure of {pressure:.3e} at height {height:.3e}, less that above the bed \
         ({ambient:.3e}): the absolute pressure has to be above 0"
    )]
    Pressure {
        /// Pressure less that above the bed.
        pressure: f64,
        /// Height at which it occurs.
        height: f64,
        /// Absolute pressure above the bed.
        ambient: f64,
    },
    /// The velocity of a compressible column gas, whose drag depends on the Reynolds number, does not settle.
    #[error(
        "the velocity of the compressible gas does not settle within one step: shorten time.step"
    )]
    NotSettled,
}

/// Reason why a step of the equations of the volume-averaged gas is not possible; it is equal on all ranks.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum NavierStokesError {
    /// The step is too long for advection and viscosity, which are explicit.
    #[error(
        "the gas's step of {dt:.3e} is too long: 2 x {courant:.3} (Courant number) + {viscous:.3} / 2 (viscosity) may \
         not exceed 1; at this instant steps up to {longest:.3e} would do"
    )]
    StepTooLong {
        /// Length of the step.
        dt: f64,
        /// Courant number.
        courant: f64,
        /// Viscous number.
        viscous: f64,
        /// The longest step that is presently allowed.
        longest: f64,
    },
    /// A velocity or the voidage is undefined.
    #[error("the gas's velocity, or the voidage that it was given, is infinite or not a number")]
    NotFinite,
    /// The voidage is out of its range.
    #[error(
        "the gas was given voidages from {least} to {largest}; all must be above 0 and at most 1"
    )]
    Voidage {
        /// The smallest voidage, or 1.
        least: f64,
        /// The largest voidage.
        largest: f64,
    },
    /// The pressure equation has no solution.
    #[error(transparent)]
    Pressure(#[from] LinearSolverError),
}

/// Reason why a step of a gas is not possible.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum GasError {
    /// A force on a particle exceeds its limit or is undefined. It may differ between ranks.
    #[error(transparent)]
    Force(#[from] GasForceOutOfRange),
    /// The equations cannot be solved. The error is the same on all ranks.
    #[error(transparent)]
    Equations(#[from] NavierStokesError),
}
