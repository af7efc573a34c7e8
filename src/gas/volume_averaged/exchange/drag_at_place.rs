//! The drag coefficient of a particle from what cells say at its place.

use super::local_voidage::LocalVoidage;
use super::mean_diameter::MeanDiameter;
use super::own_disturbance::{OwnDisturbance, SeenGas};
use crate::coupling::Corners;
use crate::gas::ParticleDrag;
use crate::particles::Particles;
use nalgebra::Vector3;

/// The drag law, and what is asked of it besides the voidage of the gas's cells.
#[derive(Clone, Copy)]
pub(super) struct DragAtPlace<'a> {
    pub(super) law: &'a ParticleDrag,
    /// Where particles of different sizes share the drag by surface.
    pub(super) mean_diameter: Option<&'a MeanDiameter>,
    /// Where the voidage is that of finer cells.
    pub(super) local_voidage: Option<&'a LocalVoidage>,
    /// Where drag is that of the undisturbed gas.
    pub(super) own_disturbance: Option<&'a OwnDisturbance>,
}

impl DragAtPlace<'_> {
    /// b of an owned particle, force per velocity: `slip` is the velocity of the gas less that of the particle, `eps` the voidage there.
    #[inline(always)]
    pub(super) fn coefficient(
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
