//! Resistance to rolling, for any contact law.
//!
//! Reference: J. Ai, J.-F. Chen, J. M. Rotter, J. Y. Ooi, "Assessment of rolling resistance models in discrete element
//! simulations", Powder Technol. 206 (2011) 269-282, <https://doi.org/10.1016/j.powtec.2010.09.030>

use super::energy::SpringMotion;
use super::invalid_law::{InvalidContactLaw, require_in_range};
use super::{Contact, ContactWork, SpringStep, TwistingFriction};
use crate::schema::{Allowed, Key, Mixing, Word};
use nalgebra::Vector3;

const ROLLING_FRICTION: Key = Key::number(
    "rolling_friction",
    Allowed::NOT_NEGATIVE,
    "Coefficient mu_r: the torque is at most mu_r R* times the force that limits sliding at mu = 1",
)
.mixed(Mixing::Geometric);
const ROLLING_DAMPING: Key = Key::number(
    "rolling_damping",
    Allowed::between(0.0, 1.0),
    "Fraction eta_r of the critical damping in the rolling dashpot",
);

/// The words of `contact.rolling`, each with its keys.
pub const ROLLING: &[Word] = &[
    Word::new("none", ""),
    Word::with("constant_torque", "a constant torque against rolling", &[ROLLING_FRICTION]),
    Word::with(
        "elastic_plastic",
        "a spring that yields, with a dashpot (EPSD)",
        &[ROLLING_FRICTION, ROLLING_DAMPING],
    ),
];

/// A kind of resistance to rolling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RollingKind {
    /// A torque mu_r R* F against rolling at any speed (type A of Ai et al.).
    ConstantTorque,
    /// A rolling spring k_r = 2.25 k_n (mu_r R*)^2 that yields at mu_r R* F, and a dashpot (type C of Ai et al., EPSD).
    ElasticPlastic {
        /// eta_r, relative to the critical damping 2 sqrt(I_r k_r); I_r = (7/2) I* is the moment of inertia about the
        /// contact.
        damping: f64,
    },
}

/// Rolling friction.
///
/// With F the normal force to which friction is proportional ([`super::ContactForce::friction_normal`]) and omega the
/// relative spin in the tangent plane (spin about the normal is not resisted), the torque on the second body is
///
/// ```math
/// \begin{aligned}
/// \text{constant torque} \quad & -\mu_r R^* F\, \frac{\boldsymbol{\omega}}{|\boldsymbol{\omega}|}
///   \text{, at most what stops } \boldsymbol{\omega} \text{ within the step} \\
/// \text{elastic-plastic} \quad & -k_r \boldsymbol{\theta} - 2 \eta_r \sqrt{I_r k_r}\, \boldsymbol{\omega} \text{, at most } \mu_r R^* F
/// \end{aligned}
/// ```
///
/// with theta the angle rolled; the spring yields at |k_r theta| = mu_r R* F. (Ai et al. switch the dashpot off only
/// while the spring yields, but when fast rolling begins, the torque of the dashpot would be many times that of
/// friction.)
///
/// k_n is the law's stiffness at the overlap. If it grows while the contact is loaded, the torque is kept and theta
/// shrinks: a spring that stiffens while it is deflected would create energy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollingFriction {
    kind: RollingKind,
    coefficient: f64,
}

impl RollingFriction {
    /// Rolling friction of a given kind, with the dimensionless coefficient mu_r.
    ///
    /// # Errors
    /// If mu_r or eta_r is negative, or eta_r above 1.
    pub fn new(kind: RollingKind, coefficient: f64) -> Result<Self, InvalidContactLaw> {
        if let RollingKind::ElasticPlastic { damping } = kind {
            require_in_range(&ROLLING_DAMPING, damping)?;
        }
        require_in_range(&ROLLING_FRICTION, coefficient)?;
        Ok(Self { kind, coefficient })
    }
}

impl RollingFriction {
    /// Its kind.
    pub(crate) fn kind(&self) -> RollingKind {
        self.kind
    }

