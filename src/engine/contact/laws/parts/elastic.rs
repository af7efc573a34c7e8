//! Elastic spheres in contact: moduli of two bodies, and the common parts of the laws of Hertz, of Mindlin, and of
//! Johnson, Kendall and Roberts.

use super::slider::{Slider, damping_ratio};
use crate::contact::invalid_law::{InvalidContactLaw, require, require_in_range};
use crate::contact::{
    ContactLawValues, ContactStep, ContactWork, ExampleScales, FRICTION, RESTITUTION, SpringStep,
};
use crate::particles::ContactHistory;
use crate::schema::{Allowed, Key, KeyValues, Mixing};

const YOUNG_MODULUS: Key = Key::number(
    "young_modulus",
    Allowed::POSITIVE,
    "Young's modulus E; at a wall that of the wall, 1e30 for a rigid one",
)
.unit("stress")
.mixed(Mixing::OfBody);
const POISSON_RATIO: Key = Key::number(
    "poisson_ratio",
    Allowed::between(0.0, 0.5),
    "Poisson's ratio nu; at a wall that of the wall",
)
.mixed(Mixing::OfBody);

/// Overlap of the impact whose duration is reported, over the diameter 4 R* of two equal spheres.
const REPORTED_OVERLAP: f64 = 0.01;

/// Elastic constants of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elasticity {
    /// Young's modulus E, force per area; infinite for a rigid body.
    pub young_modulus: f64,
    /// Poisson's ratio nu.
    pub poisson_ratio: f64,
}

impl Elasticity {
    /// Keys of the case file.
    pub(crate) const KEYS: [Key; 2] = [YOUNG_MODULUS, POISSON_RATIO];

    /// The constants with these values; `None` if one is missing or wrong, or if the law has none.
    pub fn from_keys(values: &(impl KeyValues + ?Sized)) -> Option<Self> {
        if !values.is_given("young_modulus") {
            return None;
        }
        let young_modulus = values.number("young_modulus")?;
        Some(Self { young_modulus, poisson_ratio: values.number("poisson_ratio")? })
    }
}

/// Moduli of a contact: 1/E* = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2 and 1/G* = (2 - nu_1)/G_1 + (2 - nu_2)/G_2
/// with G = E / (2 (1 + nu)).
///
/// ```
/// # use talcum_engine as talcum;
/// use talcum::contact::{ContactModuli, Elasticity};
/// let steel = Elasticity { young_modulus: 2.0e11, poisson_ratio: 0.0 };
/// let alike = ContactModuli::between(steel, steel)?;
/// assert_eq!((alike.normal, alike.shear), (1.0e11, 2.5e10));
/// let rigid = Elasticity { young_modulus: f64::INFINITY, poisson_ratio: 0.3 };
/// assert_eq!(ContactModuli::between(steel, rigid)?.normal, 2.0e11);
/// # Ok::<(), talcum::contact::InvalidContactLaw>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactModuli {
    /// Effective Young's modulus E*.
    pub normal: f64,
    /// Effective shear modulus G*.
    pub shear: f64,
}

/// Parameters of an elastic law.
pub(crate) struct ElasticParameters {
    pub(crate) moduli: ContactModuli,
    pub(crate) restitution: f64,
    pub(crate) friction: f64,
}

impl ElasticParameters {
    /// The parameters with these values; `None` if one is missing or wrong.
    pub(crate) fn from_keys(
        values: &dyn ContactLawValues,
    ) -> Option<Result<Self, InvalidContactLaw>> {
        let body = Elasticity::from_keys(values)?;
        let (restitution, friction) = (values.number("restitution")?, values.number("friction")?);
        let moduli = ContactModuli::between(values.other_body().unwrap_or(body), body);
        Some(moduli.map(|moduli| Self { moduli, restitution, friction }))
    }
}

impl ContactModuli {
    /// The moduli of a contact of two bodies.
    ///
    /// # Errors
    /// If a modulus is not positive, nu not within -1 to 0.5, or both bodies are rigid.
    pub fn between(one: Elasticity, other: Elasticity) -> Result<Self, InvalidContactLaw> {
        for Elasticity { young_modulus: e, poisson_ratio: nu } in [one, other] {
            require(e > 0.0, "young_modulus", e, "positive")?;
            require(nu > -1.0 && nu <= 0.5, "poisson_ratio", nu, "above -1 and at most 0.5")?;
        }
        let softer = one.young_modulus.min(other.young_modulus);
        require(softer.is_finite(), "young_modulus", softer, "finite for one of the bodies")?;
        let compliance = |body: Elasticity| {
            let Elasticity { young_modulus: e, poisson_ratio: nu } = body;
            [(1.0 - nu * nu) / e, 2.0 * (2.0 - nu) * (1.0 + nu) / e]
        };
        let ([n1, t1], [n2, t2]) = (compliance(one), compliance(other));
        Ok(Self { normal: 1.0 / (n1 + n2), shear: 1.0 / (t1 + t2) })
    }
}

