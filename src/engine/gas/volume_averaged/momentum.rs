//! Momentum with implicit drag, and the contribution of the pressure to it.
//!
//! On each free face, with eps, beta and (beta v) as the means of the two cells:
//!
//! ```math
//! u = \frac{(\varepsilon \rho / \Delta t)\, u_\text{old} + R + \varepsilon (f - \nabla p) + (\beta v) + S}{\varepsilon \rho / \Delta t + \beta}
//! ```
//!
//! R is the sum of advection and viscous force, f the driving force per volume of gas, S another force per volume. For
//! beta dt/rho >> 1 this is Darcy's law, whatever u_old is. Near the wall of a round column eps, beta and (beta v) are
//! theta times those of the gas, and the denominator has the additional term eps mu k: see [`RoundWall`].

use super::faces::{Layers, Region, moved};
use super::round_wall::RoundWall;
use super::{BedOnGrid, VolumeAveragedGas};
use crate::domain::BoxFace;
use crate::grid::{Field, LocalCells};
use crate::numbers::vectorised;
use nalgebra::Vector3;
use std::ops::Range;

/// Data that hold for a whole step.
#[derive(Clone, Copy)]
pub(super) struct Momentum<'a> {
    pub(super) gas: &'a VolumeAveragedGas,
    pub(super) part: &'a LocalCells,
    pub(super) spacing: Vector3<f64>,
    pub(super) bed: &'a BedOnGrid,
    /// The round wall around the gas, if there is one; the bed is then per volume of whole cells.
    pub(super) wall: Option<&'a RoundWall>,
    pub(super) dt: f64,
}

/// Forces on faces, in the order of the axes to which the faces are normal.
#[derive(Clone, Copy)]
pub(super) struct Forces<'a> {
    pub(super) rate: &'a [Field; 3],
    /// Factor of the rate.
    pub(super) of_rate: f64,
    pub(super) pressure: &'a Field,
    pub(super) driving: Vector3<f64>,
    pub(super) source: Option<&'a [Field; 3]>,
}

/// Voidage and momentum transfer in the faces of a row.
struct FaceRow<'a> {
    eps: [&'a [f64]; 2],
    beta: [&'a [f64]; 2],
    inertia: f64,
    /// mu k of a round wall.
    friction: Option<&'a [f64]>,
}

impl FaceRow<'_> {
    /// eps, eps rho/dt and the sum of eps rho/dt, beta and the friction of a round wall, in the i-th face.
    #[inline(always)]
    fn at(&self, i: usize) -> (f64, f64, f64) {
        let eps = 0.5 * (self.eps[0][i] + self.eps[1][i]);
        let beta = 0.5 * (self.beta[0][i] + self.beta[1][i]);
        let inertia = eps * self.inertia;
        let total = inertia + beta;
        match self.friction {
            None => (eps, inertia, total),
            Some(friction) => (eps, inertia, total + eps * friction[i]),
        }
    }

    /// Coefficients of the pressure equation, for a factor 1 / spacing^2.
    #[inline(always)]
    fn set_coefficients(&self, factor: f64, coefficients: &mut [f64]) {
        for i in 0..coefficients.len() {
            let (eps, _, total) = self.at(i);
            coefficients[i] = eps * eps / total * factor;
        }
    }

    /// Adds the effect of changes of pressure below and above to the velocity; `inverse` is 1 / spacing.
    #[inline(always)]
    fn correct(&self, [below, above]: [&[f64]; 2], inverse: f64, velocity: &mut [f64]) {
        for i in 0..velocity.len() {
            let (eps, _, total) = self.at(i);
            velocity[i] -= eps / total * ((above[i] - below[i]) * inverse);
        }
    }
}

