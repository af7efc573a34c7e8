//! The volume-averaged gas that a case chooses: its properties, its boundaries at the faces of the box, and its
//! coupling to the particles.

use super::boundary::{
    Boundary, FaceConditions, Inlet, NormalVelocity, Profile, TangentialVelocity, across,
};
use crate::domain::{Bounds, BoxFace, Decomposition, Face, Wall};
use crate::gas::{AgglomerateDrag, ParticleDrag};
use crate::grid::{BoxGrid, LocalCells, RoundColumn};
use crate::linear_solver::Tolerance;
use crate::numbers::Schedule;
use nalgebra::Vector3;

/// Width of the halo of every field of the gas: the limiter uses two cells on each side.
pub const GAS_HALO: usize = 2;

/// The volume-averaged gas and its coupling to the particles.
#[derive(Clone, Debug, PartialEq)]
pub struct VolumeAveragedModel {
    /// Its cells.
    pub grid: BoxGrid,
    /// The round column in which it flows; `None` if it fills the box.
    pub column: Option<RoundColumn>,
    /// Properties of the gas, and its boundaries at the faces of the box.
    pub gas: VolumeAveragedGas,
    /// Coupling to the particles.
    pub coupling: CouplingModel,
    /// Number of steps of the particles in one step of the gas.
    pub substeps: u64,
    /// Driving force per volume of gas, for boxes through which nothing else moves it.
    pub driving: Vector3<f64>,
}

/// Exchange of momentum between the particles and a gas on cells.
#[derive(Clone, Debug, PartialEq)]
pub struct CouplingModel {
    /// Drag on particles.
    pub drag: ParticleDrag,
    /// Dependence of the drag on agglomerates, if there is any.
    pub agglomerates: Option<AgglomerateDrag>,
    /// Full width at half maximum of the filter; 0 for none.
    pub filter_width: f64,
    /// Whether drag laws use the gas as it would be without the particle itself.
    pub undisturbed: bool,
    /// Refinement, along each axis, of the cells whose voidage drag laws use; `None` if they use that of the gas's own
    /// cells, filtered.
    pub local_voidage: Option<usize>,
    /// Smallest voidage: lower values are raised to it, and their cells counted.
    pub least_voidage: f64,
}

/// Superficial velocities into the box over the face of an inlet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LargestInflow {
    /// Their mean.
    pub mean: f64,
    /// The largest magnitude.
    pub peak: f64,
}

impl VolumeAveragedModel {
    /// A decomposition with its cut planes moved to cell faces, with subdomains at least `width` and two cells wide;
    /// `None` if there are too few cells.
    pub fn aligned(&self, decomposition: &Decomposition, width: f64) -> Option<Decomposition> {
        let cells = |spacing: f64| GAS_HALO.max((width / spacing).ceil() as usize);
        self.grid.aligned(decomposition, self.grid.spacing().map(cells).into())
    }

    /// The finest cells on which particles are deposited.
    pub fn finest_cells(&self) -> BoxGrid {
        self.grid.refined(self.coupling.local_voidage.unwrap_or(1))
    }

    /// Inflow through an inlet while its velocities are at their largest.
    pub fn largest_inflow(&self, face: BoxFace, inlet: &Inlet) -> LargestInflow {
        let (axis, counts) = (face.axis, self.grid.counts());
        let [first, second] = across(axis);
        let cells = (0..counts[second]).flat_map(|j| (0..counts[first]).map(move |i| [i, j]));
        let open = |[i, j]: [usize; 2]| match &self.column {
            Some(column) if axis == 2 => column.open_fraction([i as isize, j as isize]),
            _ => 1.0,
        };
        let velocity = |place| {
            let cell = FaceCell { axis, place };
            (open(place), self.gas.velocity_in_cell(inlet, counts, cell, &Schedule::largest))
        };
        let (mut area, mut sum, mut peak) = (0.0, 0.0, 0.0_f64);
        for (open, velocity) in cells.map(velocity).filter(|(open, _)| *open > 0.0) {
            (area, sum, peak) = (area + open, sum + open * velocity, peak.max(velocity.abs()));
        }
        LargestInflow { mean: sum / area, peak }
    }
}

/// A gas that flows in three dimensions between the particles; see the [module](super) for its equations.
#[derive(Clone, Debug, PartialEq)]
pub struct VolumeAveragedGas {
    /// Density rho, constant.
    pub density: f64,
    /// Dynamic viscosity mu.
    pub viscosity: f64,
    /// Boundaries at the lower and the upper face along each axis.
    pub boundaries: [[Boundary; 2]; 3],
    /// Accuracy of continuity in each step: the norm of the remaining div(eps u) + d(eps)/dt.
    pub tolerance: Tolerance,
}

