//! Loading, unloading and adhesion along straight lines, common to the hysteretic laws.

use super::friction_cap::FrictionCap;
use super::slider::{Slider, SliderStep, damping_ratio};
use crate::contact::invalid_law::{InvalidContactLaw, require, require_in_range};
use crate::contact::{
    Contact, ContactForce, ContactStep, ContactWork, SpringStep, StoredInContact,
};
use crate::contact::{ContactLawValues, ExampleScales, FRICTION, RESTITUTION};
use crate::particles::ContactHistory;
use crate::schema::{Allowed, Key, Mixing, Value};
use std::f64::consts::PI;

const UNLOADING_STIFFNESS: Key =
    Key::number("unloading_stiffness", Allowed::POSITIVE, "Stiffness k_unload (k_2) of unloading")
        .mixed(Mixing::Springs)
        .unit("force/length");
const LOADING_STIFFNESS: Key = Key::number(
    "loading_stiffness",
    Allowed::POSITIVE,
    "Stiffness k_load (k_1) of first loading, at most `unloading_stiffness`",
)
.unit("force/length")
.or(&["plasticity_index"])
.mixed(Mixing::Springs);
const PLASTICITY_INDEX: Key = Key::number(
    "plasticity_index",
    Allowed::from_to_below(0.0, 1.0),
    "Plasticity index psi_p = 1 - k_load / k_unload",
)
.or(&["loading_stiffness"]);
const TANGENTIAL_STIFFNESS: Key = Key::number(
    "tangential_stiffness",
    Allowed::NOT_NEGATIVE,
    "Stiffness k_t of the tangential spring",
)
.unit("force/length")
.printed(Value::Derived("2/7 of the loading stiffness"), "")
.mixed(Mixing::Springs);

/// Parameters of every hysteretic law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HystereticParameters {
    /// Loading stiffness k_load, force per overlap.
    pub loading_stiffness: f64,
    /// Unloading stiffness k_unload >= k_load, force per overlap.
    pub unloading_stiffness: f64,
    /// Tangential stiffness k_t, force per length.
    pub tangential_stiffness: f64,
    /// Restitution coefficient e of the dashpot alone, above 0 and at most 1; 1 means no dashpot.
    pub restitution: f64,
    /// Friction coefficient mu_f.
    pub friction: f64,
}

impl HystereticParameters {
    /// Keys of the case file.
    pub(crate) const KEYS: [Key; 4] =
        [UNLOADING_STIFFNESS, LOADING_STIFFNESS, PLASTICITY_INDEX, TANGENTIAL_STIFFNESS];

    /// The parameters with these values; `None` if one is missing or wrong.
    pub(crate) fn from_keys(values: &dyn ContactLawValues) -> Option<Self> {
        let unloading = values.number("unloading_stiffness")?;
        let loading = match values.given(&["loading_stiffness", "plasticity_index"])? {
            "plasticity_index" => (1.0 - values.number("plasticity_index")?) * unloading,
            key => values.number(key)?,
        };
        if loading > unloading {
            let message = format!("must be at most unloading_stiffness, {unloading}");
            values.fail(LOADING_STIFFNESS.name, message);
            return None;
        }
        let tangential = if values.is_given("tangential_stiffness") {
            values.number("tangential_stiffness")?
        } else {
            2.0 / 7.0 * loading
        };
        Some(Self {
            loading_stiffness: loading,
            unloading_stiffness: unloading,
            tangential_stiffness: tangential,
            restitution: values.number("restitution")?,
            friction: values.number("friction")?,
        })
    }

    /// Plasticity index psi_p = 1 - k_load / k_unload.
    pub fn plasticity(&self) -> f64 {
        1.0 - self.loading_stiffness / self.unloading_stiffness
    }

    /// Parameters for the examples that the hysteretic laws provide.
    pub(crate) fn example(scales: ExampleScales) -> Self {
        Self {
            loading_stiffness: 0.8 * scales.stiffness,
            unloading_stiffness: scales.stiffness,
            tangential_stiffness: 0.5 * scales.stiffness,
            restitution: scales.restitution,
            friction: 0.4,
        }
    }

    fn check(&self) -> Result<(), InvalidContactLaw> {
        let Self { loading_stiffness: loading, unloading_stiffness: unloading, .. } = *self;
        require_in_range(&LOADING_STIFFNESS, loading)?;
        let stiffer = "at least the loading stiffness";
        require(unloading >= loading, "unloading_stiffness", unloading, stiffer)?;
        require_in_range(&TANGENTIAL_STIFFNESS, self.tangential_stiffness)?;
        require_in_range(&RESTITUTION, self.restitution)?;
        require_in_range(&FRICTION, self.friction)
    }
}

