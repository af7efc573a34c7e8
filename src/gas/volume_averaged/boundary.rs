//! What happens to the gas at a face of the box, as a case chooses it and as the kernels see it.
//!
//! | [`Boundary`] | velocity along the normal | across it | pressure |
//! | --- | --- | --- | --- |
//! | `NoSlip` | 0 | that of the wall | extrapolated |
//! | `FreeSlip` | 0 | no gradient | extrapolated |
//! | `Inlet` | given flux eps u | 0 | extrapolated |
//! | `Outlet` | from momentum; no gradient | no gradient; 0 where gas comes back | given in the face |
//!
//! In an outlet the normal stress is taken not to vary along the normal: where it does, errors are of first order.
//! Gas that comes back brings no momentum. A boundary is one arm of [`Boundary::conditions`]: kernels see only the
//! conditions.

use super::VolumeAveragedGas;
use crate::domain::{Bounds, BoxFace, Face, Wall, WallMotion};
use crate::grid::{BoxGrid, LocalCells};
use crate::numbers::Schedule;
use nalgebra::Vector3;

/// What happens to the gas at a face of the box.
#[derive(Clone, Debug, PartialEq)]
pub enum Boundary {
    /// The box repeats.
    Periodic,
    /// A wall to which the gas sticks, and which may move in its own plane.
    NoSlip {
        /// Motion of the wall, none along its normal.
        motion: WallMotion,
    },
    /// A wall along which the gas slides without friction.
    FreeSlip,
    /// Gas comes in, along the normal.
    Inlet(Inlet),
    /// The gas leaves against a given pressure, without gradients of velocity along the normal. Where it comes
    /// back it was at rest outside.
    Outlet {
        /// Pressure in the face, less the hydrostatic head.
        pressure: f64,
    },
}

/// Gas that comes in through a face.
#[derive(Clone, Debug, PartialEq)]
pub struct Inlet {
    /// Superficial velocity eps u into the box, at each time.
    pub velocity: Schedule,
    /// How it is spread over the face.
    pub profile: Profile,
}

/// Velocity over a face, relative to the one that is given.
#[derive(Clone, Debug, PartialEq)]
pub enum Profile {
    /// The same everywhere.
    Uniform,
    /// 6 s (1 - s) along each axis of the face that is not periodic, s from 0 to 1 across the box: the given
    /// velocity is the mean.
    Parabolic,
    /// One number for each cell of the face, the first of its two axes fastest.
    Table(Vec<f64>),
}

/// What holds for the gas in a face of the box that does not repeat: all that the kernels know of a boundary.
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
    /// That of an inlet, or zero.
    Fixed(Option<&'a Inlet>),
    /// From the momentum balance in the face, without a gradient along the normal.
    FromMomentum {
        /// Velocity of the gas outside, which it brings along where it comes in.
        outside: Vector3<f64>,
    },
}

/// Velocity in the plane of a face.
#[derive(Clone, Copy, Debug)]
pub enum TangentialVelocity {
    /// That of a wall in this motion.
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
    /// Velocity of the gas outside, if gas leaves and comes back as the momentum balance says.
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

    /// What it means for the gas; nothing where the box repeats.
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

    /// The same boundary in a face whose wall, which particles touch, moves like this.
    fn with_wall(self, wall: WallMotion) -> Self {
        match self {
            Self::NoSlip { .. } => Self::NoSlip { motion: wall },
            Self::Periodic | Self::FreeSlip | Self::Inlet(_) | Self::Outlet { .. } => self,
        }
    }
}

impl VolumeAveragedGas {
    /// The same gas beside the walls of a run: where it sticks to a face of the box, the face moves as the wall in it
    /// that particles touch.
    pub fn with_walls(mut self, bounds: &Bounds, walls: &[Wall]) -> Self {
        for face in BoxFace::ALL.into_iter().filter(|&face| bounds.face(face) == Face::Wall) {
            let mut in_face = walls.iter().filter(|wall| wall.name == Wall::name_in_face(face));
            if let Some(wall) = in_face.next() {
                let boundary = &mut self.boundaries[face.axis][face.side];
                *boundary = std::mem::replace(boundary, Boundary::Periodic).with_wall(wall.motion);
            }
        }
        self
    }

