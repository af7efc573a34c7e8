//! The force of the gas on particles.

use crate::coupling::{Corners, FourFields};
use crate::gas::{GasForceOutOfRange, ParticleLimits};
use crate::numbers::{F64x4, vectorised, within};
use crate::particles::{GAS_FORCE, Particles, sphere_volume};
use nalgebra::Vector3;

vectorised!(
    /// Sets the force of the gas on each owned particle, F_i = b_i (u_i - v_i) - V_i (grad p)_i. It replaces the
    /// previous one in the total force, which is exact.
    ///
    /// `in_cells` holds the velocity of the gas and the voidage, then the gradient of the pressure, less its
    /// hydrostatic head, and the voidage. `buoyancy` is the contribution of the head to -dp/dz, `drag` is b of each
    /// particle. Returns the sum of all forces, as counts of the force quantum, and the first error.
    pub(super) fn set_forces<Q: F64x4>(
        corners: &[Corners],
        in_cells: &[FourFields; 2],
        buoyancy: f64,
        drag: &[f64],
        limits: ParticleLimits,
        particles: &mut Particles,
    ) -> ([i64; 3], Result<(), GasForceOutOfRange>) {
        let [velocity, gradient] = in_cells;
        let quantum = limits.force_quantum;
        let head = Q::load(&[0.0, 0.0, buoyancy, 0.0]);
        let Particles { body, columns, forces: loads, id, .. } = particles;
        let forces = columns.at_mut(GAS_FORCE).hold::<Vector3<f64>>();
        let (mut total, mut result) = ([0; 3], Ok(()));
        for (i, corners) in corners.iter().enumerate() {
            let gas: Q = velocity.interpolate(corners);
            let slip = gas.minus(Q::load(&body[i].vectors()[1]));
            let gradient = gradient.interpolate::<Q>(corners).minus(head);
            let of_drag = Q::splat(drag[i]).times(slip);
            let of_pressure = Q::splat(sphere_volume(body[i].radius)).times(gradient);
            let mut force = [0.0; 4];
            quantum.round_four(of_drag.minus(of_pressure)).store(&mut force);
            let force = Vector3::new(force[0], force[1], force[2]);
            if !within(&force, limits.force) && result.is_ok() {
                let mut at_place = [0.0; 4];
                gas.store(&mut at_place);
                result = Err(excess(&force, id[i], at_place[3], &limits));
            }
            loads[i].force += force - forces[i];
            forces[i] = force;
            for axis in 0..3 {
                total[axis] += quantum.count(force[axis]);
            }
        }
        (total, result)
    }
);

/// The error of a particle whose force exceeds the limit or is undefined.
#[cold]
fn excess(
    force: &Vector3<f64>,
    particle: u64,
    voidage: f64,
    limits: &ParticleLimits,
) -> GasForceOutOfRange {
    GasForceOutOfRange::Particle {
        particle,
        force: force.amax(),
        limit: limits.force,
        solids_fraction: 1.0 - voidage,
    }
}
