//! Viscous forces: div(eps tau), tau = mu (grad u + (grad u)^T - (2/3) div u).
//!
//! Normal stresses live in cells, shear stresses on the edges between faces, where the voidage is the mean of the
//! four cells around.

use super::advection::larger;
use super::faces::{Region, moved};
use super::model::LocalGas;
use crate::grid::{Field, LocalCells};
use crate::rules::viscous_rate;
use nalgebra::Vector3;
use std::ops::Range;

/// div u in owned cells and one cell around. Part of work in wide vectors.
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
        let target = &mut dilatation.values_mut()[row];
        for i in 0..target.len() {
            let along = |axis: usize| (upper[axis][i] - lower[axis][i]) / spacing[axis];
            target[i] = along(0) + along(1) + along(2);
        }
    }
}

/// What viscous forces are made of.
#[derive(Clone, Copy)]
pub(super) struct ViscousFields<'a> {
    pub(super) velocity: &'a [Field; 3],
    pub(super) dilatation: &'a Field,
    pub(super) voidage: &'a Field,
}

/// Adds the viscous force per volume on each free face of component `axis`, in these layers along z. Part of work in wide
/// vectors.
#[inline(always)]
pub(super) fn add_viscous_force(
    rate: &mut Field,
    axis: usize,
    fields: ViscousFields,
    (local, layers): (LocalGas, &Range<isize>),
    spacing: Vector3<f64>,
) {
    let LocalGas { part, gas } = local;
    if gas.viscosity == 0.0 {
        return;
    }
    add_normal_stress(rate, axis, fields, (local, layers), spacing[axis]);
    for direction in (0..3).filter(|&direction| direction != axis) {
        let strides = rate.strides();
        let shear = Shear {
            own: strides[axis] as isize,
            step: strides[direction] as isize,
            inverse: [1.0 / spacing[axis], 1.0 / spacing[direction]],
            factor: gas.viscosity / spacing[direction],
        };
        for row in Region::free_faces(part, axis, gas).in_layers(layers).rows(rate) {
            let other = fields.velocity[direction].values();
            let own = fields.velocity[axis].values();
            shear.add_row(rate.values_mut(), [own, other], fields.voidage.values(), row);
        }
    }
}

/// The difference of eps tau_aa between the two cells of a face. In an outlet it is zero.
#[inline(always)]
fn add_normal_stress(
    rate: &mut Field,
    axis: usize,
    fields: ViscousFields,
    (LocalGas { part, gas }, layers): (LocalGas, &Range<isize>),
    spacing: f64,
) {
    let step = rate.strides()[axis] as isize;
    let factor = 2.0 * gas.viscosity / spacing;
    for row in Region::inner_faces(part, axis, gas).in_layers(layers).rows(rate) {
        let [below, here, above] =
            [-1, 0, 1].map(|cells| moved(fields.velocity[axis].values(), &row, cells * step));
        let [eps_below, eps] =
            [-1, 0].map(|cells| moved(fields.voidage.values(), &row, cells * step));
        let [div_below, div] =
            [-1, 0].map(|cells| moved(fields.dilatation.values(), &row, cells * step));
        let target = &mut rate.values_mut()[row];
        for i in 0..target.len() {
            let upper = eps[i] * ((above[i] - here[i]) / spacing - div[i] * (1.0 / 3.0));
            let lower =
                eps_below[i] * ((here[i] - below[i]) / spacing - div_below[i] * (1.0 / 3.0));
            target[i] += factor * (upper - lower);
        }
    }
}

/// Shear stress on the edges below and above a face along one direction.
struct Shear {
    /// Step in memory along the component's axis.
    own: isize,
    /// Step in memory along the direction.
    step: isize,
    /// 1 / spacing along the component's axis, and along the direction.
    inverse: [f64; 2],
    /// mu / spacing along the direction.
    factor: f64,
}

impl Shear {
    #[inline(always)]
    fn add_row(&self, rate: &mut [f64], [u, v]: [&[f64]; 2], voidage: &[f64], row: Range<usize>) {
        let (own, step) = (self.own, self.step);
        let [below, here, above] = [-1, 0, 1].map(|cells| moved(u, &row, cells * step));
        let [v_lower_left, v_lower] = [-own, 0].map(|steps| moved(v, &row, steps));
        let [v_upper_left, v_upper] = [step - own, step].map(|steps| moved(v, &row, steps));
        let eps = [-1, 0, 1].map(|cells| {
            [moved(voidage, &row, cells * step - own), moved(voidage, &row, cells * step)]
        });
        let [along_own, along_step] = self.inverse;
        let target = &mut rate[row];
        for i in 0..target.len() {
            let [first, second, third] =
                [0, 1, 2].map(|layer: usize| eps[layer][0][i] + eps[layer][1][i]);
            let upper =
                (above[i] - here[i]) * along_step + (v_upper[i] - v_upper_left[i]) * along_own;
            let lower =
                (here[i] - below[i]) * along_step + (v_lower[i] - v_lower_left[i]) * along_own;
            target[i] += self.factor * 0.25 * ((second + third) * upper - (first + second) * lower);
        }
    }
}

/// [`viscous_rate`] with the largest ratio of voidages of neighbours on this rank's cells.
pub(super) fn largest_viscous_rate(
    voidage: &Field,
    LocalGas { part, gas }: LocalGas,
    spacing: Vector3<f64>,
) -> f64 {
    let strides = voidage.strides().map(|stride| stride as isize);
    let mut ratio = 1.0;
    for row in Region::owned(part).rows(voidage) {
        let neighbours = [0, 1, 2]
            .map(|axis| [-1, 1].map(|side| moved(voidage.values(), &row, side * strides[axis])));
        let eps = moved(voidage.values(), &row, 0);
        for i in 0..eps.len() {
            let [x, y, z] = [0, 1, 2].map(|a: usize| neighbours[a][0][i].max(neighbours[a][1][i]));
            ratio = larger(x.max(y).max(z) / eps[i], ratio);
        }
    }
    let varies = [0, 1, 2].map(|axis| !(gas.is_periodic(axis) && part.counts[axis] == 1));
    viscous_rate(gas.viscosity, gas.density, ratio, spacing.into(), varies)
}
