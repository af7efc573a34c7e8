//! The gas as a case chooses it: what it is made of, what happens at the faces of the box, how it is coupled to the
//! particles.

use super::GAS_HALO;
use crate::domain::{BoxFace, Decomposition};
use crate::gas::ParticleDrag;
use crate::grid::{BoxGrid, LocalCells};
use crate::linear_solver::Tolerance;
use crate::numbers::Schedule;
use nalgebra::Vector3;

/// The volume-averaged gas and its coupling to the particles.
#[derive(Clone, Debug, PartialEq)]
pub struct VolumeAveragedModel {
    /// Its cells.
    pub grid: BoxGrid,
    /// What it is made of, and what happens at the faces of the box.
    pub gas: VolumeAveragedGas,
    /// How it is coupled to the particles.
    pub coupling: CouplingModel,
    /// Steps of the particles in one of the gas.
    pub substeps: u64,
    /// Driving force per volume of gas, for boxes through which nothing else moves it.
    pub driving: Vector3<f64>,
}

/// How particles and the gas on cells exchange momentum.
#[derive(Clone, Debug, PartialEq)]
pub struct CouplingModel {
    /// Drag on particles.
    pub drag: ParticleDrag,
    /// Full width at half maximum of the filter; 0 for none.
    pub filter_width: f64,
    /// Smallest voidage: lower ones are raised to it, and their cells counted.
    pub least_voidage: f64,
}

impl VolumeAveragedModel {
    /// A decomposition with its cut planes moved to cell faces, subdomains being at least `width` and two cells wide;
    /// none if there are too few cells.
    pub fn aligned(&self, decomposition: &Decomposition, width: f64) -> Option<Decomposition> {
        let cut_axes = (0..3).filter(|&axis| decomposition.grid().0[axis] > 1);
        let cells = cut_axes.map(|axis| (width / self.grid.spacing()[axis]).ceil() as usize);
        self.grid.aligned(decomposition, cells.max().unwrap_or(0).max(GAS_HALO))
    }
}

/// A gas that flows in three dimensions between the particles; see the [module](super) for its equations.
#[derive(Clone, Debug, PartialEq)]
pub struct VolumeAveragedGas {
    /// Density rho, constant.
    pub density: f64,
    /// Dynamic viscosity mu.
    pub viscosity: f64,
    /// What happens at the lower and the upper face along each axis.
    pub boundaries: [[Boundary; 2]; 3],
    /// How exactly each step obeys continuity: the norm of div(eps u) + d(eps)/dt that is left.
    pub tolerance: Tolerance,
}

/// What happens to the gas at a face of the box.
#[derive(Clone, Debug, PartialEq)]
pub enum Boundary {
    /// The box repeats.
    Periodic,
    /// A wall to which the gas sticks, and which may move in its own plane.
    NoSlip {
        /// Velocity of the wall; zero along its normal.
        velocity: Vector3<f64>,
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

impl VolumeAveragedGas {
    /// What happens at a face of the box.
    pub(super) fn boundary(&self, face: BoxFace) -> &Boundary {
        &self.boundaries[face.axis][face.side]
    }

    /// Whether gas can leave or enter through a face at a velocity that follows from the pressure.
    pub(super) fn is_outlet(&self, face: BoxFace) -> bool {
        matches!(self.boundary(face), Boundary::Outlet { .. })
    }

    /// Whether the gas has no boundary along an axis.
    pub(super) fn is_periodic(&self, axis: usize) -> bool {
        self.boundaries[axis][0] == Boundary::Periodic
    }

    /// Says what is wrong with these boundaries on this grid, if anything.
    ///
    /// # Errors
    /// In words: a number out of its range, an inlet without an outlet, too few cells.
    pub fn check(&self, grid: &BoxGrid) -> Result<(), String> {
        if !(self.density > 0.0 && self.viscosity >= 0.0) {
            return Err("the gas needs a density above 0 and a viscosity of at least 0".to_owned());
        }
        for face in BoxFace::ALL {
            self.check_face(grid, face)
                .map_err(|message| format!("gas at the face \"{face}\": {message}"))?;
        }
        let mut all = self.boundaries.iter().flatten();
        let has_inlet = all.clone().any(|boundary| matches!(boundary, Boundary::Inlet(_)));
        if has_inlet && !all.any(|boundary| matches!(boundary, Boundary::Outlet { .. })) {
            return Err("gas comes in through an inlet, so there must be an outlet".to_owned());
        }
        Ok(())
    }

    fn check_face(&self, grid: &BoxGrid, face: BoxFace) -> Result<(), String> {
        let (boundary, axis) = (self.boundary(face), face.axis);
        if (*boundary == Boundary::Periodic) != grid.is_periodic(axis) {
            return Err("it must be periodic where the box is, and only there".to_owned());
        }
        if *boundary != Boundary::Periodic && grid.counts()[axis] < LEAST_CELLS {
            return Err(format!(
                "between faces that are not periodic lie at least {LEAST_CELLS} cells"
            ));
        }
        match boundary {
            Boundary::NoSlip { velocity } if velocity[axis] != 0.0 => Err(format!(
                "a wall moves in its own plane, not at {} along its normal",
                velocity[axis]
            )),
            Boundary::Inlet(Inlet { profile: Profile::Table(numbers), .. }) => {
                let [first, second] = across(axis);
                let cells = grid.counts()[first] * grid.counts()[second];
                match numbers.len() == cells {
                    true => Ok(()),
                    false => {
                        Err(format!("the profile has {} numbers for {cells} cells", numbers.len()))
                    }
                }
            }
            _ => Ok(()),
        }
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
        let parabola = |axis: usize| match self.boundaries[axis][0] {
            Boundary::Periodic => 1.0,
            _ => {
                let s = (place(axis) as f64 + 0.5) / part.counts[axis] as f64;
                6.0 * s * (1.0 - s)
            }
        };
        let factor = match &inlet.profile {
            Profile::Uniform => 1.0,
            Profile::Parabolic => parabola(first) * parabola(second),
            Profile::Table(numbers) => numbers[place(first) + part.counts[first] * place(second)],
        };
        factor * inlet.velocity.at(time)
    }
}
