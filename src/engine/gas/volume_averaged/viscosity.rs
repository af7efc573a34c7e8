//! Viscous forces: div(eps tau), tau = mu (grad u + (grad u)^T - (2/3) div u).
//!
//! Normal stresses are stored in cells, shear stresses on the edges between faces, where the voidage is the mean of the
//! four cells around.

use super::faces::{Layers, Region, moved};
use super::model::LocalGas;
use crate::grid::{Field, LocalCells};
use crate::numbers::{Largest, vectorised};
use crate::rules::viscous_rate;
use nalgebra::Vector3;
use std::ops::Range;

/// Sets div u in owned cells and one cell around. Part of the work in wide vectors.
#[inline(always)]
pub(super) fn set_dilatation(
    dilatation: &mut Field,
    velocity: &[Field; 3],
    part: &LocalCells,
    spacing: Vector3<f64>,
) {
    let strides = dilatation.strides().map(|stride| stride as isize);
    for row in Region::widened(part, 1).rows(dilatation) {
        let lower = [0, 1, 2].map(|axis| moved(velocity[axis].values(), &row, 0));
        let upper = [0, 1, 2].map(|axis| moved(velocity[axis].values(), &row, strides[axis]));
        set_dilatation_of_row(lower, upper, spacing, &mut dilatation.values_mut()[row]);
    }
}

/// Sets div u from the velocities in the lower and the upper faces of a row of cells along each axis.
#[inline(always)]
fn set_dilatation_of_row(
    lower: [&[f64]; 3],
    upper: [&[f64]; 3],
    spacing: Vector3<f64>,
    dilatation: &mut [f64],
) {
    for i in 0..dilatation.len() {
        let along = |axis: usize| (upper[axis][i] - lower[axis][i]) / spacing[axis];
        dilatation[i] = along(0) + along(1) + along(2);
    }
}

/// Data for viscous forces.
#[derive(Clone, Copy)]
pub(super) struct ViscousFields<'a> {
    pub(super) velocity: &'a [Field; 3],
    pub(super) dilatation: &'a Field,
    pub(super) voidage: &'a Field,
}

/// The stresses on both sides of a row of faces. The upper ones are the lower ones of the next row.
#[derive(Clone, Debug, Default)]
pub(super) struct StressRows {
    below: Vec<f64>,
    above: Vec<f64>,
}

/// Adds the viscous force per volume on each free face of component `axis`, in these layers. Part of the work in wide
/// vectors.
#[inline(always)]
pub(super) fn add_viscous_force(
    rate: &mut Field,
    axis: usize,
    fields: ViscousFields,
    (local, layers): (LocalGas, &Layers),
    (spacing, stresses): (Vector3<f64>, &mut StressRows),
) {
    let LocalGas { part, gas } = local;
    if gas.viscosity == 0.0 {
        return;
    }
    let strides = rate.strides();
    let normal = NormalStress {
        velocity: fields.velocity[axis].values(),
        dilatation: fields.dilatation.values(),
        voidage: fields.voidage.values(),
        step: strides[axis] as isize,
        spacing: spacing[axis],
    };
    // In an outlet it does not change.
    let region = Region::inner_faces(part, axis, gas).in_layers(layers);
    let factor = 2.0 * gas.viscosity / spacing[axis];
    stresses.add_differences(rate, (region, axis), factor, &normal);
    for direction in (0..3).filter(|&direction| direction != axis) {
        let shear = ShearStress {
            along: fields.velocity[axis].values(),
            across: fields.velocity[direction].values(),
            voidage: fields.voidage.values(),
            own: strides[axis] as isize,
            step: strides[direction] as isize,
            inverse: [1.0 / spacing[axis], 1.0 / spacing[direction]],
        };
        let region = Region::free_faces(part, axis, gas).in_layers(layers);
        let factor = gas.viscosity / spacing[direction] * 0.25;
        stresses.add_differences(rate, (region, direction), factor, &shear);
    }
}

impl StressRows {
    /// Adds a factor times the difference of the stresses above and below, in a region, along a direction.
    #[inline(always)]
    fn add_differences(
        &mut self,
        rate: &mut Field,
        (region, direction): (Region, usize),
        factor: f64,
        stress: &impl Stress,
    ) {
        let length = region.row_length(rate);
        if direction == rate.order()[0] {
            self.below.resize(length + 1, 0.0);
            for row in region.rows(rate) {
                stress.set_below(&(row.start..row.end + 1), &mut self.below);
                let (below, above) = (&self.below[..length], &self.below[1..][..length]);
                add_difference(&mut rate.values_mut()[row], factor, below, above);
            }
            return;
        }
        let step = rate.strides()[direction];
        let Some((first_rows, count)) = region.lines(direction) else { return };
        self.below.resize(length, 0.0);
        self.above.resize(length, 0.0);
        for mut row in first_rows.rows(rate) {
            stress.set_below(&row, &mut self.below);
            for _ in 0..count {
                let next = row.start + step..row.end + step;
                stress.set_below(&next, &mut self.above);
                add_difference(&mut rate.values_mut()[row], factor, &self.below, &self.above);
                std::mem::swap(&mut self.below, &mut self.above);
                row = next;
            }
        }
    }
}

