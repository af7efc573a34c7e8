//! Energies of contacts: the energy stored in springs, and the work of dashpots, sliding, plasticity and adhesion.

use super::{Contact, ContactForce};
use crate::particles::ContactHistory;
use nalgebra::Vector3;

/// Energy stored in a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StoredInContact {
    /// Energy of the normal spring, with that of a law's own adhesion.
    pub normal: f64,
    /// Energy of the tangential spring.
    pub tangential: f64,
}

impl StoredInContact {
    /// Placeholder for a law that does not give energies.
    pub const UNKNOWN: Self = Self { normal: f64::NAN, tangential: f64::NAN };
}

/// Work of a contact on its bodies over a step, by mechanism: negative if they lose energy that no spring stores.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactWork {
    /// Work of dashpots.
    pub dashpot: f64,
    /// Work of sliding friction, and of resistance to rolling and twisting beyond springs and dashpots.
    pub friction: f64,
    /// Work of plastic deformation.
    pub plasticity: f64,
    /// Work of adhesion that acts at once when a contact forms.
    pub adhesion: f64,
}

impl ContactWork {
    /// Placeholder for a law that does not give energies.
    pub const UNKNOWN: Self =
        Self { dashpot: f64::NAN, friction: f64::NAN, plasticity: f64::NAN, adhesion: f64::NAN };
}

impl std::ops::Add for ContactWork {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            dashpot: self.dashpot + other.dashpot,
            friction: self.friction + other.friction,
            plasticity: self.plasticity + other.plasticity,
            adhesion: self.adhesion + other.adhesion,
        }
    }
}

/// A contact over a step at the end of which the bodies touch.
#[derive(Clone, Copy, Debug)]
pub struct ContactStep<'a> {
    /// The contact at the end of the step, with the velocities at its middle.
    pub contact: &'a Contact,
    /// Its history before the step; all zero if it has just begun.
    pub before: &'a ContactHistory,
    /// Its history after the step.
    pub after: &'a ContactHistory,
    /// The force at the end of the step.
    pub force: &'a ContactForce,
    /// Whether the bodies did not touch before the step.
    pub began: bool,
    /// Length of the step.
    pub dt: f64,
}

impl ContactStep<'_> {
    /// v_n, positive if the bodies separate; length per time.
    pub fn separation_speed(&self) -> f64 {
        self.contact.normal.dot(&self.contact.relative_velocity)
    }

    /// The overlap before the step, in which it changed by -v_n dt; length.
    pub fn overlap_before(&self) -> f64 {
        overlap_before(self.contact, self.dt)
    }

    /// Work of a normal dashpot of this coefficient: -gamma v_n^2 dt.
    pub fn dashpot_work(&self, coefficient: f64) -> f64 {
        let speed = self.separation_speed();
        -coefficient * speed * speed * self.dt
    }

    /// Work of a tangential spring with dashpot and slider.
    pub fn tangential_work(&self, spring: &SpringStep) -> ContactWork {
        let old = self.before.tangential_spring;
        let motion = SpringMotion {
            before: old,
            turned: self.contact.tangential(&old) * spring.loading_factor,
            after: self.after.tangential_spring,
            rate: self.contact.tangential(&self.contact.relative_velocity),
            force: self.force.tangential,
        };
        spring.work(&motion, self.dt)
    }
}

/// The overlap before a step of this length, from the velocities of the contact.
pub(super) fn overlap_before(contact: &Contact, dt: f64) -> f64 {
    contact.overlap + contact.normal.dot(&contact.relative_velocity) * dt
}

/// A spring with a dashpot and a slider over a step.
#[derive(Clone, Copy, Debug)]
pub struct SpringStep {
    /// Its stiffness before the step and after it.
    pub stiffness: [f64; 2],
    /// Coefficient of the dashpot.
    pub damping: f64,
    /// Factor of the old deflection, at most 1: a spring that stiffens keeps its force.
    pub loading_factor: f64,
}

/// Deflections, rate and force of such a spring.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpringMotion {
    /// Deflection before the step.
    pub(super) before: Vector3<f64>,
    /// Deflection before the step, turned into the tangent plane at the end of the step and scaled by the loading
    /// factor.
    pub(super) turned: Vector3<f64>,
    /// Deflection after the step.
    pub(super) after: Vector3<f64>,
    /// Rate of the deflection in the step.
    pub(super) rate: Vector3<f64>,
    /// The force, or torque, at the end of the step.
    pub(super) force: Vector3<f64>,
}

impl SpringStep {
    /// Work of dashpot and slider. Energy that the spring loses because its plane turns or it stiffens counts as
    /// friction.
    ///
    /// While the slider holds, F = -k s - eta v, and the dashpot takes eta v^2 dt. While it slides, the bodies lose
    /// -F v dt, and the spring stores (k/2) (s'^2 - s^2) of this.
    pub(super) fn work(&self, motion: &SpringMotion, dt: f64) -> ContactWork {
        let SpringMotion { before, turned, after, rate, force } = *motion;
        let [stiffness_before, stiffness] = self.stiffness;
        let turning =
            0.5 * (stiffness_before * before.norm_squared() - stiffness * turned.norm_squared());
        let (stretched, held) = (turned + rate * dt, after * -stiffness - rate * self.damping);
        // Equal up to rounding.
        let differs =
            |one: Vector3<f64>, other: Vector3<f64>| (one - other).norm() > 1.0e-9 * other.norm();
        let slides = differs(after, stretched) || differs(force, held);
        let (dashpot, friction) = if slides {
            let stored = 0.5 * stiffness * (after.norm_squared() - turned.norm_squared());
            (0.0, force.dot(&rate) * dt + stored)
        } else {
            (-self.damping * rate.norm_squared() * dt, 0.0)
        };
        ContactWork { dashpot, friction: friction - turning, ..ContactWork::default() }
    }
}
