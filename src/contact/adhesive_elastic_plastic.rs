//! Adhesive elastic-plastic contact of porous agglomerates: Liu, van Wachem, Mudde, Chen & van Ommen, AIChE J. 62
//! (2016) 2259 and Powder Technol. (2016).

use super::hysteresis::{Hysteresis, HystereticParameters};
use super::linear_spring_dashpot::require;
use super::{Contact, ContactForce, ContactForceLaw, InvalidContactLaw};
use crate::particles::ContactHistory;

/// A hysteretic spring shifted by a constant attraction F0, which acts while the spheres overlap:
///
/// ```text
/// first loading       F = k_load delta - F0
/// un- and reloading   F = k_unload (delta - delta_p) - F0,   delta_p = psi_p delta_max
/// but not below       f_ad = -(delta_p / d_NP + 1) F0
/// ```
///
/// where delta_max is the largest overlap since the contact began, psi_p = 1 - k_load / k_unload the plasticity
/// index and d_NP the diameter of the primary particles that the contact is flattened over. On parting from f_ad
/// the force goes along a straight line to -F0 at delta = 0. That line is one and the same for every delta_max,
///
/// ```text
/// F = -F0 - k_c delta,   k_c = F0 / (d_NP - F0 / k_unload),
/// ```
///
/// so a contact is on the higher of unloading line and this one. A contact that is pressed again from it climbs
/// the unloading line through the present point: delta_max is lowered to suit. With d_NP <= F0 / k_unload the line
/// is never reached, and the force falls along the unloading line until the spheres part. Without F0 nothing pulls.
///
/// F0 is the same for all sizes: it is the force of the primary particles that meet. F_n = F - eta_n v_n with
/// eta_n = 2 sqrt(m* k_load) |ln e| / sqrt(pi^2 + ln^2 e). F_t = -k_t s - eta_t v_t, eta_t of the same form in k_t
/// and (2/7) m*, at most mu_f |F_n + F0|: a contact held by adhesion alone still resists sliding.
///
/// ```
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
/// let mut memory = ContactHistory::default();
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
///     law.force(&at_rest, &mut memory, 0.0).normal
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
}

impl AdhesiveElasticPlastic {
    /// With F0 (force) and d_NP (length; 0: no limit of adhesion).
    ///
    /// # Errors
    /// If a parameter is out of its range, F0 or d_NP negative.
    pub fn new(
        parameters: HystereticParameters,
        attraction: f64,
        primary_diameter: f64,
    ) -> Result<Self, InvalidContactLaw> {
        require(attraction >= 0.0, "adhesion", attraction, "zero or positive")?;
        let d = primary_diameter;
        require(d >= 0.0, "primary_diameter", d, "zero or positive")?;
        let room = d - attraction / parameters.unloading_stiffness;
        let adhesion_stiffness = if attraction == 0.0 {
            0.0
        } else if room > 0.0 {
            attraction / room
        } else {
            f64::INFINITY
        };
        let hysteresis = Hysteresis::new(&parameters, adhesion_stiffness)?;
        Ok(Self { hysteresis, attraction })
    }

    /// F0.
    pub fn attraction(&self) -> f64 {
        self.attraction
    }

    /// k_c, infinite if the limit of adhesion is never reached.
    pub fn adhesion_stiffness(&self) -> f64 {
        self.hysteresis.adhesion_stiffness()
    }
}

impl ContactForceLaw for AdhesiveElasticPlastic {
    #[inline(always)]
    fn force(&self, contact: &Contact, history: &mut ContactHistory, dt: f64) -> ContactForce {
        self.hysteresis.force(contact, history, dt, (self.attraction, self.attraction))
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
