//! Errors of a setup.

use super::LayoutError;
use talcum_engine::time_step::StepError;
use thiserror::Error;

/// Reason why a bed cannot be set up or started; it is equal on all ranks.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SetupError {
    /// A box without extent.
    #[error("box: the length along {axis} is {length}: must be a number above 0")]
    BoxLength {
        /// The axis.
        axis: &'static str,
        /// The length.
        length: f64,
    },
    /// A face is periodic, the opposite one is not.
    #[error("box: the faces along {axis} must both be periodic, or neither")]
    PeriodicFaces {
        /// The axis.
        axis: &'static str,
    },
    /// Two fields of one name.
    #[error("the particles already have a field \"{name}\": choose another name")]
    SameField {
        /// Name of the field.
        name: &'static str,
    },
    /// A snapshot with a custom field that the setup has not registered.
    #[error("the snapshot has the field \"{name}\", which this setup does not know: register it")]
    UnknownField {
        /// Name of the field.
        name: &'static str,
    },
    /// A periodic box in which a particle would meet two images of another particle at once.
    #[error(
        "box: the length along {axis} is {length}: must be at least {least}, twice the largest diameter with skin and range \
         of forces, as the box is periodic"
    )]
    NarrowBox {
        /// The axis.
        axis: &'static str,
        /// The length.
        length: f64,
        /// The least length.
        least: f64,
    },
    /// The force limit that follows from contact laws, cohesion and weight is 0, or not a number.
    #[error(
        "the largest force is {force}: must be a number above 0 whose square is in the range of numbers"
    )]
    ForceRange {
        /// The largest force.
        force: f64,
    },
    /// Neither particles nor sizes.
    #[error("there are no particles: give the sizes that limits follow from (Setup::sizes)")]
    NoSizes,
    /// A number that must be above 0.
    #[error("{quantity} is {value}: must be a number above 0")]
    NotPositive {
        /// The quantity.
        quantity: &'static str,
        /// The number.
        value: f64,
    },
    /// A particle with a quantity that is not valid.
    #[error("particle {id}: {quantity} is {value}: must be {allowed}")]
    Particle {
        /// Its id.
        id: u64,
        /// The quantity.
        quantity: &'static str,
        /// The value.
        value: String,
        /// Its allowed range.
        allowed: &'static str,
    },
    /// Two particles have one id.
    #[error("two particles have the id {id}")]
    SameId {
        /// The id.
        id: u64,
    },
    /// The ranks cannot divide the box.
    #[error(transparent)]
    Layout(#[from] LayoutError),
    /// The first lists or forces cannot be made.
    #[error(transparent)]
    Step(#[from] StepError),
}
