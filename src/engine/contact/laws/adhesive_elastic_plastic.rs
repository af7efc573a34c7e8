//! Adhesive elastic-plastic contact of porous agglomerates.
//!
//! References:
//! * D. Liu, B. G. M. van Wachem, R. F. Mudde, X. Chen, J. R. van Ommen, "An adhesive CFD-DEM model for simulating
//!   nanoparticle agglomerate fluidization", AIChE J. 62 (2016) 2259-2270
//! * O. R. Walton, R. L. Braun, "Viscosity, granular-temperature, and stress calculations for shearing assemblies of
//!   inelastic, frictional disks", J. Rheol. 30 (1986) 949-980, <https://doi.org/10.1122/1.549893>

use super::parts::{
    FrictionCap, Hysteresis, HystereticParameters, Reloading, friction_cap, stick_or_slide,
};
use super::{Adhesion, ContactLawValues, ExampleScales, RegisteredContactLaw};
use crate::contact::invalid_law::{InvalidContactLaw, require_in_range};
use crate::contact::{
    CoarseGraining, Contact, ContactForce, ContactForceLaw, ContactStep, ContactWork,
    StoredInContact,
};
use crate::particles::ContactHistory;
use crate::rules::adhesion_factor;
use crate::schema::{Allowed, Key, Mixing, Value, Word};

const ADHESION: Key = Key::number(
    "adhesion",
    Allowed::NOT_NEGATIVE,
    "Adhesion F0 in contact, for particles of all sizes",
)
.unit("force")
.or(&["adhesion_over_weight"])
.mixed(Mixing::Geometric);
const ADHESION_OVER_WEIGHT: Key = Key::number(
    "adhesion_over_weight",
    Allowed::NOT_NEGATIVE,
    "F0 over the weight at the reference diameter, the Bond number before a contact is compressed",
)
.formerly(&["bond_number"])
.or(&["adhesion"])
.mixed(Mixing::Geometric);
const PRIMARY_DIAMETER: Key = Key::number(
    "primary_diameter",
    Allowed::NOT_NEGATIVE,
    "Diameter d_NP of the primary particles; up to F0 / k_unload (0, for example) adhesion has no limit",
)
.unit("length")
.printed(Value::Derived("20 nm"), "")
.required_when("units are dimensionless");

const FRICTION_CAP: Key =
    Key::word(friction_cap::FRICTION_CAP, FrictionCap::WORDS, friction_cap::MEANING)
        .default(Value::Word("contact"));
const RELOADING: Key =
    Key::word("reloading", WAYS, "How a contact on the limit of adhesion is loaded again")
        .default(Value::Word("from_limit"));
const WAYS: &[Word] = &[
    Word::new("from_limit", "along the unloading line through the present point (Luding 2008)"),
    Word::new("along_limit", "back along the limit, to the unloading line that it came from"),
];

/// Diameter of the primary particles of Liu et al., m.
const LIU_PRIMARY_DIAMETER: f64 = 20.0e-9;

/// A hysteretic spring shifted by a constant attraction F0, which acts while the spheres overlap:
///
/// ```math
/// \begin{aligned}
/// \text{first loading} \quad & F = k_\text{load}\, \delta - F_0 \\
/// \text{un- and reloading} \quad & F = k_\text{unload} (\delta - \delta_p) - F_0, \quad \delta_p = \psi_p\, \delta_\text{max} \\
/// \text{but not below} \quad & f_\text{ad} = -\left( \frac{\delta_p}{d_{NP}} + 1 \right) F_0
/// \end{aligned}
/// ```
///
/// where delta_max is the largest overlap since the contact began, psi_p = 1 - k_load / k_unload the plasticity
/// index and d_NP the diameter of the primary particles over which the contact is flattened. On separation from f_ad
/// the force follows a straight line to -F0 at delta = 0. That line is the same for every delta_max,
///
/// ```math
/// F = -F_0 - k_c\, \delta, \qquad k_c = \frac{F_0}{d_{NP} - F_0 / k_\text{unload}},
/// ```
///
/// so the force of a contact is the larger of the unloading line and this one. A contact that is loaded again from this
/// line either follows the unloading line through the present point, with delta_max lowered accordingly
/// ([`Reloading::FromLimit`]), or returns along it ([`Reloading::AlongLimit`]). If d_NP <= F0 / k_unload, the line
/// is never reached, and the force falls along the unloading line until the spheres separate. Without F0 there is no
/// attraction.
///
/// F0 is the same for all sizes: it is the force of the primary particles that meet. F_n = F - eta_n v_n with
/// eta_n = 2 sqrt(m* k_load) |ln e| / sqrt(pi^2 + ln^2 e). F_t = -k_t s - eta_t v_t, with eta_t of the same form in k_t
/// and (2/7) m*. It is at most mu_f |F_n + F0|, so that a contact held by adhesion alone still resists sliding
/// ([`FrictionCap::Contact`]), or at most mu_f |F_n| ([`FrictionCap::Net`]).
///
/// ```
/// # use talcum_engine as talcum;
/// use nalgebra::Vector3;
/// use talcum::contact::{AdhesiveElasticPlastic, Contact, ContactForceLaw, HystereticParameters};
/// use talcum::particles::ContactHistory;
///
/// let parameters = HystereticParameters {
///     loading_stiffness: 1.5,
///     unloading_stiffness: 2.0,
///     tangential_stiffness: 0.5,
///     restitution: 1.0,
///     friction: 0.3,
/// };
/// let law = AdhesiveElasticPlastic::new(parameters, 0.25, 0.625)?; // k_c = 0.25 / (0.625 - 0.125) = 0.5
/// let mut history = ContactHistory::default();
/// let mut force_at = |overlap| {
///     let at_rest = Contact {
///         overlap,
///         normal: Vector3::z(),
///         relative_velocity: Vector3::zeros(),
///         relative_spin: Vector3::zeros(),
///         reduced_mass: 0.5,
///         reduced_radius: 0.25,
///         reduced_inertia: 0.05,
///         cohesion: 0.0,
///     };
///     law.force(&at_rest, &mut history, 0.0).normal
/// };
/// assert_eq!(force_at(1.0), 1.25); // 1.5 - 0.25
/// assert_eq!(force_at(0.5), 0.25); // 2 (0.5 - 0.25) - 0.25
/// assert_eq!(force_at(0.1), -0.3); // not 2 (0.1 - 0.25) - 0.25, but -0.25 - 0.5 * 0.1
/// # Ok::<(), talcum::contact::InvalidContactLaw>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdhesiveElasticPlastic {
    hysteresis: Hysteresis,
    attraction: f64,
    primary_diameter: f64,
}

