//! Friction in the tangent plane: spring, dashpot and slider (Cundall & Strack, Géotechnique 29 (1979) 47-65).

use crate::contact::{Contact, ContactForce, ContactForceLaw};
use crate::particles::ContactHistory;
use nalgebra::Vector3;

/// F_t = -k_t s - eta_t v_t with s the tangential displacement since the contact began. If its magnitude exceeds the
/// limit, F_t is scaled down to the limit, and s is set to -F_t / k_t.
#[derive(Clone, Copy)]
pub(crate) struct Slider {
    /// Tangential stiffness k_t, force per length.
    pub(crate) stiffness: f64,
    /// Largest force: mu times the normal force to which friction is proportional.
    pub(crate) limit: f64,
}

/// Parameters by which the spring is advanced, and the parallel dashpot.
#[derive(Clone, Copy)]
pub(crate) struct SliderStep {
    /// Tangential damping eta_t, force per velocity.
    pub(crate) damping: f64,
    /// Factor of the old displacement: 1, unless k_t has grown in the last step.
    pub(crate) loading_factor: f64,
    pub(crate) dt: f64,
}

impl Slider {
    /// Force on the second body, after the spring has been projected onto the tangent plane and advanced.
    #[inline(always)]
    pub(crate) fn force(
        self,
        contact: &Contact,
        history: &mut ContactHistory,
        step: SliderStep,
    ) -> Vector3<f64> {
        let (mut force, _) = self.sticking_force(contact, history, step);
        self.slide(&mut force, history);
        force
    }

    /// The force if the surfaces stick, and whether it exceeds the limit.
    #[inline(always)]
    pub(crate) fn sticking_force(
        self,
        contact: &Contact,
        history: &mut ContactHistory,
        step: SliderStep,
    ) -> (Vector3<f64>, bool) {
        let SliderStep { damping, loading_factor, dt } = step;
        let slip = contact.tangential(&contact.relative_velocity);
        let turned = contact.tangential(&history.tangential_spring);
        let spring = turned * loading_factor + slip * dt;
        history.tangential_spring = spring;
        let force = spring * -self.stiffness - slip * damping;
        (force, force.norm_squared() > self.limit * self.limit)
    }

    /// Scales down a force that exceeds the limit, and its spring.
    #[inline(always)]
    pub(crate) fn slide(self, force: &mut Vector3<f64>, history: &mut ContactHistory) {
        let squared = force.norm_squared();
        let slides = squared > self.limit * self.limit;
        *force *= if slides { self.limit / squared.sqrt() } else { 1.0 };
        let compliance = if self.stiffness > 0.0 { 1.0 / self.stiffness } else { 0.0 };
        history.tangential_spring = force.zip_map(&history.tangential_spring, |force, spring| {
            if slides { -force * compliance } else { spring }
        });
    }
}

/// The force of a law that distinguishes sticking from sliding.
#[inline(always)]
pub(crate) fn stick_or_slide(
    law: &impl ContactForceLaw,
    contact: &Contact,
    history: &mut ContactHistory,
    dt: f64,
) -> ContactForce {
    let (mut force, _) = law.sticking_force(contact, history, dt);
    law.slide(contact, history, &mut force);
    force
}

/// |ln e| / sqrt(pi^2 + ln^2 e): damping over critical damping of a linear oscillator for which a half period gives the
/// restitution coefficient e.
pub(super) fn damping_ratio(restitution: f64) -> f64 {
    let log = libm::log(restitution);
    log.abs() / (std::f64::consts::PI.powi(2) + log * log).sqrt()
}
