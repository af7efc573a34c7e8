//! The drag coefficients of particles, and their shares to the cells around them.

use super::drag_at_place::{DragAtPlace, GasAtParticles};
use crate::coupling::{Corners, FourFields};
use crate::gas::{AgglomerateBall, GasForceOutOfRange, ParticleDrag};
use crate::numbers::{F64x4, Quantum, vectorised};
use crate::particles::{AGGLOMERATE, AgglomerateOfParticle, LANES, Particles};
use crate::rules::{LARGEST_DRAG_RESPONSE, drag_response};

/// Input and output of the computation of drag.
pub(super) struct DragDeposition<'a> {
    pub(super) corners: &'a [Corners],
    /// Velocity and voidage in cells.
    pub(super) gas: &'a FourFields,
    pub(super) law: DragAtPlace<'a>,
    /// Whether the drag on members of agglomerates is that of the agglomerate.
    pub(super) by_agglomerate: bool,
    pub(super) bounds: DragBounds,
    pub(super) particles: &'a mut Particles,
    /// Empty at first, then b of each particle.
    pub(super) drag: &'a mut Vec<f64>,
    /// Sums of b v and b in cells.
    pub(super) shares: &'a mut FourFields,
    pub(super) quanta: [Quantum; 4],
}

vectorised!(
    /// Finds the drag coefficient b of each owned particle, and adds b v and b to the cells around it. Returns the
    /// first error.
    pub(super) fn deposit_drag<Q: F64x4>(work: DragDeposition) -> Result<(), GasForceOutOfRange> {
        let DragDeposition { corners, law, bounds, particles, shares, .. } = work;
        let shifts = Q::load(&work.quanta.map(Quantum::shift));
        let mut result = Ok(());
        let mut gas = GasAtParticles::default();
        for (block, corners) in corners.chunks(LANES).enumerate() {
            let first = block * LANES;
            gas.gather::<Q>(work.gas, corners, &particles.body[first..]);
            let mut drag = law.coefficients((particles, first), corners, &gas);
            for (lane, corners) in corners.iter().enumerate() {
                let (i, eps) = (first + lane, gas.voidage[lane]);
                let body = particles.body[i];
                if work.by_agglomerate {
                    let column = particles.columns.at_mut(AGGLOMERATE);
                    let of = &mut column.hold::<AgglomerateOfParticle>()[i];
                    let superficial = eps * gas.slip(lane).norm();
                    let diameter = 2.0 * body.radius;
                    drag[lane] *= in_agglomerate(of, law.law, diameter, 1.0 - eps, superficial);
                }
                if !bounds.hold(drag[lane], body.mass, eps) && result.is_ok() {
                    result = Err(bounds.excess(particles.id[i], drag[lane], body.mass, eps));
                }
                let velocity = body.velocity;
                let factors = [velocity.x, velocity.y, velocity.z, 1.0];
                let amounts = Q::splat(drag[lane]).times(Q::load(&factors));
                shares.deposit(corners, amounts, shifts);
            }
            work.drag.extend_from_slice(&drag[..corners.len()]);
        }
        result
    }
);

/// xi of a particle in its agglomerate, which is stored with the particle.
#[inline(always)]
fn in_agglomerate(
    of: &mut AgglomerateOfParticle,
    law: &ParticleDrag,
    diameter: f64,
    solids_fraction: f64,
    slip: f64,
) -> f64 {
    of.drag_factor = if of.diameter > 0.0 {
        let ball = AgglomerateBall { diameter: of.diameter, packing: of.packing };
        law.factor_in_agglomerate(diameter, &ball, solids_fraction, slip)
    } else {
        1.0
    };
    of.drag_factor
}

/// Bounds of the drag of particles in a gas step of length `dt`.
#[derive(Clone, Copy)]
pub(super) struct DragBounds {
    pub(super) dt: f64,
    pub(super) largest_drag: f64,
}

impl DragBounds {
    /// Whether the drag on a particle of this mass at this voidage is meaningful, and takes no more of its velocity
    /// relative to the gas than is allowed.
    #[inline(always)]
    fn hold(&self, drag: f64, mass: f64, voidage: f64) -> bool {
        drag <= self.largest_drag
            && drag_response(drag, self.dt, mass, voidage) <= LARGEST_DRAG_RESPONSE
    }

    /// The error if the bounds do not hold.
    #[cold]
    fn excess(&self, particle: u64, drag: f64, mass: f64, voidage: f64) -> GasForceOutOfRange {
        let limit = self.largest_drag;
        if drag.is_nan() || drag > limit {
            return GasForceOutOfRange::Drag { particle, drag, limit };
        }
        let response = drag_response(drag, self.dt, mass, voidage);
        GasForceOutOfRange::Response { particle, response, limit: LARGEST_DRAG_RESPONSE }
    }
}