/// k_c = F0 / (d_NP - F0 / k_unload); infinite if the limit of adhesion is never reached, 0 without adhesion.
fn adhesion_stiffness(attraction: f64, primary_diameter: f64, unloading_stiffness: f64) -> f64 {
    let room = primary_diameter - attraction / unloading_stiffness;
    match attraction {
        0.0 => 0.0,
        _ if room > 0.0 => attraction / room,
        _ => f64::INFINITY,
    }
}

impl AdhesiveElasticPlastic {
    /// Makes a law from the parameters of its springs, F0 (force) and d_NP (length; 0: adhesion has no limit).
    ///
    /// # Errors
    /// If a parameter is out of its range, F0 or d_NP negative.
    pub fn new(
        parameters: HystereticParameters,
        attraction: f64,
        primary_diameter: f64,
    ) -> Result<Self, InvalidContactLaw> {
        require_in_range(&ADHESION, attraction)?;
        require_in_range(&PRIMARY_DIAMETER, primary_diameter)?;
        let unloading = parameters.unloading_stiffness;
        let limit = adhesion_stiffness(attraction, primary_diameter, unloading);
        Ok(Self { hysteresis: Hysteresis::new(&parameters, limit)?, attraction, primary_diameter })
    }

    /// This law with another limit of friction; `new` gives [`FrictionCap::Contact`].
    pub fn with_friction_cap(self, friction_cap: FrictionCap) -> Self {
        Self { hysteresis: self.hysteresis.with_friction_cap(friction_cap), ..self }
    }

    /// This law with another kind of reloading from the limit of adhesion; `new` gives [`Reloading::FromLimit`].
    pub fn with_reloading(self, reloading: Reloading) -> Self {
        Self { hysteresis: self.hysteresis.with_reloading(reloading), ..self }
    }

    /// Constant attraction F0.
    pub fn attraction(&self) -> f64 {
        self.attraction
    }

    /// Adhesion stiffness k_c, infinite if the limit of adhesion is never reached.
    pub fn adhesion_stiffness(&self) -> f64 {
        self.hysteresis.adhesion_stiffness()
    }
}

impl ContactForceLaw for AdhesiveElasticPlastic {
    #[inline(always)]
    fn force(&self, contact: &Contact, history: &mut ContactHistory, dt: f64) -> ContactForce {
        stick_or_slide(self, contact, history, dt)
    }

    #[inline(always)]
    fn sticking_force(
        &self,
        contact: &Contact,
        history: &mut ContactHistory,
        dt: f64,
    ) -> (ContactForce, bool) {
        self.hysteresis.sticking_force(contact, history, dt, self.attraction, self.attraction)
    }

    #[inline(always)]
    fn slide(&self, _contact: &Contact, history: &mut ContactHistory, force: &mut ContactForce) {
        self.hysteresis.slide(history, force);
    }

    /// Energy of the springs, and -F0 delta for the attraction.
    fn stored_energy(&self, contact: &Contact, history: &ContactHistory) -> StoredInContact {
        let springs = self.hysteresis.stored_energy(contact.overlap, history);
        StoredInContact { normal: springs.normal - self.attraction * contact.overlap, ..springs }
    }

