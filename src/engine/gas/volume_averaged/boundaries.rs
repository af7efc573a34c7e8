//! Values beyond the faces of the box: cells and faces in the halo are set so that the same differences hold there as
//! inside.
//!
//! Halos between ranks are filled before. The values are set axis by axis, over the whole range across the axis, halo
//! included, so that the numbers in edges and corners do not depend on the positions of the cuts.

use super::VolumeAveragedGas;
use super::boundary::{FaceConditions, NormalVelocity, TangentialVelocity, across};
use super::faces::Region;
use super::model::LocalGas;
use super::round_wall::RoundWall;
use crate::domain::BoxFace;
use crate::grid::{Field, LocalCells};

/// A face of the box that this rank's cells reach, and its conditions.
#[derive(Clone, Copy)]
struct LocalFace<'a> {
    conditions: FaceConditions<'a>,
    axis: usize,
    side: usize,
    /// Place along the axis of the face itself: the lower face of the cell there.
    face: isize,
    /// The cell inside.
    inside: isize,
    /// Step along the axis that points outwards.
    outwards: isize,
}

impl<'a> LocalFace<'a> {
    /// The non-periodic faces of the box that a part reaches.
    fn of(part: &LocalCells, gas: &'a VolumeAveragedGas) -> Vec<Self> {
        let local = |face: BoxFace| {
            let BoxFace { axis, side } = face;
            let conditions = gas.conditions(face).filter(|_| part.at_ends(axis)[side])?;
            let count = part.count[axis] as isize;
            let (face, inside, outwards) = [(0, 0, -1), (count, count - 1, 1)][side];
            Some(Self { conditions, axis, side, face, inside, outwards })
        };
        BoxFace::ALL.into_iter().filter_map(local).collect()
    }

    /// The cells at `place` along the axis, with halos across it.
    fn layer(
        self,
        part: &LocalCells,
        halo: isize,
        place: isize,
    ) -> impl Iterator<Item = [isize; 3]> {
        Region::widened(part, halo).layer(self.axis, place).cells()
    }
}

impl LocalFace<'_> {
    /// Places in memory of the cells at `place` along the axis, with halos across it, and the step from each to the
    /// next cell inwards. `for_each` goes through them in two nested loops, unlike a `for` loop.
    fn places(
        self,
        field: &Field,
        part: &LocalCells,
        place: isize,
    ) -> (impl Iterator<Item = usize> + use<>, isize) {
        let rows = Region::widened(part, field.halo() as isize).layer(self.axis, place).rows(field);
        (rows.flatten(), -self.outwards * field.strides()[self.axis] as isize)
    }
}

/// A place in memory moved by this number of steps.
#[inline(always)]
fn stepped(place: usize, steps: isize, step: isize) -> usize {
    place.wrapping_add_signed(steps * step)
}

/// A cell moved to `place` along an axis.
fn placed(mut cell: [isize; 3], axis: usize, place: isize) -> [isize; 3] {
    cell[axis] = place;
    cell
}

/// Mirrors numbers to cells beyond the box, so that there is no gradient in the face.
pub(super) fn mirror(fields: &mut [&mut Field], part: &LocalCells, gas: &VolumeAveragedGas) {
    for face in LocalFace::of(part, gas) {
        for field in fields.iter_mut() {
            let halo = field.halo() as isize;
            for depth in 0..halo {
                continue_tangential(field, (part, face, depth), |inside| inside);
            }
        }
    }
}

/// Continues the pressure beyond the box: linearly at walls and inlets; at an outlet such that the mean of the cells
/// inside and outside is the given pressure.
pub(super) fn continue_pressure(pressure: &mut Field, part: &LocalCells, gas: &VolumeAveragedGas) {
    for face in LocalFace::of(part, gas) {
        let given = face.conditions.pressure.given();
        let (places, inwards) = face.places(pressure, part, face.inside + face.outwards);
        let values = pressure.values_mut();
        places.for_each(|place| {
            let [first, second] = [1, 2].map(|steps| values[stepped(place, steps, inwards)]);
            values[place] = match given {
                Some(given) => 2.0 * given - first,
                None => 2.0 * first - second,
            };
        });
    }
}

/// Continues a change of pressure beyond faces with a given pressure: it is zero in the face.
pub(super) fn continue_correction(change: &mut Field, part: &LocalCells, gas: &VolumeAveragedGas) {
    let is_given = |face: &LocalFace| face.conditions.pressure.given().is_some();
    for face in LocalFace::of(part, gas).into_iter().filter(is_given) {
        let (places, inwards) = face.places(change, part, face.inside + face.outwards);
        let values = change.values_mut();
        places.for_each(|place| values[place] = -values[stepped(place, 1, inwards)]);
    }
}

