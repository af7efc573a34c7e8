//! Advection of momentum by the gas.
//!
//! For component a, over the cell around a face (half of the cell below, half of the one above), with the volume flux
//! G = eps u through its faces, which is the mean of the fluxes of the two cells:
//!
//! ```math
//! -\rho \left[ \nabla \cdot (\mathbf{G} u_a) - u_a \nabla \cdot \mathbf{G} \right]
//! ```
//!
//! Discrete continuity is d(eps)/dt + div G = 0 in cells, and so in the mean of two. With it, the bracket equals
//! d(eps u_a)/dt + div(G u_a) less eps d(u_a)/dt. It is zero for a uniform velocity, even if the voidage changes, and
//! conserves momentum where the voidage is steady.
//!
//! u_a in the faces between is interpolated by the limiter of Koren: of third order where the profile is smooth and
//! monotonic, and never beyond the two neighbouring values.
//!
//! Koren, "A robust upwind discretization method for advection, diffusion and source terms", in Vreugdenhil &
//! Koren (eds), Numerical Methods for Advection-Diffusion Problems, Vieweg (1993) 117-138.

use super::faces::{Layers, Region, moved};
use super::model::LocalGas;
use crate::domain::BoxFace;
use crate::grid::{Field, LocalCells};
use crate::numbers::{Largest, vectorised};
use nalgebra::Vector3;
use std::ops::Range;

vectorised!(
    /// Volume fluxes eps u through all faces whose two cells are known.
    pub(super) fn set_fluxes(
        flux: &mut [Field; 3],
        velocity: &[Field; 3],
        voidage: &Field,
        part: &LocalCells,
    ) {
        let halo = voidage.halo() as isize;
        let strides = voidage.strides();
        for axis in 0..3 {
            let stride = strides[axis] as isize;
            let mut region = Region::widened(part, halo);
            region.from[axis] += 1;
            for row in region.rows(voidage) {
                let (below, above) =
                    (moved(voidage.values(), &row, -stride), moved(voidage.values(), &row, 0));
                let u = moved(velocity[axis].values(), &row, 0);
                set_fluxes_of_row([below, above], u, &mut flux[axis].values_mut()[row]);
            }
        }
    }
);

#[inline(always)]
fn set_fluxes_of_row([below, above]: [&[f64]; 2], u: &[f64], flux: &mut [f64]) {
    for i in 0..flux.len() {
        flux[i] = 0.5 * (below[i] + above[i]) * u[i];
    }
}

/// Advection by these fluxes. It is part of the work in wide vectors.
pub(super) struct Advection<'a> {
    flux: &'a [Field; 3],
    local: LocalGas<'a>,
    spacing: Vector3<f64>,
    between: FacesBetween,
}

/// Faces between the cells around the faces of a row: each row passes its upper ones on to the next row.
#[derive(Default)]
struct FacesBetween {
    flux: Vec<f64>,
    /// The velocity carried by the flux.
    carried: Vec<f64>,
}

impl FacesBetween {
    /// Makes room for this number of faces.
    #[inline(always)]
    fn of(&mut self, count: usize) -> (&mut [f64], &mut [f64]) {
        let Self { flux, carried } = self;
        for faces in [&mut *flux, &mut *carried] {
            faces.resize(count, 0.0);
        }
        (flux, carried)
    }
}

impl<'a> Advection<'a> {
    pub(super) fn new(flux: &'a [Field; 3], local: LocalGas<'a>, spacing: Vector3<f64>) -> Self {
        Self { flux, local, spacing, between: FacesBetween::default() }
    }

    /// Adds the momentum that each free face of component `axis` gains per volume and time, in these layers.
    #[inline(always)]
    pub(super) fn add(&mut self, rate: &mut Field, axis: usize, velocity: &Field, layers: &Layers) {
        let LocalGas { part, gas } = self.local;
        for direction in 0..3 {
            let region = if direction == axis {
                Region::inner_faces(part, axis, gas)
            } else {
                Region::free_faces(part, axis, gas)
            };
            self.add_along(direction, rate, (axis, velocity), region.in_layers(layers));
        }
        for face in [0, 1].map(|side| BoxFace { axis, side }) {
            let outside = gas.velocity_outside(face).filter(|_| part.at_ends(axis)[face.side]);
            if let Some(outside) = outside {
                let factor = gas.density / self.spacing[axis];
                let through = ThroughFace { face, outside: outside[axis], factor };
                through.add(rate, velocity, &self.flux[axis], (part, layers));
            }
        }
    }