    /// mu_r R*; length.
    #[inline(always)]
    fn arm(&self, contact: &Contact) -> f64 {
        self.coefficient * contact.reduced_radius
    }

    /// Whether there is any torque: mu_r > 0.
    pub fn resists(&self) -> bool {
        self.coefficient > 0.0
    }

    /// Stiffness of the rolling spring, 2.25 k_n (mu_r R*)^2, and coefficient of its dashpot; 0 for a constant torque.
    fn spring(&self, contact: &Contact, normal_stiffness: f64) -> [f64; 2] {
        match self.kind {
            RollingKind::ConstantTorque => [0.0; 2],
            RollingKind::ElasticPlastic { damping } => {
                ElasticPlastic(*self, damping).spring(contact, normal_stiffness)
            }
        }
    }

    /// Energy of the rolling spring at a given stiffness of the law.
    pub(super) fn stored_energy(
        &self,
        contact: &Contact,
        stiffness: f64,
        angle: &Vector3<f64>,
    ) -> f64 {
        0.5 * self.spring(contact, stiffness)[0] * angle.norm_squared()
    }

    /// Work of the resistance to rolling over a step in which the angle changed from `before` to `after` and which
    /// ended with this torque. `stiffness` is that of the law before and after the step.
    pub(super) fn work(
        &self,
        contact: &Contact,
        stiffness: [f64; 2],
        [before, after]: [Vector3<f64>; 2],
        torque: Vector3<f64>,
        dt: f64,
    ) -> ContactWork {
        let rate = contact.tangential(&contact.relative_spin);
        let loading_factor =
            if stiffness[0] < stiffness[1] { stiffness[0] / stiffness[1] } else { 1.0 };
        let turned = contact.tangential(&before) * loading_factor;
        let [[spring_before, _], [spring, damping]] =
            stiffness.map(|stiffness| self.spring(contact, stiffness));
        let step = SpringStep { stiffness: [spring_before, spring], damping, loading_factor };
        step.work(&SpringMotion { before, turned, after, rate, force: torque }, dt)
    }
}

/// Factor that scales a vector of this squared length down to a limit.
#[inline(always)]
fn within(limit: f64, squared: f64) -> f64 {
    if squared > limit * limit { limit / squared.sqrt() } else { 1.0 }
}

/// Resistance to rolling, and to twisting, or none, chosen once for all pairs.
pub(crate) trait Rolling: Copy {
    /// Whether there is any resistance.
    const ACTS: bool;
    /// Whether twisting is resisted.
    const TWISTS: bool = false;

    /// Torque on the second body along the normal, after the twisting `angle` has been advanced by `dt`.
    #[inline(always)]
    fn twisting_torque(
        &self,
        _contact: &Contact,
        _friction_normal: f64,
        _stiffness: [f64; 2],
        _angle: &mut f64,
        _dt: f64,
    ) -> f64 {
        0.0
    }

    /// Torque on the second body, after `angle` has been advanced by `dt`. `stiffness` is that of the law before and
    /// after the step.
    fn torque(
        &self,
        contact: &Contact,
        friction_normal: f64,
        stiffness: [f64; 2],
        angle: &mut Vector3<f64>,
        dt: f64,
    ) -> Vector3<f64>;
}

/// No resistance.
#[derive(Clone, Copy)]
pub(crate) struct NoRolling;

impl Rolling for NoRolling {
    const ACTS: bool = false;

    #[inline(always)]
    fn torque(
        &self,
        _: &Contact,
        _: f64,
        _: [f64; 2],
        _: &mut Vector3<f64>,
        _: f64,
    ) -> Vector3<f64> {
        Vector3::zeros()
    }
}

/// Resistance to twisting, and to rolling if there is any.
#[derive(Clone, Copy)]
pub(crate) struct RollingAndTwisting {
    pub(crate) rolling: Option<RollingFriction>,
    pub(crate) twisting: TwistingFriction,
}

impl Rolling for RollingAndTwisting {
    const ACTS: bool = true;
    const TWISTS: bool = true;