/// Sets the velocity in the faces of walls and inlets; in outlets it is kept. Gas does not come in outside a round
/// wall. This is called before halos between ranks are filled, since the next rank has a narrow part's face in its
/// halo.
pub(super) fn set_boundary_faces(
    velocity: &mut [Field; 3],
    (voidage, wall): (&Field, Option<&RoundWall>),
    LocalGas { part, gas }: LocalGas,
    time: f64,
) {
    for face in LocalFace::of(part, gas) {
        let NormalVelocity::Fixed(inlet) = face.conditions.normal else { continue };
        let component = &mut velocity[face.axis];
        for cell in face.layer(part, component.halo() as isize, face.face) {
            let is_open = wall.is_none_or(|wall| wall.is_open(voidage, cell));
            *component.at_mut(cell) = inlet.filter(|_| is_open).map_or(0.0, |inlet| {
                let inflow = gas.inflow(inlet, time, part, face.axis, cell);
                let inwards = -face.outwards as f64;
                inwards * inflow / voidage_in_face(voidage, cell, face.axis)
            });
        }
    }
}

/// Continues the velocity beyond the box, once it is known in the faces of the box.
///
/// Along its normal a component is continued linearly through the face, so that it is odd at a wall; if it follows from
/// momentum, it is constant beyond the face. A component in the plane of the face has the velocity of a wall in it, at
/// this time, or no gradient.
pub(super) fn continue_velocity(
    velocity: &mut [Field; 3],
    LocalGas { part, gas }: LocalGas,
    time: f64,
) {
    for face in LocalFace::of(part, gas) {
        continue_normal(&mut velocity[face.axis], part, face);
        let [normal, first, second] = disjoint(velocity, face.axis);
        for (component, axis) in [first, second].into_iter().zip(across(face.axis)) {
            for depth in 0..component.halo() as isize {
                let at = (part, face, depth);
                let outside = face.conditions.normal.outside().map(|outside| outside[axis]);
                match (face.conditions.tangential, outside) {
                    (TangentialVelocity::Value(motion), _) => {
                        let wall = motion.velocity_at(time)[axis];
                        continue_tangential(component, at, |inside| 2.0 * wall - inside);
                    }
                    (TangentialVelocity::NoGradient, None) => {
                        continue_tangential(component, at, |inside| inside);
                    }
                    (TangentialVelocity::NoGradient, Some(outside)) => {
                        continue_through_opening(component, at, (normal, axis), outside);
                    }
                }
            }
        }
    }
}

/// The component along `axis`, and the other two in order.
fn disjoint(velocity: &mut [Field; 3], axis: usize) -> [&mut Field; 3] {
    let [x, y, z] = velocity;
    match axis {
        0 => [x, y, z],
        1 => [y, x, z],
        _ => [z, x, y],
    }
}

/// Voidage in the lower face of a cell along an axis.
fn voidage_in_face(voidage: &Field, cell: [isize; 3], axis: usize) -> f64 {
    0.5 * (voidage.at(placed(cell, axis, cell[axis] - 1)) + voidage.at(cell))
}

fn continue_normal(component: &mut Field, part: &LocalCells, face: LocalFace) {
    let halo = component.halo() as isize;
    let from_momentum = face.conditions.normal.outside().is_some();
    // Lower faces: the halo contains one more below the box than above it.
    for depth in 1..=halo - face.side as isize {
        let (places, inwards) = face.places(component, part, face.face + face.outwards * depth);
        let values = component.values_mut();
        places.for_each(|place| {
            let [in_face, inside] =
                [depth, 2 * depth].map(|steps| values[stepped(place, steps, inwards)]);
            values[place] = if from_momentum { in_face } else { 2.0 * in_face - inside };
        });
    }
}

/// Sets a component beyond a face from its value inside, at the same distance from the face.
#[inline(always)]
fn continue_tangential(
    component: &mut Field,
    (part, face, depth): (&LocalCells, LocalFace, isize),
    beyond: impl Fn(f64) -> f64,
) {
    let outside = face.inside + face.outwards * (depth + 1);
    let (places, inwards) = face.places(component, part, outside);
    let values = component.values_mut();
    let steps = 2 * depth + 1;
    places.for_each(|place| values[place] = beyond(values[stepped(place, steps, inwards)]));
}

/// Continues the velocity where gas may come in, which then carries the velocity of the gas outside.
fn continue_through_opening(
    component: &mut Field,
    (part, face, depth): (&LocalCells, LocalFace, isize),
    (normal, axis): (&Field, usize),
    outside: f64,
) {
    let halo = component.halo() as isize;
    for cell in face.layer(part, halo, face.inside + face.outwards * (depth + 1)) {
        let inside = component.at(placed(cell, face.axis, face.inside - face.outwards * depth));
        let comes_in = comes_in(normal, face, cell, axis);
        *component.at_mut(cell) = if comes_in { 2.0 * outside - inside } else { inside };
    }
}

/// Whether gas comes into the box through a face, near the lower face along `axis` of a cell.
fn comes_in(normal: &Field, face: LocalFace, cell: [isize; 3], axis: usize) -> bool {
    let here = placed(cell, face.axis, face.face);
    let below = placed(here, axis, (here[axis] - 1).max(-(normal.halo() as isize)));
    (normal.at(below) + normal.at(here)) * (face.outwards as f64) < 0.0
}