    #[inline(always)]
    fn add_along(
        &mut self,
        direction: usize,
        rate: &mut Field,
        (axis, velocity): (usize, &Field),
        region: Region,
    ) {
        let strides = rate.strides();
        let along = Along {
            across: strides[axis] as isize,
            step: strides[direction] as isize,
            factor: self.local.gas.density / self.spacing[direction],
        };
        let (rate, u) = (rate.values_mut(), velocity.values());
        let (flux, between) = (self.flux[direction].values(), &mut self.between);
        if direction == velocity.order()[0] {
            for row in region.rows(velocity) {
                along.add_row(rate, u, flux, row, between);
            }
        } else if let Some((first_rows, count)) = region.lines(direction) {
            for row in first_rows.rows(velocity) {
                along.add_rows(rate, u, flux, (row, count), between);
            }
        }
    }
}

/// One direction of advection of one component.
struct Along {
    /// Step in memory along the component's own axis.
    across: isize,
    /// Step in memory along the direction.
    step: isize,
    /// rho / spacing.
    factor: f64,
}

impl Along {
    /// Data for the faces below the places of a row.
    #[inline(always)]
    fn lower<'a>(&self, u: &'a [f64], flux: &'a [f64], row: &Range<usize>) -> LowerFaces<'a> {
        LowerFaces {
            u: [-2, -1, 0, 1].map(|cells| moved(u, row, cells * self.step)),
            flux: [-self.across, 0].map(|steps| moved(flux, row, steps)),
        }
    }

    /// Adds advection along a single row.
    #[inline(always)]
    fn add_row(
        &self,
        rate: &mut [f64],
        u: &[f64],
        flux: &[f64],
        row: Range<usize>,
        between: &mut FacesBetween,
    ) {
        let length = row.end - row.start;
        let (through, carried) = between.of(length + 1);
        self.lower(u, flux, &(row.start..row.end + 1)).set(through, carried);
        let [through, carried] =
            [through, carried].map(|row| [&row[..length], &row[1..][..length]]);
        let here = moved(u, &row, 0);
        self.take(through, carried, here, &mut rate[row]);
    }

    /// Adds advection across a number of rows, one behind the other.
    #[inline(always)]
    fn add_rows(
        &self,
        rate: &mut [f64],
        u: &[f64],
        flux: &[f64],
        (mut row, count): (Range<usize>, usize),
        between: &mut FacesBetween,
    ) {
        let step = self.step as usize;
        let (through, carried) = between.of(row.end - row.start);
        self.lower(u, flux, &row).set(through, carried);
        for _ in 0..count {
            let next = row.start + step..row.end + step;
            let upper = self.lower(u, flux, &next);
            self.pass(&upper, through, carried, &mut rate[row]);
            row = next;
        }
    }

    /// Subtracts the outflow of the cells around a row of faces from their rates, given the fluxes through the faces
    /// between and the velocities that these carry.
    #[inline(always)]
    fn take(
        &self,
        [lower, upper]: [&[f64]; 2],
        [in_lower, in_upper]: [&[f64]; 2],
        here: &[f64],
        rate: &mut [f64],
    ) {
        for i in 0..rate.len() {
            rate[i] -= self.change(here[i], [lower[i], upper[i]], [in_lower[i], in_upper[i]]);
        }
    }

    /// Like `take`, if only the lower faces are known: replaces them by the upper ones, which are the lower ones of the
    /// next row.
    #[inline(always)]
    fn pass(&self, upper: &LowerFaces, through: &mut [f64], carried: &mut [f64], rate: &mut [f64]) {
        let length = rate.len();
        let (through, carried) = (&mut through[..length], &mut carried[..length]);
        for i in 0..length {
            let (flux, in_upper) = upper.at(i);
            let here = upper.u[1][i];
            rate[i] -= self.change(here, [through[i], flux], [carried[i], in_upper]);
            (through[i], carried[i]) = (flux, in_upper);
        }
    }

    /// Outflow of momentum from a cell around a face, by the fluxes through its lower and its upper face.
    #[inline(always)]
    fn change(&self, here: f64, [lower, upper]: [f64; 2], [in_lower, in_upper]: [f64; 2]) -> f64 {
        self.factor * (upper * (in_upper - here) - lower * (in_lower - here))
    }
}

/// Data for the faces below a row of places.
struct LowerFaces<'a> {
    /// Velocity two places below, one below, at the places and one above.
    u: [&'a [f64]; 4],
    /// Volume flux in the two cells of each face.
    flux: [&'a [f64]; 2],
}

impl LowerFaces<'_> {
    /// The flux through the i-th face, and the velocity carried by it.
    #[inline(always)]
    fn at(&self, i: usize) -> (f64, f64) {
        let through = 0.5 * (self.flux[0][i] + self.flux[1][i]);
        (through, value_between(self.u.map(|u| u[i]), through))
    }

    #[inline(always)]
    fn set(&self, through: &mut [f64], carried: &mut [f64]) {
        let length = self.u[0].len();
        let (through, carried) = (&mut through[..length], &mut carried[..length]);
        for i in 0..length {
            (through[i], carried[i]) = self.at(i);
        }
    }
}

