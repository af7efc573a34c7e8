//! What lies beyond the faces of the box: cells and faces in the halo, set so that the same differences hold
//! there as inside.
//!
//! Halos between ranks are filled before. Axis by axis, over all that lies across the axis, halo included: so the
//! numbers in edges and corners do not depend on where the cuts are.

use super::faces::Region;
use super::{Boundary, VolumeAveragedGas};
use crate::domain::BoxFace;
use crate::grid::{Field, LocalCells};

/// A face of the box that this rank's cells reach.
#[derive(Clone, Copy)]
struct LocalFace {
    of: BoxFace,
    axis: usize,
    /// Place along the axis of the face itself: the lower face of the cell there.
    face: isize,
    /// The cell inside.
    inside: isize,
    /// Step along the axis that leads outwards.
    outwards: isize,
}

impl LocalFace {
    /// The faces of the box, not being periodic, that a part reaches.
    fn of(part: &LocalCells, gas: &VolumeAveragedGas) -> Vec<Self> {
        let reached =
            |face: &BoxFace| part.at_ends(face.axis)[face.side] && !gas.is_periodic(face.axis);
        let local = |of: BoxFace| {
            let (axis, count) = (of.axis, part.count[of.axis] as isize);
            match of.side {
                0 => Self { of, axis, face: 0, inside: 0, outwards: -1 },
                _ => Self { of, axis, face: count, inside: count - 1, outwards: 1 },
            }
        };
        BoxFace::ALL.into_iter().filter(reached).map(local).collect()
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

/// A cell moved to `place` along an axis.
fn placed(mut cell: [isize; 3], axis: usize, place: isize) -> [isize; 3] {
    cell[axis] = place;
    cell
}

/// Continues numbers on cells beyond the box as in a mirror: no gradient in the face.
pub(super) fn mirror(fields: &mut [&mut Field], part: &LocalCells, gas: &VolumeAveragedGas) {
    for face in LocalFace::of(part, gas) {
        for field in fields.iter_mut() {
            let halo = field.halo() as isize;
            for depth in 0..halo {
                let outside = face.inside + face.outwards * (depth + 1);
                for cell in face.layer(part, halo, outside) {
                    let inside = placed(cell, face.axis, face.inside - face.outwards * depth);
                    *field.at_mut(cell) = field.at(inside);
                }
            }
        }
    }
}

/// Continues the pressure beyond the box: linearly at walls and inlets; at an outlet so that the mean of the
/// cells inside and outside is the given pressure.
pub(super) fn continue_pressure(pressure: &mut Field, part: &LocalCells, gas: &VolumeAveragedGas) {
    for face in LocalFace::of(part, gas) {
        let outlet = match *gas.boundary(face.of) {
            Boundary::Outlet { pressure } => Some(pressure),
            _ => None,
        };
        for cell in face.layer(part, pressure.halo() as isize, face.inside + face.outwards) {
            let first = pressure.at(placed(cell, face.axis, face.inside));
            let second = pressure.at(placed(cell, face.axis, face.inside - face.outwards));
            *pressure.at_mut(cell) = match outlet {
                Some(given) => 2.0 * given - first,
                None => 2.0 * first - second,
            };
        }
    }
}

/// Continues a change of pressure beyond outlets, in which it is zero.
pub(super) fn continue_correction(change: &mut Field, part: &LocalCells, gas: &VolumeAveragedGas) {
    let outlets = |face: &LocalFace| gas.is_outlet(face.of);
    for face in LocalFace::of(part, gas).into_iter().filter(outlets) {
        for cell in face.layer(part, change.halo() as isize, face.inside + face.outwards) {
            *change.at_mut(cell) = -change.at(placed(cell, face.axis, face.inside));
        }
    }
}

/// Sets the velocity in the faces of walls and inlets; in outlets it stays. Before halos between ranks are filled:
/// the next rank has a narrow part's face in its halo.
pub(super) fn set_boundary_faces(
    velocity: &mut [Field; 3],
    voidage: &Field,
    (part, gas): (&LocalCells, &VolumeAveragedGas),
    time: f64,
) {
    for face in LocalFace::of(part, gas) {
        let component = &mut velocity[face.axis];
        for cell in face.layer(part, component.halo() as isize, face.face) {
            match gas.boundary(face.of) {
                Boundary::Inlet(inlet) => {
                    let inflow = gas.inflow(inlet, time, part, (face.axis, cell));
                    let inwards = -face.outwards as f64;
                    let voidage = voidage_in_face(voidage, cell, face.axis);
                    *component.at_mut(cell) = inwards * inflow / voidage;
                }
                Boundary::NoSlip { .. } | Boundary::FreeSlip => *component.at_mut(cell) = 0.0,
                Boundary::Outlet { .. } | Boundary::Periodic => {}
            }
        }
    }
}

/// Continues the velocity beyond the box, once it is known in the faces of the box.
///
/// Along its normal a component is continued linearly through the face, so that it is odd at a wall; beyond an
/// outlet it stays as it is in the face. A component along the face has the velocity of the wall in it, or of an
/// inlet (zero), or no gradient.
pub(super) fn continue_velocity(
    velocity: &mut [Field; 3],
    (part, gas): (&LocalCells, &VolumeAveragedGas),
) {
    for face in LocalFace::of(part, gas) {
        let boundary = gas.boundary(face.of);
        continue_normal(&mut velocity[face.axis], (part, boundary), face);
        let [normal, first, second] = disjoint(velocity, face.axis);
        for (component, axis) in [first, second].into_iter().zip(super::model::across(face.axis)) {
            continue_tangential(component, normal, (part, boundary), (face, axis));
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

fn continue_normal(
    component: &mut Field,
    (part, boundary): (&LocalCells, &Boundary),
    face: LocalFace,
) {
    let halo = component.halo() as isize;
    let is_outlet = matches!(boundary, Boundary::Outlet { .. });
    // Lower faces: the halo holds one more below the box than above it.
    for depth in 1..=halo - face.of.side as isize {
        for cell in face.layer(part, halo, face.face + face.outwards * depth) {
            let in_face = component.at(placed(cell, face.axis, face.face));
            let inside = component.at(placed(cell, face.axis, face.face - face.outwards * depth));
            *component.at_mut(cell) = if is_outlet { in_face } else { 2.0 * in_face - inside };
        }
    }
}

fn continue_tangential(
    component: &mut Field,
    normal: &Field,
    (part, boundary): (&LocalCells, &Boundary),
    (face, axis): (LocalFace, usize),
) {
    let halo = component.halo() as isize;
    for depth in 0..halo {
        for cell in face.layer(part, halo, face.inside + face.outwards * (depth + 1)) {
            let inside = component.at(placed(cell, face.axis, face.inside - face.outwards * depth));
            *component.at_mut(cell) = match boundary {
                Boundary::NoSlip { velocity } => 2.0 * velocity[axis] - inside,
                Boundary::Inlet(_) => -inside,
                Boundary::FreeSlip | Boundary::Periodic => inside,
                Boundary::Outlet { .. } => {
                    let here = placed(cell, face.axis, face.face);
                    let below = placed(here, axis, (here[axis] - 1).max(-halo));
                    let outflow = (normal.at(below) + normal.at(here)) * face.outwards as f64;
                    if outflow < 0.0 { -inside } else { inside }
                }
            };
        }
    }
}