impl VolumeAveragedGas {
    /// This gas with the walls of a run: if it sticks to a face of the box, the face moves like the wall in it that
    /// particles touch.
    pub fn with_walls(mut self, bounds: &Bounds, walls: &[Wall]) -> Self {
        for face in BoxFace::ALL.into_iter().filter(|&face| bounds.face(face) == Face::Wall) {
            if let Some(wall) = walls.iter().find(|wall| wall.face == Some(face)) {
                let boundary = &mut self.boundaries[face.axis][face.side];
                *boundary = std::mem::replace(boundary, Boundary::Periodic).with_wall(wall.motion);
            }
        }
        self
    }

    /// Conditions at a face of the box; `None` if it is periodic.
    pub(super) fn conditions(&self, face: BoxFace) -> Option<FaceConditions<'_>> {
        self.boundaries[face.axis][face.side].conditions()
    }

    /// Velocity of the gas outside a face, if the momentum balance determines whether gas leaves or comes back through
    /// it.
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

    /// The faces with inlets, and the inlets.
    pub fn inlets(&self) -> impl Iterator<Item = (BoxFace, &Inlet)> {
        BoxFace::ALL.into_iter().filter_map(|face| match self.conditions(face)?.normal {
            NormalVelocity::Fixed(inlet) => inlet.map(|inlet| (face, inlet)),
            NormalVelocity::FromMomentum { .. } => None,
        })
    }

    /// Checks these boundaries on this grid.
    ///
    /// # Errors
    /// A message on a number out of its range, an inlet without an outlet, or too few cells.
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

/// Smallest number of cells: with fewer, boundaries on both sides of a cell would act on one face at once.
const LEAST_CELLS: usize = 3;

/// The model on this rank's part of the grid.
#[derive(Clone, Copy)]
pub(super) struct LocalGas<'a> {
    pub(super) part: &'a LocalCells,
    pub(super) gas: &'a VolumeAveragedGas,
}

impl VolumeAveragedGas {
    /// Superficial velocity into the box at a time, in a cell of the face normal to `axis`; `cell` counts from
    /// the part's first one and may lie in its halo.
    pub(super) fn inflow(
        &self,
        inlet: &Inlet,
        time: f64,
        part: &LocalCells,
        axis: usize,
        cell: [isize; 3],
    ) -> f64 {
        let [first, second] = across(axis);
        let place = |axis: usize| {
            let global = part.start[axis] as isize + cell[axis];
            global.rem_euclid(part.counts[axis] as isize) as usize
        };
        let cell = FaceCell { axis, place: [place(first), place(second)] };
        self.velocity_in_cell(inlet, part.counts, cell, &|velocity| velocity.at(time))
    }

    /// Superficial velocity into the box in a cell of an inlet; `counts` are the cells of the box, and `value` selects
    /// the value of a velocity to be used.
    fn velocity_in_cell(
        &self,
        inlet: &Inlet,
        counts: [usize; 3],
        cell: FaceCell,
        value: &dyn Fn(&Schedule) -> f64,
    ) -> f64 {
        let around = self.profile_factor(inlet, counts, cell) * value(&inlet.velocity);
        match &inlet.jet {
            None => around,
            Some(jet) => {
                let [i, j] = cell.place;
                let covered = jet.covered[0][i] * jet.covered[1][j];
                covered * value(&jet.velocity) + (1.0 - covered) * around
            }
        }
    }

    /// Ratio of the profile's velocity in a cell of an inlet to the given one.
    fn profile_factor(&self, inlet: &Inlet, counts: [usize; 3], cell: FaceCell) -> f64 {
        let [first, second] = across(cell.axis);
        let parabola = |axis: usize, place: usize| {
            if self.is_periodic(axis) {
                return 1.0;
            }
            let s = (place as f64 + 0.5) / counts[axis] as f64;
            6.0 * s * (1.0 - s)
        };
        let [i, j] = cell.place;
        match &inlet.profile {
            Profile::Uniform => 1.0,
            Profile::Parabolic => parabola(first, i) * parabola(second, j),
            Profile::Table(numbers) => numbers[i + counts[first] * j],
        }
    }
}

/// A cell of a face of the box.
#[derive(Clone, Copy)]
struct FaceCell {
    /// The axis normal to the face.
    axis: usize,
    /// Number of the cell along each of the two axes of the face.
    place: [usize; 2],
}