    /// What happens at a face of the box; nothing where it repeats.
    pub(super) fn conditions(&self, face: BoxFace) -> Option<FaceConditions<'_>> {
        self.boundaries[face.axis][face.side].conditions()
    }

    /// Velocity of the gas outside of a face, if gas leaves and comes back through it as the momentum balance says.
    pub(super) fn velocity_outside(&self, face: BoxFace) -> Option<Vector3<f64>> {
        self.conditions(face)?.normal.outside()
    }

    /// The pressure in a face, if it is given.
    pub(super) fn given_pressure(&self, face: BoxFace) -> Option<f64> {
        self.conditions(face)?.pressure.given()
    }

    /// Whether the gas has no boundary along an axis.
    pub(super) fn is_periodic(&self, axis: usize) -> bool {
        self.boundaries[axis][0].conditions().is_none()
    }

    /// The faces through which gas comes in, and how.
    pub fn inlets(&self) -> impl Iterator<Item = (BoxFace, &Inlet)> {
        BoxFace::ALL.into_iter().filter_map(|face| match self.conditions(face)?.normal {
            NormalVelocity::Fixed(inlet) => inlet.map(|inlet| (face, inlet)),
            NormalVelocity::FromMomentum { .. } => None,
        })
    }

    /// Says what is wrong with these boundaries on this grid, if anything.
    ///
    /// # Errors
    /// With a message: a number out of its range, an inlet without an outlet, too few cells.
    pub fn check(&self, grid: &BoxGrid) -> Result<(), String> {
        if !(self.density > 0.0 && self.viscosity >= 0.0) {
            return Err("the gas needs a density above 0 and a viscosity of at least 0".to_owned());
        }
        for face in BoxFace::ALL {
            self.check_face(grid, face)
                .map_err(|message| format!("gas at the face \"{face}\": {message}"))?;
        }
        let has_outlet = BoxFace::ALL.into_iter().any(|face| self.given_pressure(face).is_some());
        if self.inlets().next().is_some() && !has_outlet {
            return Err("gas comes in through an inlet, so there must be an outlet".to_owned());
        }
        Ok(())
    }

    fn check_face(&self, grid: &BoxGrid, face: BoxFace) -> Result<(), String> {
        let (boundary, axis) = (&self.boundaries[face.axis][face.side], face.axis);
        if (*boundary == Boundary::Periodic) != grid.is_periodic(axis) {
            return Err("it must be periodic where the box is, and only there".to_owned());
        }
        if *boundary != Boundary::Periodic && grid.counts()[axis] < LEAST_CELLS {
            return Err(format!(
                "between faces that are not periodic lie at least {LEAST_CELLS} cells"
            ));
        }
        let Some(conditions) = boundary.conditions() else { return Ok(()) };
        if let TangentialVelocity::Value(motion) = conditions.tangential {
            let (velocity, amplitude) = (motion.velocity[axis], motion.amplitude[axis]);
            if velocity != 0.0 || amplitude != 0.0 {
                return Err(format!(
                    "a wall moves in its own plane, not at {velocity} along its normal, nor with an amplitude of \
                     {amplitude} there"
                ));
            }
        }
        if let NormalVelocity::Fixed(Some(inlet)) = conditions.normal
            && let Profile::Table(numbers) = &inlet.profile
        {
            let [first, second] = across(axis);
            let cells = grid.counts()[first] * grid.counts()[second];
            if numbers.len() != cells {
                let count = numbers.len();
                return Err(format!("the profile has {count} numbers for {cells} cells"));
            }
        }
        Ok(())
    }
}

/// Boundaries on both sides of a cell would act on one face at once.
const LEAST_CELLS: usize = 3;

/// The two axes across `axis`, in order.
pub(super) fn across(axis: usize) -> [usize; 2] {
    [[1, 2], [0, 2], [0, 1]][axis]
}

impl VolumeAveragedGas {
    /// Superficial velocity into the box at a time, in a cell of the face normal to `axis`; `cell` counts from
    /// the part's first one and may lie in its halo.
    pub(super) fn inflow(
        &self,
        inlet: &Inlet,
        time: f64,
        part: &LocalCells,
        (axis, cell): (usize, [isize; 3]),
    ) -> f64 {
        let [first, second] = across(axis);
        let place = |axis: usize| {
            let global = part.start[axis] as isize + cell[axis];
            global.rem_euclid(part.counts[axis] as isize) as usize
        };
        let parabola = |axis: usize| {
            if self.is_periodic(axis) {
                return 1.0;
            }
            let s = (place(axis) as f64 + 0.5) / part.counts[axis] as f64;
            6.0 * s * (1.0 - s)
        };
        let factor = match &inlet.profile {
            Profile::Uniform => 1.0,
            Profile::Parabolic => parabola(first) * parabola(second),
            Profile::Table(numbers) => numbers[place(first) + part.counts[first] * place(second)],
        };
        factor * inlet.velocity.at(time)
    }
}