/// Path along which a contact that is on the line of adhesion is loaded again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reloading {
    /// Along the unloading line through the present point: delta_max falls on the line of adhesion (Luding).
    FromLimit,
    /// Back along the line of adhesion, to the unloading line from which it came: delta_max is kept.
    AlongLimit,
}

/// The force without constant attraction, with delta_p = psi_p delta_max:
///
/// ```math
/// \begin{aligned}
/// \text{loading} \quad & \delta = \delta_\text{max}: & & k_\text{load}\, \delta \\
/// \text{unloading} \quad & \delta < \delta_\text{max}: & & k_\text{unload} (\delta - \delta_p) \\
/// \text{adhesion} \quad & \text{not below} & & -k_c\, \delta
/// \end{aligned}
/// ```
///
/// On the adhesion line delta_max falls, so that the unloading line meets it at the present overlap, unless the contact
/// is to be loaded again along that line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hysteresis {
    unloading_stiffness: f64,
    plasticity: f64,
    /// k_c, infinite if nothing limits adhesion.
    adhesion_stiffness: f64,
    loading_stiffness: f64,
    tangential_stiffness: f64,
    friction: f64,
    friction_cap: FrictionCap,
    reloading: Reloading,
    /// eta_n / sqrt(m*).
    damping_factor: f64,
    /// eta_t / sqrt(m*).
    tangential_damping_factor: f64,
}

impl Hysteresis {
    /// Checks the parameters; the adhesion stiffness k_c may be infinite.
    pub(crate) fn new(
        parameters: &HystereticParameters,
        adhesion_stiffness: f64,
    ) -> Result<Self, InvalidContactLaw> {
        parameters.check()?;
        let ratio = 2.0 * damping_ratio(parameters.restitution);
        let kt = parameters.tangential_stiffness;
        Ok(Self {
            unloading_stiffness: parameters.unloading_stiffness,
            plasticity: parameters.plasticity(),
            adhesion_stiffness,
            loading_stiffness: parameters.loading_stiffness,
            tangential_stiffness: kt,
            friction: parameters.friction,
            friction_cap: FrictionCap::Contact,
            reloading: Reloading::FromLimit,
            damping_factor: ratio * parameters.loading_stiffness.sqrt(),
            tangential_damping_factor: ratio * (2.0 / 7.0 * kt).sqrt(),
        })
    }

    /// This law with another limit of friction.
    pub(crate) fn with_friction_cap(self, friction_cap: FrictionCap) -> Self {
        Self { friction_cap, ..self }
    }

    /// This law with another kind of reloading from the line of adhesion.
    pub(crate) fn with_reloading(self, reloading: Reloading) -> Self {
        Self { reloading, ..self }
    }

    /// This law with stiffnesses that are larger by a factor, the same restitution, and this adhesion stiffness.
    pub(crate) fn stiffened(&self, factor: f64, adhesion_stiffness: f64) -> Self {
        let root = factor.sqrt();
        Self {
            unloading_stiffness: factor * self.unloading_stiffness,
            loading_stiffness: factor * self.loading_stiffness,
            tangential_stiffness: factor * self.tangential_stiffness,
            damping_factor: root * self.damping_factor,
            tangential_damping_factor: root * self.tangential_damping_factor,
            adhesion_stiffness,
            ..*self
        }
    }

    /// Spring force at an overlap, and the largest overlap for the contact history.
    #[inline(always)]
    pub(crate) fn spring(&self, overlap: f64, largest: f64) -> (f64, f64) {
        let largest = if overlap > largest { overlap } else { largest };
        let unloading = self.unloading_stiffness * (overlap - self.plasticity * largest);
        let adhesion = -self.adhesion_stiffness * overlap;
        let met = match self.reloading {
            Reloading::FromLimit => {
                (self.unloading_stiffness + self.adhesion_stiffness) * overlap
                    / (self.unloading_stiffness * self.plasticity)
            }
            Reloading::AlongLimit => largest,
        };
        // Selects are used instead of branches: contacts are evaluated side by side, in lanes.
        if unloading < adhesion { (adhesion, met) } else { (unloading, largest) }
    }