/// Data for the velocity in the faces of a row, except for another force.
struct MomentumRow<'a> {
    face: FaceRow<'a>,
    /// u_old.
    u: &'a [f64],
    /// Advection and viscous force, and their factor.
    rate: &'a [f64],
    of_rate: f64,
    pressure: [&'a [f64]; 2],
    /// 1 / spacing.
    inverse: f64,
    /// f.
    driving: f64,
    /// beta v.
    solids: [&'a [f64]; 2],
}

impl MomentumRow<'_> {
    /// The velocity at the end of the step, before the change of the pressure.
    #[inline(always)]
    fn predict<const WITH_SOURCE: bool>(&self, source: &[f64], new: &mut [f64]) {
        let Self { face, u, rate, of_rate, pressure, inverse, driving, solids } = self;
        for i in 0..new.len() {
            let (eps, inertia, total) = face.at(i);
            let gradient = (pressure[1][i] - pressure[0][i]) * inverse;
            let drag = 0.5 * (solids[0][i] + solids[1][i]);
            let given = if WITH_SOURCE { source[i] } else { 0.0 };
            let of_pressure = eps * (driving - gradient);
            let gained = of_rate * rate[i] + of_pressure + drag + given;
            new[i] = (inertia * u[i] + gained) / total;
        }
    }
}

/// Numbers of the cells below and above the faces of a row.
#[inline(always)]
fn both<'a>(field: &'a Field, row: &Range<usize>, stride: isize) -> [&'a [f64]; 2] {
    [-stride, 0].map(|steps| moved(field.values(), row, steps))
}

/// Operations on faces go through the box in blocks of layers, so that all three axes find the cells of a block in a
/// cache.
impl<'a> Momentum<'a> {
    fn faces(&self, axis: usize, layers: &Layers) -> Region {
        Region::free_faces(self.part, axis, self.gas).in_layers(layers)
    }

    fn stride(&self, axis: usize) -> isize {
        self.bed.voidage.strides()[axis] as isize
    }

    #[inline(always)]
    fn face_row(&self, row: &Range<usize>, axis: usize) -> FaceRow<'a> {
        let stride = self.stride(axis);
        let friction = self.wall.map(|wall| moved(wall.friction[axis].values(), row, 0));
        FaceRow {
            friction,
            eps: both(&self.bed.voidage, row, stride),
            beta: both(&self.bed.momentum_transfer, row, stride),
            inertia: self.gas.density / self.dt,
        }
    }

    #[inline(always)]
    fn predict_rows(
        &self,
        (axis, layers): (usize, &Layers),
        old: &Field,
        forces: Forces,
        new: &mut Field,
    ) {
        let (stride, inverse) = (self.stride(axis), 1.0 / self.spacing[axis]);
        let Forces { of_rate, .. } = forces;
        for row in self.faces(axis, layers).rows(old) {
            let terms = MomentumRow {
                face: self.face_row(&row, axis),
                u: moved(old.values(), &row, 0),
                rate: moved(forces.rate[axis].values(), &row, 0),
                of_rate,
                pressure: both(forces.pressure, &row, stride),
                inverse,
                driving: forces.driving[axis],
                solids: both(&self.bed.transferred_velocity[axis], &row, stride),
            };
            let source = forces.source.map(|source| moved(source[axis].values(), &row, 0));
            let target = &mut new.values_mut()[row];
            match source {
                Some(source) => terms.predict::<true>(source, target),
                None => terms.predict::<false>(&[], target),
            }
        }
    }

    /// Sets the coefficients of the pressure equation, eps^2 / (eps rho/dt + beta) / spacing^2 on faces, and the
    /// contribution to the diagonal of a face of given pressure, which is half a cell away.
    pub(super) fn set_coefficients(&self, faces: &mut [Field; 3], diagonal: &mut Field) {
        diagonal.values_mut().fill(0.0);
        set_coefficients(self, faces);
        for (axis, faces) in faces.iter().enumerate() {
            for side in 0..2 {
                self.add_given_pressure(faces, diagonal, BoxFace { axis, side });
            }
        }
    }

    fn add_given_pressure(&self, faces: &Field, diagonal: &mut Field, given_in: BoxFace) {
        let BoxFace { axis, side } = given_in;
        let is_given = self.gas.given_pressure(given_in).is_some();
        if !(self.part.at_ends(axis)[side] && is_given) {
            return;
        }
        let last = self.part.count[axis] as isize - 1;
        for cell in Region::owned(self.part).layer(axis, [0, last][side]).cells() {
            let mut face = cell;
            face[axis] += side as isize;
            *diagonal.at_mut(cell) += 2.0 * faces.at(face);
        }
    }

    #[inline(always)]
    fn residual_of_rows(&self, residual: &mut Field, velocity: &[Field; 3], old: &Field) {
        let strides = [0, 1, 2].map(|axis| self.stride(axis));
        let inverse = [0, 1, 2].map(|axis| 1.0 / self.spacing[axis]);
        for row in Region::owned(self.part).rows(residual) {
            let eps = &self.bed.voidage;
            let here = moved(eps.values(), &row, 0);
            let before = moved(old.values(), &row, 0);
            let below = strides.map(|stride| moved(eps.values(), &row, -stride));
            let above = strides.map(|stride| moved(eps.values(), &row, stride));
            let lower = [0, 1, 2].map(|axis| moved(velocity[axis].values(), &row, 0));
            let upper = [0, 1, 2].map(|axis| moved(velocity[axis].values(), &row, strides[axis]));
            let cells = ContinuityRow { here, before, below, above, lower, upper };
            cells.set_residual(inverse, self.dt, &mut residual.values_mut()[row]);
        }
    }

    #[inline(always)]
    fn coefficients_of_rows(&self, (axis, layers): (usize, &Layers), faces: &mut Field) {
        let factor = 1.0 / (self.spacing[axis] * self.spacing[axis]);
        for row in self.faces(axis, layers).rows(faces) {
            let face = self.face_row(&row, axis);
            face.set_coefficients(factor, &mut faces.values_mut()[row]);
        }
    }

    #[inline(always)]
    fn correct_rows(&self, (axis, layers): (usize, &Layers), velocity: &mut Field, change: &Field) {
        let (stride, inverse) = (self.stride(axis), 1.0 / self.spacing[axis]);
        for row in self.faces(axis, layers).rows(velocity) {
            let face = self.face_row(&row, axis);
            let change = both(change, &row, stride);
            face.correct(change, inverse, &mut velocity.values_mut()[row]);
        }
    }
}

