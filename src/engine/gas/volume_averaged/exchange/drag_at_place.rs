//! The drag coefficient of a particle from the values of cells at its place.

use super::local_voidage::LocalVoidage;
use super::mean_diameter::MeanDiameter;
use super::own_disturbance::{OwnDisturbance, SeenGas};
use crate::coupling::{Corners, FourFields};
use crate::gas::ParticleDrag;
use crate::numbers::{F64x4, four_mut};
use crate::particles::{Body, LANES, Lanes, Particles};
use nalgebra::Vector3;

/// The drag law, and the corrections to be applied to it.
#[derive(Clone, Copy)]
pub(super) struct DragAtPlace<'a> {
    pub(super) law: &'a ParticleDrag,
    /// Set if particles of different sizes share the drag by surface.
    pub(super) mean_diameter: Option<&'a MeanDiameter>,
    /// Set if the voidage is that of finer cells.
    pub(super) local_voidage: Option<&'a LocalVoidage>,
    /// Set if drag laws use the gas as it would be without the particle itself.
    pub(super) own_disturbance: Option<&'a OwnDisturbance>,
}

/// The gas at the places of a block of particles. Lanes beyond the last particle repeat it.
#[derive(Default)]
#[repr(align(64))] // see `Lanes`
pub(super) struct GasAtParticles {
    /// Velocity of the gas less that of the particle.
    slip: [Lanes; 3],
    pub(super) voidage: Lanes,
}

impl GasAtParticles {
    /// Interpolates velocity and voidage to the first particles, as many as there are corners.
    #[inline(always)]
    pub(super) fn gather<Q: F64x4>(
        &mut self,
        gas: &FourFields,
        corners: &[Corners],
        bodies: &[Body],
    ) {
        let last = corners.len() - 1;
        let zero = [Q::splat(0.0); 4];
        for from in (0..LANES).step_by(4) {
            let (mut seen, mut velocity) = (zero, zero);
            for row in 0..4 {
                let index = last.min(from + row);
                seen[row] = gas.interpolate(&corners[index]);
                velocity[row] = Q::load(&bodies[index].vectors()[1]);
            }
            let (seen, velocity) = (Q::transposed(seen), Q::transposed(velocity));
            for axis in 0..3 {
                let slip = seen[axis].minus(velocity[axis]);
                slip.store(four_mut(&mut self.slip[axis], from));
            }
            seen[3].store(four_mut(&mut self.voidage, from));
        }
    }

    /// Velocity of the gas less that of the particle in a lane.
    #[inline(always)]
    pub(super) fn slip(&self, lane: usize) -> Vector3<f64> {
        Vector3::new(self.slip[0][lane], self.slip[1][lane], self.slip[2][lane])
    }
}

impl DragAtPlace<'_> {
    /// b of the particles from `first` on, as many as there are corners: all at once if the law needs only the voidage
    /// at the place.
    #[inline(always)]
    pub(super) fn coefficients(
        &self,
        (particles, first): (&Particles, usize),
        corners: &[Corners],
        gas: &GasAtParticles,
    ) -> Lanes {
        if self.asks_for_more() {
            let mut drag = [0.0; LANES];
            for (lane, corners) in corners.iter().enumerate() {
                let particle = (particles, first + lane);
                drag[lane] = self.coefficient(particle, corners, gas.slip(lane), gas.voidage[lane]);
            }
            return drag;
        }
        let last = first + corners.len() - 1;
        let (mut diameter, mut solids_fraction, mut slip) =
            ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            diameter[lane] = 2.0 * particles.body[last.min(first + lane)].radius;
            solids_fraction[lane] = 1.0 - gas.voidage[lane];
            slip[lane] = gas.voidage[lane] * gas.slip(lane).norm();
        }
        self.law.per_velocities(&diameter, &solids_fraction, &slip)
    }

    fn asks_for_more(&self) -> bool {
        self.mean_diameter.is_some()
            || self.local_voidage.is_some()
            || self.own_disturbance.is_some()
    }

    /// b of an owned particle, force per velocity: `slip` is the velocity of the gas less that of the particle, `eps`
    /// the voidage there.
    #[inline(always)]
    fn coefficient(
        &self,
        (particles, index): (&Particles, usize),
        corners: &Corners,
        slip: Vector3<f64>,
        eps: f64,
    ) -> f64 {
        let (diameter, volume) = (2.0 * particles.body[index].radius, particles.volume(index));
        let mean = self.mean_diameter.map(|mean| mean.at(corners, diameter));
        let law = |solids_fraction: f64, slip: f64| match mean {
            Some(mean) => self.law.per_velocity_in_mixture([diameter, mean], solids_fraction, slip),
            None => self.law.per_velocity(diameter, solids_fraction, slip),
        };
        let local = self.local_voidage.map(|local| local.around(index, volume));
        let drag_at = |solids_fraction: f64, slip: f64| match local {
            Some(local) => law(local, slip) * LocalVoidage::factor(1.0 - solids_fraction, local),
            None => law(solids_fraction, slip),
        };
        match self.own_disturbance {
            Some(own) => {
                let own_share = corners.own_share();
                let seen = SeenGas { slip, solids_fraction: 1.0 - eps, volume, own_share };
                own.coefficient(&seen, drag_at)
            }
            None => drag_at(1.0 - eps, eps * slip.norm()),
        }
    }
}