impl ContactModuli {
    /// Moduli for the examples that the elastic laws provide: for R* of about 1 the stiffness 2 E* a is of the order of
    /// `scales.stiffness`.
    pub(crate) fn example(scales: ExampleScales) -> Self {
        let normal = scales.stiffness / scales.overlap.sqrt();
        Self { normal, shear: 0.3 * normal }
    }
}

/// Springs and dashpots of a contact of radius a.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Elastic {
    pub(crate) moduli: ContactModuli,
    pub(crate) friction: f64,
    /// 2 sqrt(5/6) |ln e| / sqrt(pi^2 + ln^2 e).
    damping: f64,
}

impl Elastic {
    pub(crate) fn new(
        moduli: ContactModuli,
        restitution: f64,
        friction: f64,
    ) -> Result<Self, InvalidContactLaw> {
        require(moduli.normal > 0.0, "young_modulus", moduli.normal, "positive")?;
        require(moduli.shear > 0.0, "young_modulus", moduli.shear, "positive")?;
        require_in_range(&RESTITUTION, restitution)?;
        require_in_range(&FRICTION, friction)?;
        let damping = 2.0 * (5.0_f64 / 6.0).sqrt() * damping_ratio(restitution);
        Ok(Self { moduli, friction, damping })
    }

    /// These springs and dashpots with moduli that are larger by a factor.
    pub(crate) fn stiffened(&self, factor: f64) -> Self {
        let ContactModuli { normal, shear } = self.moduli;
        Self { moduli: ContactModuli { normal: factor * normal, shear: factor * shear }, ..*self }
    }

    /// S_n = 2 E* a.
    #[inline(always)]
    pub(crate) fn normal_stiffness(&self, radius: f64) -> f64 {
        2.0 * self.moduli.normal * radius
    }

    /// S_t = 8 G* a, Mindlin's stiffness without slip.
    #[inline(always)]
    pub(crate) fn tangential_stiffness(&self, radius: f64) -> f64 {
        8.0 * self.moduli.shear * radius
    }

    /// Friction of a contact with this radius.
    #[inline(always)]
    pub(crate) fn slider(&self, radius: f64, friction_normal: f64) -> Slider {
        Slider {
            stiffness: self.tangential_stiffness(radius),
            limit: self.friction * friction_normal,
        }
    }

    /// (S_t / 2) s^2 for a contact with this radius.
    pub(crate) fn tangential_energy(&self, radius: f64, history: &ContactHistory) -> f64 {
        0.5 * self.tangential_stiffness(radius) * history.tangential_spring.norm_squared()
    }

    /// Work of dashpots and friction over a step, given the radius of the contact before it and after it.
    pub(crate) fn work(&self, step: &ContactStep<'_>, radii: [f64; 2]) -> ContactWork {
        let [before, radius] = radii;
        let mass = step.contact.reduced_mass;
        let stiffness = radii.map(|radius| self.tangential_stiffness(radius));
        let damping = self.dashpot(stiffness[1], mass);
        let loading_factor = loading_factor(before, radius);
        let spring = SpringStep { stiffness, damping, loading_factor };
        let dashpot = step.dashpot_work(self.dashpot(self.normal_stiffness(radius), mass));
        step.tangential_work(&spring) + ContactWork { dashpot, ..ContactWork::default() }
    }

    /// eta = 2 sqrt(5/6) |ln e| / sqrt(pi^2 + ln^2 e) sqrt(S m*), which gives a restitution coefficient of e at any
    /// speed in a normal impact under Hertz's law.
    #[inline(always)]
    pub(crate) fn dashpot(&self, stiffness: f64, reduced_mass: f64) -> f64 {
        self.damping * (stiffness * reduced_mass).sqrt()
    }

    /// 2.943 delta / V for the elastic impact under Hertz's law whose largest overlap is 1 % of the diameter 4 R* of
    /// two equal spheres: from (1/2) m* V^2 = (8/15) E* sqrt(R*) delta^(5/2). Slower impacts last longer.
    pub(crate) fn contact_duration(&self, reduced_mass: f64, reduced_radius: f64) -> f64 {
        let overlap = REPORTED_OVERLAP * 4.0 * reduced_radius;
        let energy = 8.0 / 15.0 * self.hertz_force(overlap, reduced_radius) * 0.75 * overlap;
        2.943 * overlap / (2.0 * energy / reduced_mass).sqrt()
    }

    /// (4/3) E* sqrt(R*) delta^(3/2).
    #[inline(always)]
    pub(crate) fn hertz_force(&self, overlap: f64, reduced_radius: f64) -> f64 {
        4.0 / 3.0 * self.moduli.normal * (reduced_radius * overlap).sqrt() * overlap
    }
}

/// Factor of a tangential displacement after the contact radius has changed from `before` to `now`. A contact that is
/// loaded keeps its tangential force, not its displacement; one that is unloaded loses force in proportion to S_t.
/// Otherwise cycles of loading would create energy (Elata & Berryman, Mech. Mater. 24 (1996) 229-240).
#[inline(always)]
pub(crate) fn loading_factor(before: f64, now: f64) -> f64 {
    if before < now { before / now } else { 1.0 }
}
