//! Boundary conditions of the gas at a face of the box, as a case chooses them and as the kernels use them.
//!
//! | [`Boundary`] | velocity along the normal | across it | pressure |
//! | --- | --- | --- | --- |
//! | `NoSlip` | 0 | that of the wall | extrapolated |
//! | `FreeSlip` | 0 | no gradient | extrapolated |
//! | `Inlet` | given flux eps u | 0 | extrapolated |
//! | `Outlet` | from momentum; no gradient | no gradient; 0 where gas comes back | given in the face |
//!
//! In an outlet the normal stress is assumed not to vary along the normal; if it does, errors are of first order. Gas
//! that comes back carries no momentum. [`Boundary::conditions`] translates a boundary into conditions, which are all
//! that the kernels use.

use crate::domain::WallMotion;
use crate::numbers::Schedule;
use nalgebra::Vector3;

/// Boundary condition of the gas at a face of the box.
#[derive(Clone, Debug, PartialEq)]
pub enum Boundary {
    /// The box repeats.
    Periodic,
    /// A wall to which the gas sticks, and which may move in its own plane.
    NoSlip {
        /// Motion of the wall, which has no component along its normal.
        motion: WallMotion,
    },
    /// A wall along which the gas slides without friction.
    FreeSlip,
    /// Gas comes in, along the normal.
    Inlet(Inlet),
    /// The gas leaves against a given pressure, without gradients of velocity along the normal. Gas that comes back was
    /// at rest outside.
    Outlet {
        /// Pressure in the face, less the hydrostatic head.
        pressure: f64,
    },
}

/// Gas that comes in through a face.
#[derive(Clone, Debug, PartialEq)]
pub struct Inlet {
    /// Superficial velocity eps u into the box, as a function of time.
    pub velocity: Schedule,
    /// Distribution over the face.
    pub profile: Profile,
    /// A part of the face with a velocity of its own.
    pub jet: Option<Jet>,
}

/// A part of an inlet through which gas comes in at another velocity.
#[derive(Clone, Debug, PartialEq)]
pub struct Jet {
    /// Superficial velocity into the box, as a function of time.
    pub velocity: Schedule,
    /// The fraction of each cell that the jet covers along each of the two axes of the face, from 0 to 1.
    pub covered: [Vec<f64>; 2],
}

/// Velocity over a face, relative to the given one.
#[derive(Clone, Debug, PartialEq)]
pub enum Profile {
    /// Uniform over the face.
    Uniform,
    /// 6 s (1 - s) along each axis of the face that is not periodic, s from 0 to 1 across the box: the given
    /// velocity is the mean.
    Parabolic,
    /// One number for each cell of the face, the first of its two axes fastest.
    Table(Vec<f64>),
}

/// Conditions for the gas in a non-periodic face of the box: all that the kernels know of a boundary.
#[derive(Clone, Copy, Debug)]
pub struct FaceConditions<'a> {
    /// Velocity along the normal of the face.
    pub normal: NormalVelocity<'a>,
    /// Velocity in the plane of the face.
    pub tangential: TangentialVelocity,
    /// Pressure, less the hydrostatic head.
    pub pressure: PressureCondition,
}

/// Velocity along the normal of a face.
#[derive(Clone, Copy, Debug)]
pub enum NormalVelocity<'a> {
    /// A given velocity: that of an inlet, or zero.
    Fixed(Option<&'a Inlet>),
    /// From the momentum balance in the face, without a gradient along the normal.
    FromMomentum {
        /// Velocity of the gas outside, which gas that comes in carries.
        outside: Vector3<f64>,
    },
}

/// Velocity in the plane of a face.
#[derive(Clone, Copy, Debug)]
pub enum TangentialVelocity {
    /// Velocity of a wall in this motion.
    Value(WallMotion),
    /// No gradient along the normal.
    NoGradient,
}

/// Pressure in a face.
#[derive(Clone, Copy, Debug)]
pub enum PressureCondition {
    /// Given.
    Value(f64),
    /// Extrapolated from the cells inside.
    Extrapolated,
}

impl NormalVelocity<'_> {
    /// Velocity of the gas outside, if the momentum balance determines whether gas leaves or comes back.
    pub(super) fn outside(self) -> Option<Vector3<f64>> {
        match self {
            Self::FromMomentum { outside } => Some(outside),
            Self::Fixed(_) => None,
        }
    }
}

impl PressureCondition {
    /// The pressure in the face, if it is given.
    pub(super) fn given(self) -> Option<f64> {
        match self {
            Self::Value(pressure) => Some(pressure),
            Self::Extrapolated => None,
        }
    }
}

impl Boundary {
    /// A wall at rest to which the gas sticks; in a run it moves as the domain's wall in the same face.
    pub const NO_SLIP: Self = Self::NoSlip { motion: WallMotion::REST };

    /// Conditions for the gas; `None` for a periodic face.
    pub fn conditions(&self) -> Option<FaceConditions<'_>> {
        let conditions = match self {
            Self::Periodic => return None,
            Self::NoSlip { motion } => FaceConditions {
                normal: NormalVelocity::Fixed(None),
                tangential: TangentialVelocity::Value(*motion),
                pressure: PressureCondition::Extrapolated,
            },
            Self::FreeSlip => FaceConditions {
                normal: NormalVelocity::Fixed(None),
                tangential: TangentialVelocity::NoGradient,
                pressure: PressureCondition::Extrapolated,
            },
            Self::Inlet(inlet) => FaceConditions {
                normal: NormalVelocity::Fixed(Some(inlet)),
                tangential: TangentialVelocity::Value(WallMotion::REST),
                pressure: PressureCondition::Extrapolated,
            },
            Self::Outlet { pressure } => FaceConditions {
                normal: NormalVelocity::FromMomentum { outside: Vector3::zeros() },
                tangential: TangentialVelocity::NoGradient,
                pressure: PressureCondition::Value(*pressure),
            },
        };
        Some(conditions)
    }

    /// This boundary in a face with a wall, touched by particles, that has this motion.
    pub(super) fn with_wall(self, wall: WallMotion) -> Self {
        match self {
            Self::NoSlip { .. } => Self::NoSlip { motion: wall },
            Self::Periodic | Self::FreeSlip | Self::Inlet(_) | Self::Outlet { .. } => self,
        }
    }
}

/// The two axes across `axis`, in order.
pub fn across(axis: usize) -> [usize; 2] {
    [[1, 2], [0, 2], [0, 1]][axis]
}
