//! The wall of a round column, around the gas.
//!
//! Where the wall cuts cells, the open fraction theta of each cell ([`RoundColumn`]) is used together with its voidage:
//! cells contain theta eps of gas per volume, a face has the mean theta of its two cells and, between an open and a
//! closed cell, nothing passes. All balances thus keep their form with theta eps, theta beta and theta (beta v) in
//! place of eps, beta and (beta v), and the pressure equation remains symmetric. (A porosity in place of cut cells:
//! Hirt & Sicilian, 4th Int. Conf. Numerical Ship Hydrodynamics (1985).)
//!
//! The gas sticks to the wall at the actual position of the wall: if the neighbour of a velocity u along an axis across
//! the column is closed, the viscous force per open volume contains
//!
//! ```math
//! -\frac{\mu \varepsilon\, u}{h\, \Delta x} \qquad \text{instead of} \qquad -\frac{\mu \varepsilon\, u}{\Delta x^2},
//! ```
//!
//! with h the distance of the wall along the axis. It is of second order in space (Gibou, Fedkiw, Cheng & Kang, J.
//! Comput. Phys. 176 (2002) 205-227), and implicit in time like drag, so that a small h does not require a small step.
//! For the component along that axis both terms are twice as large, as elsewhere.

use super::faces::{Layers, Region, moved};
use super::model::LocalGas;
use super::viscosity::{StressRows, ViscousFields, add_viscous_force};
use super::{BedOnGrid, GAS_HALO};
use crate::grid::{BoxGrid, ColumnOnCells, Field, LocalCells, RoundColumn};
use nalgebra::Vector3;

/// The wall of a round column on a rank's cells, and the bed in it per volume of whole cells.
#[derive(Clone, Debug)]
pub(super) struct RoundWall {
    cells: ColumnOnCells,
    /// mu k of the faces normal to each axis, where k is the sum of 1 / (h dx) over closed neighbours (see above);
    /// infinite in closed faces, so that the gas in them is at rest.
    pub(super) friction: [Field; 3],
    /// Neighbours of faces of each component across the wall.
    closed_neighbours: [Vec<ClosedNeighbour>; 3],
    /// theta eps, theta beta, theta (beta v); 1 and 0 in closed cells.
    pub(super) bed: BedOnGrid,
    /// theta eps at the beginning of the step.
    pub(super) voidage_before: Field,
}

/// A face without an open neighbour on one side along an axis across the column.
#[derive(Clone, Copy, Debug)]
struct ClosedNeighbour {
    /// Place of the face, counted from the part's first cell.
    place: [isize; 2],
    axis: usize,
    side: isize,
}

/// A component of the velocity, on the faces normal to its axis.
#[derive(Clone, Copy)]
struct Component<'a> {
    axis: usize,
    part: &'a LocalCells,
    spacing: Vector3<f64>,
    column: &'a RoundColumn,
}

impl Component<'_> {
    /// Whether both cells of a face are open.
    fn is_open(&self, [i, j]: [isize; 2]) -> bool {
        let below = match self.axis {
            0 => [i - 1, j],
            1 => [i, j - 1],
            _ => [i, j],
        };
        [[i, j], below].into_iter().all(|cell| self.column.open_fraction_in(self.part, cell) > 0.0)
    }

    /// Position of the velocity of a face, across the column.
    fn point(&self, place: [isize; 2]) -> [f64; 2] {
        [0, 1].map(|axis| {
            let half = if axis == self.axis { 0.0 } else { 0.5 };
            ((self.part.start[axis] as isize + place[axis]) as f64 + half) * self.spacing[axis]
        })
    }

    /// The closed neighbours of an open face.
    fn closed_neighbours(self, place: [isize; 2]) -> impl Iterator<Item = ClosedNeighbour> {
        let sides = [0, 1].into_iter().flat_map(|axis| [(axis, -1), (axis, 1)]);
        sides.filter_map(move |(axis, side)| {
            let mut neighbour = place;
            neighbour[axis] += side;
            (!self.is_open(neighbour)).then_some(ClosedNeighbour { place, axis, side })
        })
    }

    /// 1 / (h dx) of a closed neighbour; twice that along the component's own axis.
    fn friction_at(&self, neighbour: ClosedNeighbour) -> f64 {
        let ClosedNeighbour { place, axis, side } = neighbour;
        let spacing = self.spacing[axis];
        let distance = self.column.distance_to_wall(self.point(place), axis, side > 0);
        let factor = if axis == self.axis { 2.0 } else { 1.0 };
        factor / (distance.max(LEAST_DISTANCE * spacing) * spacing)
    }
}

/// Smallest distance, over the spacing: nearer walls already retard the gas fully.
const LEAST_DISTANCE: f64 = 1.0e-6;

impl RoundWall {
    /// A wall around a gas of this viscosity on a part of a grid.
    pub(super) fn new(
        grid: &BoxGrid,
        part: &LocalCells,
        column: &RoundColumn,
        viscosity: f64,
    ) -> Self {
        let zero = Field::new(part, GAS_HALO);
        let of = |axis: usize| Component { axis, part, spacing: grid.spacing(), column };
        Self {
            cells: ColumnOnCells::new(column, part, &zero),
            friction: [0, 1, 2].map(|axis| friction(of(axis), viscosity)),
            closed_neighbours: [0, 1, 2].map(|axis| closed_neighbours(of(axis))),
            bed: BedOnGrid::empty(part),
            voidage_before: zero,
        }
    }

