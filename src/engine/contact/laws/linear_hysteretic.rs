//! Linear hysteretic contact with adhesion, with a constant unloading stiffness.
//!
//! References:
//! * S. Luding, "Cohesive, frictional powders: contact models for tension", Granular Matter 10 (2008) 235-246,
//!   <https://doi.org/10.1007/s10035-008-0099-x>
//! * O. R. Walton, R. L. Braun, "Viscosity, granular-temperature, and stress calculations for shearing assemblies of
//!   inelastic, frictional disks", J. Rheol. 30 (1986) 949-980, <https://doi.org/10.1122/1.549893>

use super::parts::{Hysteresis, HystereticParameters, stick_or_slide};
use super::{Adhesion, ContactLawValues, ExampleScales, RegisteredContactLaw};
use crate::contact::invalid_law::{InvalidContactLaw, require_in_range};
use crate::contact::{
    CoarseGraining, Contact, ContactForce, ContactForceLaw, ContactStep, ContactWork,
    StoredInContact,
};
use crate::particles::ContactHistory;
use crate::schema::{Allowed, Key, Mixing};

const ADHESION_STIFFNESS: Key =
    Key::number("adhesion_stiffness", Allowed::NOT_NEGATIVE, "Stiffness k_c of adhesion")
        .mixed(Mixing::Springs)
        .unit("force/length");

/// Linear hysteretic law with adhesion.
///
/// ```math
/// \begin{aligned}
/// \text{first loading} \quad & F = k_1\, \delta \\
/// \text{un- and reloading} \quad & F = k_2 (\delta - \delta_0), \quad \delta_0 = (1 - k_1 / k_2)\, \delta_\text{max} \\
/// \text{but not below} \quad & -k_c\, \delta
/// \end{aligned}
/// ```
///
/// On the last line delta_max is lowered, so that a contact that is loaded again follows k_2. k_1 is the loading
/// stiffness, k_2 the unloading stiffness and k_c the adhesion stiffness. Dashpots are those of
/// [`AdhesiveElasticPlastic`](super::AdhesiveElasticPlastic); friction is at most mu |F_n + k_c delta|.
///
/// Without a dashpot,
///
/// ```math
/// e^2 = \frac{k_1}{k_2} - \frac{k_c (k_2 - k_1)^2}{k_1 k_2 (k_2 + k_c)};
/// ```
///
/// spheres stick if this is negative.
///
/// ```
/// # use talcum_engine as talcum;
/// use talcum::contact::{ContactForceLaw, HystereticParameters, LinearHysteretic};
/// let parameters = HystereticParameters {
///     loading_stiffness: 1.0,
///     unloading_stiffness: 4.0,
///     tangential_stiffness: 0.5,
///     restitution: 1.0,
///     friction: 0.3,
/// };
/// let law = LinearHysteretic::new(parameters, 0.0)?;
/// assert_eq!(law.contact_duration(1.0, 0.5), std::f64::consts::PI / 2.0);
/// # Ok::<(), talcum::contact::InvalidContactLaw>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearHysteretic {
    hysteresis: Hysteresis,
}

impl LinearHysteretic {
    /// Makes a law from the parameters of its springs and the adhesion stiffness k_c, force per overlap.
    ///
    /// # Errors
    /// If a parameter is out of its range, or k_c negative.
    pub fn new(
        parameters: HystereticParameters,
        adhesion_stiffness: f64,
    ) -> Result<Self, InvalidContactLaw> {
        require_in_range(&ADHESION_STIFFNESS, adhesion_stiffness)?;
        Ok(Self { hysteresis: Hysteresis::new(&parameters, adhesion_stiffness)? })
    }
}

impl ContactForceLaw for LinearHysteretic {
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
        let adhesion = self.hysteresis.adhesion_stiffness() * contact.overlap;
        self.hysteresis.sticking_force(contact, history, dt, 0.0, adhesion)
    }

    #[inline(always)]
    fn slide(&self, _contact: &Contact, history: &mut ContactHistory, force: &mut ContactForce) {
        self.hysteresis.slide(history, force);
    }

    fn stored_energy(&self, contact: &Contact, history: &ContactHistory) -> StoredInContact {
        self.hysteresis.stored_energy(contact.overlap, history)
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
        let hysteresis = &self.hysteresis;
        (hysteresis.unloading_stiffness() + hysteresis.adhesion_stiffness()) * overlap
    }
}

impl RegisteredContactLaw for LinearHysteretic {
    const MEANING: &'static str =
        "hysteretic springs whose adhesion grows with the overlap (Luding 2008)";
    const KEYS: &'static [Key] = &{
        let [unloading, loading, plasticity, tangential] = HystereticParameters::KEYS;
        [unloading, loading, plasticity, tangential, ADHESION_STIFFNESS]
    };
    const ADHESION: Adhesion =
        Adhesion { keys: &[ADHESION_STIFFNESS.name], replaces_cohesion: false };

    fn from_keys(values: &dyn ContactLawValues) -> Option<Result<Self, InvalidContactLaw>> {
        let parameters = HystereticParameters::from_keys(values)?;
        Some(Self::new(parameters, values.number("adhesion_stiffness")?))
    }

    fn stiffened(&self, factor: f64) -> Self {
        let adhesion_stiffness = factor * self.hysteresis.adhesion_stiffness();
        Self { hysteresis: self.hysteresis.stiffened(factor, adhesion_stiffness) }
    }

    fn keeping_work(&self, _reduction: f64) -> Self {
        *self
    }

    fn coarse_grained(&self, parcels: &CoarseGraining) -> Self {
        self.stiffened(parcels.stiffness())
    }

    fn examples(scales: ExampleScales) -> Vec<Self> {
        let law = Self::new(HystereticParameters::example(scales), 0.7 * scales.stiffness);
        law.into_iter().collect()
    }
}