/// The value between the second and the third of four values in a row, in the direction of the flux.
#[inline(always)]
fn value_between(values: [f64; 4], flux: f64) -> f64 {
    let [a, b, c, d] = values;
    let forwards = flux >= 0.0;
    let (before, from, to) = if forwards { (a, b, c) } else { (d, c, b) };
    let (rise_before, rise) = (from - before, to - from);
    let (size_before, size) = (rise_before.abs(), rise.abs());
    // Unlike `f64::min`, this is one instruction.
    let smaller = |a: f64, b: f64| if a < b { a } else { b };
    let step = smaller(smaller(size_before, size), (2.0 * size + size_before) * (1.0 / 6.0));
    let step = if rise_before * rise > 0.0 { step } else { 0.0 };
    from + if rise > 0.0 { step } else { -step }
}

/// Advection of the normal component through a face of the box in which it follows from momentum. Gas that leaves
/// carries the velocity in the face; gas that comes in carries that of the gas outside.
struct ThroughFace {
    face: BoxFace,
    /// Velocity of the gas outside along the normal axis.
    outside: f64,
    /// rho / spacing.
    factor: f64,
}

impl ThroughFace {
    fn add(
        &self,
        rate: &mut Field,
        velocity: &Field,
        flux: &Field,
        (part, layers): (&LocalCells, &Layers),
    ) {
        let BoxFace { axis, side } = self.face;
        let (place, inwards) = [(0, 1), (part.count[axis] as isize, -1)][side];
        let step = velocity.strides()[axis] as isize * inwards;
        let at = |values: &[f64], index: usize, steps: isize| {
            values[index.wrapping_add_signed(step * steps)]
        };
        let layer = Region::owned(part).layer(axis, place);
        for cell in layer.in_layers(layers).cells() {
            let index = velocity.index(cell);
            let (u, q) = (velocity.values(), flux.values());
            let outwards = -inwards as f64;
            // Fluxes out of the cell around the face: through the face, and towards the cell inside.
            let out = q[index] * outwards;
            let inner = -0.5 * (q[index] + at(q, index, 1)) * outwards;
            let here = u[index];
            let beyond = if out >= 0.0 { here } else { self.outside };
            // Values in a row from inside to outside; the flux is positive outwards.
            let row = [at(u, index, 2), at(u, index, 1), here, beyond];
            let inside = value_between(row, -inner);
            let change = out * (beyond - here) + inner * (inside - here);
            rate.values_mut()[index] -= self.factor * change;
        }
    }
}

vectorised!(
    /// The largest sum over axes of |eps u| / (eps spacing) in a cell; for the limiter to hold, twice this value times
    /// a step must not exceed 1. Infinite if it is undefined, or a voidage is negative.
    pub(super) fn courant_rate(
        flux: &[Field; 3],
        voidage: &Field,
        part: &LocalCells,
        spacing: Vector3<f64>,
    ) -> f64 {
        let half_inverse = spacing.map(|dx| 0.5 / dx);
        let strides = voidage.strides().map(|stride| stride as isize);
        let mut largest = Largest::default();
        for row in Region::owned(part).rows(voidage) {
            let eps = moved(voidage.values(), &row, 0);
            let lower = [0, 1, 2].map(|axis| moved(flux[axis].values(), &row, 0));
            let upper = [0, 1, 2].map(|axis| moved(flux[axis].values(), &row, strides[axis]));
            for i in 0..eps.len() {
                let along = |axis: usize| {
                    (lower[axis][i].abs() + upper[axis][i].abs()) * half_inverse[axis]
                };
                largest.add((along(0) + along(1) + along(2)) / eps[i]);
            }
        }
        largest.value()
    }
);

#[cfg(test)]
mod tests {
    use super::value_between;

    #[test]
    fn straight_lines_are_exact_and_parabolas_too_where_they_are_monotonic() {
        assert_eq!(value_between([1.0, 2.0, 3.0, 4.0], 1.0), 2.5);
        assert_eq!(value_between([1.0, 2.0, 3.0, 4.0], -1.0), 2.5);
        // Means of x^2 over cells of width 1 around 3, 4, 5: the value in the face at 4.5 is 4.5^2.
        let mean = |x: f64| x * x + 1.0 / 12.0;
        let value = value_between([mean(3.0), mean(4.0), mean(5.0), 0.0], 1.0);
        assert!((value - 4.5 * 4.5).abs() < 1.0e-14);
    }

    #[test]
    fn values_stay_between_their_neighbours() {
        for row in [[0.0, 0.0, 1.0, 1.0], [1.0, 0.0, 1.0, 0.0], [5.0, 1.0, 0.9, -3.0]] {
            for flux in [1.0, -1.0] {
                let value = value_between(row, flux);
                assert!(row[1].min(row[2]) <= value && value <= row[1].max(row[2]));
            }
        }
    }
}