    /// Force of spring and dashpots, less a constant attraction, if the surfaces stick, and whether they slide.
    /// Friction is proportional to the normal force without its adhesive part, that is plus `adhesion`, or to the net
    /// normal force.
    #[inline(always)]
    pub(crate) fn sticking_force(
        &self,
        contact: &Contact,
        history: &mut ContactHistory,
        dt: f64,
        attraction: f64,
        adhesion: f64,
    ) -> (ContactForce, bool) {
        let separation_speed = contact.normal.dot(&contact.relative_velocity);
        let root_of_mass = contact.reduced_mass.sqrt();
        let (spring, largest) = self.spring(contact.overlap, history.largest_overlap);
        history.largest_overlap = largest;
        let normal = spring - attraction - self.damping_factor * root_of_mass * separation_speed;
        let friction_normal = match self.friction_cap {
            FrictionCap::Contact => (normal + adhesion).abs(),
            FrictionCap::Net => (normal - contact.cohesion).abs(),
        };
        let damping = self.tangential_damping_factor * root_of_mass;
        let step = SliderStep { damping, loading_factor: 1.0, dt };
        let (tangential, slides) =
            self.slider(friction_normal).sticking_force(contact, history, step);
        (ContactForce { normal, tangential, friction_normal }, slides)
    }

    /// Lets surfaces slide if they do not stick.
    #[inline(always)]
    pub(crate) fn slide(&self, history: &mut ContactHistory, force: &mut ContactForce) {
        self.slider(force.friction_normal).slide(&mut force.tangential, history);
    }

    #[inline(always)]
    fn slider(&self, friction_normal: f64) -> Slider {
        Slider { stiffness: self.tangential_stiffness, limit: self.friction * friction_normal }
    }

    /// Energies (k_unload / 2) (delta - delta_p)^2 and (k_t / 2) s^2. On a line of adhesion along which the contact is
    /// loaded again, the normal part is its value where the line begins, at delta_ad, plus
    /// (k_c / 2) (delta_ad^2 - delta^2).
    pub(crate) fn stored_energy(&self, overlap: f64, history: &ContactHistory) -> StoredInContact {
        let (unloading, adhesion) = (self.unloading_stiffness, self.adhesion_stiffness);
        let plastic = self.plasticity * history.largest_overlap;
        let end = match self.reloading {
            Reloading::FromLimit => overlap,
            Reloading::AlongLimit => overlap.max(unloading * plastic / (unloading + adhesion)),
        };
        let on_line = if end > overlap { end * end - overlap * overlap } else { 0.0 };
        let pulled = if on_line > 0.0 { 0.5 * adhesion * on_line } else { 0.0 };
        StoredInContact {
            normal: 0.5 * unloading * (end - plastic).powi(2) + pulled,
            tangential: 0.5 * self.tangential_stiffness * history.tangential_spring.norm_squared(),
        }
    }

    /// Work of dashpots, friction and plasticity over a step.
    pub(crate) fn work(&self, step: &ContactStep<'_>) -> ContactWork {
        let root_of_mass = step.contact.reduced_mass.sqrt();
        let spring = SpringStep {
            stiffness: [self.tangential_stiffness; 2],
            damping: self.tangential_damping_factor * root_of_mass,
            loading_factor: 1.0,
        };
        let own = ContactWork {
            dashpot: step.dashpot_work(self.damping_factor * root_of_mass),
            plasticity: self.plastic_work(step.before.largest_overlap, step.after.largest_overlap),
            ..ContactWork::default()
        };
        step.tangential_work(&spring) + own
    }

    /// Work along the line of first loading, -(k_load psi_p / 2) (L'^2 - L^2) for a largest overlap that grows from L
    /// to L', or along the line of adhesion, where it falls:
    /// -(k_c k_unload psi_p^2 / (k_unload + k_c) / 2) (L^2 - L'^2).
    fn plastic_work(&self, before: f64, after: f64) -> f64 {
        let grown = after * after - before * before;
        if grown >= 0.0 {
            return -0.5 * self.loading_stiffness * self.plasticity * grown;
        }
        let (unloading, adhesion) = (self.unloading_stiffness, self.adhesion_stiffness);
        0.5 * adhesion * unloading * self.plasticity.powi(2) / (unloading + adhesion) * grown
    }

    /// Loading stiffness k_load.
    pub(crate) fn loading_stiffness(&self) -> f64 {
        self.loading_stiffness
    }

    /// Unloading stiffness k_unload.
    pub(crate) fn unloading_stiffness(&self) -> f64 {
        self.unloading_stiffness
    }

    /// Adhesion stiffness k_c.
    pub(crate) fn adhesion_stiffness(&self) -> f64 {
        self.adhesion_stiffness
    }

    /// pi sqrt(m* / k_unload): half a period of the oscillator along the stiffer line.
    pub(crate) fn contact_duration(&self, reduced_mass: f64) -> f64 {
        PI * (reduced_mass / self.unloading_stiffness).sqrt()
    }
}