#[inline(always)]
fn add_difference(rate: &mut [f64], factor: f64, below: &[f64], above: &[f64]) {
    let (below, above) = (&below[..rate.len()], &above[..rate.len()]);
    for i in 0..rate.len() {
        rate[i] += factor * (above[i] - below[i]);
    }
}

/// A stress that acts on both sides of faces along a direction.
trait Stress {
    /// Sets the stress on the lower sides of a row of faces.
    fn set_below(&self, row: &Range<usize>, stress: &mut [f64]);
}

/// eps tau_aa / 2 mu in cells.
struct NormalStress<'a> {
    velocity: &'a [f64],
    dilatation: &'a [f64],
    voidage: &'a [f64],
    /// Step in memory along the component's axis.
    step: isize,
    /// Spacing along this axis.
    spacing: f64,
}

impl Stress for NormalStress<'_> {
    #[inline(always)]
    fn set_below(&self, row: &Range<usize>, stress: &mut [f64]) {
        let [velocity_below, velocity] =
            [-1, 0].map(|cells| moved(self.velocity, row, cells * self.step));
        let voidage = moved(self.voidage, row, -self.step);
        let dilatation = moved(self.dilatation, row, -self.step);
        let length = row.end - row.start;
        let stress = &mut stress[..length];
        for i in 0..length {
            let gradient = (velocity[i] - velocity_below[i]) / self.spacing;
            stress[i] = voidage[i] * (gradient - dilatation[i] * (1.0 / 3.0));
        }
    }
}

/// 4 eps tau_ab / mu on edges.
struct ShearStress<'a> {
    /// Velocity of the component.
    along: &'a [f64],
    /// Velocity along the direction.
    across: &'a [f64],
    voidage: &'a [f64],
    /// Step in memory along the component's axis.
    own: isize,
    /// Step in memory along the direction.
    step: isize,
    /// 1 / spacing along the component's axis, and along the direction.
    inverse: [f64; 2],
}

impl Stress for ShearStress<'_> {
    #[inline(always)]
    fn set_below(&self, row: &Range<usize>, stress: &mut [f64]) {
        let (own, step) = (self.own, self.step);
        let [u_below, u] = [-1, 0].map(|cells| moved(self.along, row, cells * step));
        let [v_before, v] = [-own, 0].map(|steps| moved(self.across, row, steps));
        let eps = [-step - own, -step, -own, 0].map(|steps| moved(self.voidage, row, steps));
        let [along_own, along_step] = self.inverse;
        let length = row.end - row.start;
        let stress = &mut stress[..length];
        for i in 0..length {
            let voidage = (eps[0][i] + eps[1][i]) + (eps[2][i] + eps[3][i]);
            let shear = (u[i] - u_below[i]) * along_step + (v[i] - v_before[i]) * along_own;
            stress[i] = voidage * shear;
        }
    }
}

/// [`viscous_rate`] with the largest ratio of voidages of neighbours on this rank's cells. Infinite if one is undefined
/// or negative.
pub(super) fn largest_viscous_rate(
    voidage: &Field,
    LocalGas { part, gas }: LocalGas,
    spacing: Vector3<f64>,
) -> f64 {
    let ratio = largest_ratio(voidage, part);
    let varies = [0, 1, 2].map(|axis| !(gas.is_periodic(axis) && part.counts[axis] == 1));
    viscous_rate(gas.viscosity, gas.density, ratio, spacing.into(), varies)
}

vectorised!(
    /// The largest ratio of the voidage of a neighbour to that of a cell, at least 1.
    fn largest_ratio(voidage: &Field, part: &LocalCells) -> f64 {
        let strides = voidage.strides().map(|stride| stride as isize);
        let larger = |a: f64, b: f64| if a > b { a } else { b };
        let mut largest = Largest::default();
        largest.add(1.0);
        for row in Region::owned(part).rows(voidage) {
            let [below, above] = [-1, 1].map(|side| {
                [0, 1, 2].map(|axis| moved(voidage.values(), &row, side * strides[axis]))
            });
            let eps = moved(voidage.values(), &row, 0);
            for i in 0..eps.len() {
                let along = |axis: usize| larger(below[axis][i], above[axis][i]);
                largest.add(larger(larger(along(0), along(1)), along(2)) / eps[i]);
            }
        }
        largest.value()
    }
);