    /// Whether the cells at a place across the column are open.
    pub(super) fn is_open(&self, field: &Field, cell: [isize; 3]) -> bool {
        self.cells.at(field.index(cell)) > 0.0
    }

    /// Sets the bed and the voidage at the beginning of the step from those per open volume, halos included.
    pub(super) fn set_bed(&mut self, bed: &BedOnGrid, voidage_before: &Field) {
        self.set_voidage(voidage_before);
        let Self { cells, bed: scaled, .. } = self;
        scale(cells, (&bed.voidage, 1.0), &mut scaled.voidage);
        scale(cells, (&bed.momentum_transfer, 0.0), &mut scaled.momentum_transfer);
        let to = &mut scaled.transferred_velocity;
        for (from, to) in bed.transferred_velocity.iter().zip(to) {
            scale(cells, (from, 0.0), to);
        }
    }

    /// Sets theta eps from a voidage, as the one at the beginning of a step.
    pub(super) fn set_voidage(&mut self, voidage: &Field) {
        scale(&self.cells, (voidage, 1.0), &mut self.voidage_before);
    }

    /// Adds the viscous force per volume of whole cells on the free faces of a component, without the part that is
    /// implicit in time. `force` is overwritten.
    pub(super) fn add_viscous_force(
        &self,
        [rate, force]: [&mut Field; 2],
        axis: usize,
        fields: ViscousFields,
        local: LocalGas,
        spacing: Vector3<f64>,
    ) {
        force.values_mut().fill(0.0);
        let all = Layers::all(local.part);
        let mut stresses = StressRows::default();
        add_viscous_force(force, axis, fields, (local, &all), (spacing, &mut stresses));
        for neighbour in &self.closed_neighbours[axis] {
            neighbour.take_out(force, axis, fields, (local, spacing));
        }
        let step = force.strides()[axis] as isize;
        for row in Region::free_faces(local.part, axis, local.gas).rows(rate) {
            let force = moved(force.values(), &row, 0);
            let first = row.start;
            for (i, rate) in rate.values_mut()[row].iter_mut().enumerate() {
                let here = first + i;
                let below = here.wrapping_add_signed(-step);
                *rate += 0.5 * (self.cells.at(below) + self.cells.at(here)) * force[i];
            }
        }
    }
}

impl ClosedNeighbour {
    /// Removes the contribution of the closed neighbour from the viscous force per open volume.
    fn take_out(
        &self,
        force: &mut Field,
        component: usize,
        fields: ViscousFields,
        (local, spacing): (LocalGas, Vector3<f64>),
    ) {
        let (u, eps) = (fields.velocity[component].values(), fields.voidage.values());
        let (strides, [i, j]) = (force.strides().map(|stride| stride as isize), self.place);
        let (own, step) = (strides[component], self.side * strides[self.axis]);
        let faces = Region::free_faces(local.part, component, local.gas);
        for k in faces.from[2]..faces.to[2] {
            let here = force.index([i, j, k]);
            let at = |values: &[f64], steps: isize| values[here.wrapping_add_signed(steps)];
            let voidage = if self.axis == component {
                2.0 * at(eps, if self.side > 0 { 0 } else { -own })
            } else {
                0.25 * ((at(eps, -own) + at(eps, 0)) + (at(eps, step - own) + at(eps, step)))
            };
            let width = spacing[self.axis];
            let slope = (at(u, step) - at(u, 0)) / width;
            force.values_mut()[here] -= local.gas.viscosity * voidage * slope / width;
        }
    }
}

/// theta times a field, and another value in closed cells.
fn scale(cells: &ColumnOnCells, (from, closed): (&Field, f64), to: &mut Field) {
    for ((value, open), to) in from.values().iter().zip(cells.values()).zip(to.values_mut()) {
        *to = if *open > 0.0 { open * value } else { closed };
    }
}

/// mu k of all faces of a component, halo included.
fn friction(component: Component, viscosity: f64) -> Field {
    let mut friction = Field::new(component.part, GAS_HALO);
    let Region { from, to } = Region::widened(component.part, GAS_HALO as isize);
    for (i, j) in (from[1]..to[1]).flat_map(|j| (from[0]..to[0]).map(move |i| (i, j))) {
        let coefficient = if component.is_open([i, j]) {
            let neighbours = component.closed_neighbours([i, j]);
            viscosity * neighbours.map(|it| component.friction_at(it)).sum::<f64>()
        } else {
            f64::INFINITY
        };
        for k in from[2]..to[2] {
            *friction.at_mut([i, j, k]) = coefficient;
        }
    }
    friction
}

/// The closed neighbours of the owned faces of a component.
fn closed_neighbours(component: Component) -> Vec<ClosedNeighbour> {
    let [nx, ny, _] = component.part.count.map(|count| count as isize);
    let places = (0..ny).flat_map(|j| (0..nx).map(move |i| [i, j]));
    let open = places.filter(|&place| component.is_open(place));
    open.flat_map(|place| component.closed_neighbours(place)).collect()
}