/// Data for continuity in a row of cells.
struct ContinuityRow<'a> {
    /// eps now and before the step.
    here: &'a [f64],
    before: &'a [f64],
    /// eps in the neighbours along each axis.
    below: [&'a [f64]; 3],
    above: [&'a [f64]; 3],
    /// u in the faces along each axis.
    lower: [&'a [f64]; 3],
    upper: [&'a [f64]; 3],
}

impl ContinuityRow<'_> {
    /// -[div(eps u) + (eps - eps_old)/dt]; `inverse` is 1 / spacing.
    #[inline(always)]
    fn set_residual(&self, inverse: [f64; 3], dt: f64, residual: &mut [f64]) {
        let &Self { here, before, below, above, lower, upper } = self;
        for i in 0..residual.len() {
            let along = |a: usize| {
                let outflow = 0.5 * (here[i] + above[a][i]) * upper[a][i];
                let inflow = 0.5 * (below[a][i] + here[i]) * lower[a][i];
                (outflow - inflow) * inverse[a]
            };
            residual[i] = -(along(0) + along(1) + along(2) + (here[i] - before[i]) / dt);
        }
    }
}

vectorised!(
    /// Sets the velocity at the end of the step, before the change of the pressure.
    pub(super) fn predict(
        momentum: &Momentum,
        old: &[Field; 3],
        forces: Forces,
        new: &mut [Field; 3],
    ) {
        for layers in Layers::blocks(momentum.part) {
            for (axis, new) in new.iter_mut().enumerate() {
                momentum.predict_rows((axis, &layers), &old[axis], forces, new);
            }
        }
    }
);

vectorised!(
    fn set_coefficients(momentum: &Momentum, faces: &mut [Field; 3]) {
        for layers in Layers::blocks(momentum.part) {
            for (axis, faces) in faces.iter_mut().enumerate() {
                momentum.coefficients_of_rows((axis, &layers), faces);
            }
        }
    }
);

vectorised!(
    /// Residual of continuity for the predicted velocity: -[div(eps u) + (eps - eps_old)/dt] in cells.
    pub(super) fn set_continuity_residual(
        momentum: &Momentum,
        residual: &mut Field,
        velocity: &[Field; 3],
        old: &Field,
    ) {
        momentum.residual_of_rows(residual, velocity, old);
    }
);

vectorised!(
    /// Adds the effect of a change of pressure to the velocity.
    pub(super) fn correct(momentum: &Momentum, velocity: &mut [Field; 3], change: &Field) {
        for layers in Layers::blocks(momentum.part) {
            for (axis, velocity) in velocity.iter_mut().enumerate() {
                momentum.correct_rows((axis, &layers), velocity, change);
            }
        }
    }
);