    fn work(&self, step: &ContactStep<'_>) -> ContactWork {
        self.hysteresis.work(step)
    }

    fn stiffness(&self, _overlap: f64, _reduced_radius: f64) -> f64 {
        self.hysteresis.loading_stiffness()
    }

    fn contact_duration(&self, reduced_mass: f64, _reduced_radius: f64) -> f64 {
        self.hysteresis.contact_duration(reduced_mass)
    }

    fn largest_force(&self, overlap: f64, _reduced_radius: f64) -> f64 {
        self.hysteresis.unloading_stiffness() * overlap + self.attraction
    }
}

impl RegisteredContactLaw for AdhesiveElasticPlastic {
    const MEANING: &'static str = "hysteretic springs with a constant adhesion (Liu 2016)";
    const KEYS: &'static [Key] = &{
        let [unloading, loading, plasticity, tangential] = HystereticParameters::KEYS;
        [
            unloading,
            loading,
            plasticity,
            tangential,
            ADHESION,
            ADHESION_OVER_WEIGHT,
            PRIMARY_DIAMETER,
            FRICTION_CAP,
            RELOADING,
        ]
    };
    const ADHESION: Adhesion =
        Adhesion { keys: &[ADHESION.name, ADHESION_OVER_WEIGHT.name], replaces_cohesion: true };

    fn from_keys(values: &dyn ContactLawValues) -> Option<Result<Self, InvalidContactLaw>> {
        let parameters = HystereticParameters::from_keys(values);
        let key = values.given(&[ADHESION.name, ADHESION_OVER_WEIGHT.name]);
        let given = key.and_then(|key| values.number(key));
        let attraction = match (key, given) {
            (Some(key @ "adhesion_over_weight"), Some(bond)) if bond != 0.0 => {
                values.attraction_of_bond_number(bond, key, ADHESION.name)
            }
            _ => given,
        };
        if values.is_si() {
            values.note_default(PRIMARY_DIAMETER.name)
        } else {
            values.require(PRIMARY_DIAMETER.name)
        }
        let primary = if values.is_given("primary_diameter") {
            values.number("primary_diameter")
        } else {
            values.is_si().then_some(LIU_PRIMARY_DIAMETER)
        };
        let cap = FrictionCap::from_keys(values)?;
        let reloading = match values.word(RELOADING.name)? {
            "along_limit" => Reloading::AlongLimit,
            _ => Reloading::FromLimit,
        };
        let law = Self::new(parameters?, attraction?, primary?);
        Some(law.map(|law| law.with_friction_cap(cap).with_reloading(reloading)))
    }

    /// The flattened length d_NP is kept, as the adhesion is.
    fn stiffened(&self, factor: f64) -> Self {
        let unloading = factor * self.hysteresis.unloading_stiffness();
        let limit = adhesion_stiffness(self.attraction, self.primary_diameter, unloading);
        Self { hysteresis: self.hysteresis.stiffened(factor, limit), ..*self }
    }

    /// F0 falls by the factor, and d_NP, a length over which it acts, grows by its inverse.
    fn keeping_work(&self, reduction: f64) -> Self {
        let factor = adhesion_factor(reduction, Self::OVERLAP_EXPONENT);
        let (attraction, primary_diameter) =
            (factor * self.attraction, self.primary_diameter / factor);
        let unloading = self.hysteresis.unloading_stiffness();
        let limit = adhesion_stiffness(attraction, primary_diameter, unloading);
        let hysteresis = self.hysteresis.stiffened(1.0, limit);
        Self { hysteresis, attraction, primary_diameter }
    }

    fn coarse_grained(&self, parcels: &CoarseGraining) -> Self {
        let attraction = parcels.force() * self.attraction;
        let primary_diameter = parcels.length() * self.primary_diameter;
        let unloading = parcels.stiffness() * self.hysteresis.unloading_stiffness();
        let limit = adhesion_stiffness(attraction, primary_diameter, unloading);
        let hysteresis = self.hysteresis.stiffened(parcels.stiffness(), limit);
        Self { hysteresis, attraction, primary_diameter }
    }

    /// Laws with the limit of adhesion, without it, and with the formula printed by Liu et al. taken literally.
    fn examples(scales: ExampleScales) -> Vec<Self> {
        let parameters = HystereticParameters::example(scales);
        let attraction = 0.3 * scales.stiffness * scales.overlap;
        let law = |diameter: f64| Self::new(parameters, attraction, diameter).ok();
        let limited = law(0.5 * scales.overlap);
        let literal = limited.map(|law| {
            law.with_friction_cap(FrictionCap::Net).with_reloading(Reloading::AlongLimit)
        });
        [limited, law(0.0), literal].into_iter().flatten().collect()
    }
}