    #[inline(always)]
    fn torque(
        &self,
        contact: &Contact,
        friction_normal: f64,
        stiffness: [f64; 2],
        angle: &mut Vector3<f64>,
        dt: f64,
    ) -> Vector3<f64> {
        match self.rolling {
            Some(rolling) => rolling.torque(contact, friction_normal, stiffness, angle, dt),
            None => NoRolling.torque(contact, friction_normal, stiffness, angle, dt),
        }
    }

    #[inline(always)]
    fn twisting_torque(
        &self,
        contact: &Contact,
        friction_normal: f64,
        stiffness: [f64; 2],
        angle: &mut f64,
        dt: f64,
    ) -> f64 {
        self.twisting.torque(contact, friction_normal, stiffness, angle, dt)
    }
}

impl Rolling for RollingFriction {
    const ACTS: bool = true;

    #[inline(always)]
    fn torque(
        &self,
        contact: &Contact,
        friction_normal: f64,
        stiffness: [f64; 2],
        angle: &mut Vector3<f64>,
        dt: f64,
    ) -> Vector3<f64> {
        match self.kind {
            RollingKind::ConstantTorque => {
                ConstantTorque(*self).torque(contact, friction_normal, stiffness, angle, dt)
            }
            RollingKind::ElasticPlastic { damping } => ElasticPlastic(*self, damping).torque(
                contact,
                friction_normal,
                stiffness,
                angle,
                dt,
            ),
        }
    }
}

/// Rolling friction with a constant torque. The kind is known at compile time: a loop without this knowledge would
/// compute both kinds for each pair.
#[derive(Clone, Copy)]
pub(crate) struct ConstantTorque(pub(crate) RollingFriction);

impl Rolling for ConstantTorque {
    const ACTS: bool = true;

    #[inline(always)]
    fn torque(
        &self,
        contact: &Contact,
        friction_normal: f64,
        _stiffness: [f64; 2],
        angle: &mut Vector3<f64>,
        dt: f64,
    ) -> Vector3<f64> {
        let rolling = contact.tangential(&contact.relative_spin);
        let limit = self.0.arm(contact) * friction_normal;
        *angle = Vector3::zeros();
        let inertia = contact.reduced_inertia;
        let speed = rolling.norm();
        let per_step = if dt > 0.0 { inertia / dt } else { 0.0 };
        rolling * -(if speed * inertia > limit * dt { limit / speed } else { per_step })
    }
}

/// Rolling friction with a spring and a dashpot, with its eta_r.
#[derive(Clone, Copy)]
pub(crate) struct ElasticPlastic(pub(crate) RollingFriction, pub(crate) f64);

impl ElasticPlastic {
    /// Stiffness of the spring and coefficient of the dashpot.
    #[inline(always)]
    fn spring(self, contact: &Contact, normal_stiffness: f64) -> [f64; 2] {
        let Self(friction, damping) = self;
        let arm = friction.arm(contact);
        let spring = 2.25 * normal_stiffness * arm * arm;
        [spring, damping * 2.0 * (3.5 * contact.reduced_inertia * spring).sqrt()]
    }
}

impl Rolling for ElasticPlastic {
    const ACTS: bool = true;

    #[inline(always)]
    fn torque(
        &self,
        contact: &Contact,
        friction_normal: f64,
        stiffness: [f64; 2],
        angle: &mut Vector3<f64>,
        dt: f64,
    ) -> Vector3<f64> {
        let rolling = contact.tangential(&contact.relative_spin);
        let limit = self.0.arm(contact) * friction_normal;
        let [before, now] = stiffness;
        let [spring, dashpot] = self.spring(contact, now);
        let loading = if before < now { before / now } else { 1.0 };
        let mut theta = contact.tangential(angle) * loading + rolling * dt;
        theta *= within(limit, spring * spring * theta.norm_squared());
        *angle = theta;
        let torque = theta * -spring - rolling * dashpot;
        torque * within(limit, torque.norm_squared())
    }
}
