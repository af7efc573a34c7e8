//! Elastic adhesive spheres (Johnson, Kendall & Roberts).
//!
//! References:
//! * K. L. Johnson, K. Kendall, A. D. Roberts, "Surface energy and the contact of elastic solids", Proc. R. Soc. Lond. A
//!   324 (1971) 301-313, <https://doi.org/10.1098/rspa.1971.0141>
//! * C. Thornton, Z. Ning, "A theoretical model for the stick/bounce behaviour of adhesive, elastic-plastic spheres",
//!   Powder Technol. 99 (1998) 154-162, <https://doi.org/10.1016/S0032-5910(98)00099-0>
//! * C. Thornton, "Interparticle sliding in the presence of adhesion", J. Phys. D: Appl. Phys. 24 (1991) 1942-1946,
//!   <https://doi.org/10.1088/0022-3727/24/11/007>

use super::parts::{
    ContactModuli, Elastic, ElasticParameters, Elasticity, SliderStep, loading_factor,
};
use super::{Adhesion, ContactLawValues, ExampleScales, RegisteredContactLaw};
use crate::contact::invalid_law::{InvalidContactLaw, require_in_range};
use crate::contact::{
    CoarseGraining, Contact, ContactForce, ContactForceLaw, ContactStep, ContactWork,
    StoredInContact,
};
use crate::numbers::power;
use crate::particles::ContactHistory;
use crate::rules::adhesion_factor;
use crate::schema::{Allowed, Key, Mixing};
use std::f64::consts::PI;

const SURFACE_ENERGY: Key = Key::number(
    "surface_energy",
    Allowed::POSITIVE,
    "Surface energy gamma of each body, half the work of adhesion: the pull-off force is F_c = 3 pi gamma R*",
)
.unit("energy/area").mixed(Mixing::Geometric);

/// Law of Johnson, Kendall and Roberts.
///
/// With a the radius of contact and gamma the surface energy of each sphere (half the work of adhesion w of equal
/// bodies: w = 2 gamma),
///
/// ```math
/// \delta = \frac{a^2}{R^*} - 2 \sqrt{\frac{\pi \gamma a}{E^*}}, \qquad F = \frac{4 E^* a^3}{3 R^*} - 4 \sqrt{\pi \gamma E^* a^3}
/// ```
///
/// or, on one curve for all spheres, with c^3 = 2 R* sqrt(pi gamma / E*) and a = c^2 s^2,
///
/// ```math
/// \delta = \frac{c^4}{R^*} (s^4 - s), \qquad F = 8 \pi \gamma R^* \left( \tfrac{2}{3} s^6 - s^3 \right)
/// ```
///
/// A contact forms at an overlap above 0, where it immediately pulls with 8/9 of the pull-off force F_c = 3 pi gamma R*
/// (s = 1). On separation a neck joins the spheres: the attraction is largest, F_c, at s^3 = 3/4, and the neck breaks
/// at the largest separation that it can span, s^3 = 1/4, where it pulls with 5/9 F_c.
///
/// Dashpots and tangential spring are those of [`HertzMindlin`](super::HertzMindlin) with this a; friction is at most
/// mu |F_n + 2 F_c| (Thornton 1991).
///
/// ```
/// # use talcum_engine as talcum;
/// use talcum::contact::{ContactForceLaw, ContactModuli, Jkr};
/// let law = Jkr::new(ContactModuli { normal: 1.0e7, shear: 2.0e6 }, 0.05, 0.9, 0.3)?;
/// assert!(law.contact_range(1.0e-5) < 1.0e-6);
/// assert!((law.pull_off_force(1.0e-5) - 3.0 * std::f64::consts::PI * 0.05 * 1.0e-5).abs() < 1.0e-20);
/// # Ok::<(), talcum::contact::InvalidContactLaw>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jkr {
    elastic: Elastic,
    surface_energy: f64,
    /// sqrt(pi gamma / E*).
    root: f64,
}

/// Value of s at which the neck breaks, s^3 = 1/4.
const BREAKING: f64 = 0.629_960_524_947_436_6;
/// The separation at that point, over c^4 / R*: 3/4 s.
const LARGEST_SEPARATION: f64 = 0.75 * BREAKING;
/// Newton steps: they converge quadratically, from at most 1.6 times the root, to the last digit.
const NEWTON_STEPS: usize = 6;

/// The larger s with s^4 - s = y, for y >= -3/4 2^(-2/3).
///
/// With s = s_0 + z, s_0^3 = 1/4, and t = y - y_0: z^2 (z^2 + 4 s_0 z + 6 s_0^2) = t, whose root is smooth in sqrt(t)
/// even where the neck breaks. z sqrt(z^2 + ...) is convex, so that Newton's steps from above do not overshoot.
#[inline(always)]
fn neck(y: f64) -> f64 {
    let (linear, constant) = (4.0 * BREAKING, 6.0 * BREAKING * BREAKING);
    let t = y + LARGEST_SEPARATION;
    let w = if t > 0.0 { t.sqrt() } else { 0.0 };
    let (of_small, of_large) = (w / constant.sqrt(), w.sqrt());
    let mut z = if of_small < of_large { of_small } else { of_large };
    for _ in 0..NEWTON_STEPS {
        let square = z * z + linear * z + constant;
        let root = square.sqrt();
        z -= (z * root - w) * root / (2.0 * z * z + 1.5 * linear * z + constant);
    }
    BREAKING + z
}

impl Jkr {
    /// Makes a law from the moduli of the contact, the surface energy gamma (energy per area), the restitution
    /// coefficient e and the friction coefficient mu.
    ///
    /// # Errors
    /// If a modulus or gamma is not positive, e not within (0, 1], or mu negative.
    pub fn new(
        moduli: ContactModuli,
        surface_energy: f64,
        restitution: f64,
        friction: f64,
    ) -> Result<Self, InvalidContactLaw> {
        require_in_range(&SURFACE_ENERGY, surface_energy)?;
        let elastic = Elastic::new(moduli, restitution, friction)?;
        Ok(Self::of(elastic, surface_energy))
    }

    fn of(elastic: Elastic, surface_energy: f64) -> Self {
        let root = (PI * surface_energy / elastic.moduli.normal).sqrt();
        Self { elastic, surface_energy, root }
    }

    /// Pull-off force F_c = 3 pi gamma R*.
    pub fn pull_off_force(&self, reduced_radius: f64) -> f64 {
        3.0 * PI * self.surface_energy * reduced_radius
    }

    /// Energy of a neck at s, relative to that at its break.
    fn neck_energy(&self, s: f64, scale: f64) -> f64 {
        let integral = |s: f64| {
            let (fourth, cube) = (s.powi(4), s.powi(3));
            fourth * (2.0 / 3.0 * cube - 0.25 - 4.0 / 15.0 * cube * cube)
        };
        -8.0 * PI * self.surface_energy * scale.powi(4) * (integral(s) - integral(BREAKING))
    }

    /// Length scale c of the contact radius.
    #[inline(always)]
    fn scale(&self, reduced_radius: f64) -> f64 {
        power(2.0 * reduced_radius * self.root, 1.0 / 3.0)
    }

    /// Scale of overlaps, c^4 / R* = 2 c sqrt(pi gamma / E*).
    #[inline(always)]
    fn overlap_scale(&self, scale: f64) -> f64 {
        2.0 * scale * self.root
    }
}

impl ContactForceLaw for Jkr {
    #[inline(always)]
    fn force(&self, contact: &Contact, history: &mut ContactHistory, dt: f64) -> ContactForce {
        let Contact { overlap, reduced_mass, reduced_radius, .. } = *contact;
        let separation_speed = contact.normal.dot(&contact.relative_velocity);
        let scale = self.scale(reduced_radius);
        let per_overlap = 1.0 / self.overlap_scale(scale);
        let s = neck(overlap * per_overlap);
        let before = neck((overlap + separation_speed * dt) * per_overlap);
        let radius = scale * scale * (s * s);
        let cube = s * s * s;
        let elastic =
            8.0 * PI * self.surface_energy * reduced_radius * (2.0 / 3.0 * cube - 1.0) * cube;
        let dashpot = self.elastic.dashpot(self.elastic.normal_stiffness(radius), reduced_mass);
        let normal = elastic - dashpot * separation_speed;
        let friction_normal = (normal + 6.0 * PI * self.surface_energy * reduced_radius).abs();
        let slider = self.elastic.slider(radius, friction_normal);
        let step = SliderStep {
            damping: self.elastic.dashpot(slider.stiffness, reduced_mass),
            loading_factor: loading_factor(before * before, s * s),
            dt,
        };
        let largest = history.largest_overlap;
        history.largest_overlap = if overlap > largest { overlap } else { largest };
        let tangential = slider.force(contact, history, step);
        ContactForce { normal, tangential, friction_normal }
    }

    /// The integral of F over delta from the break of the neck on, -8 pi gamma c^4 [G(s) - G(s_b)] with
    /// G = 2 s^7 / 3 - s^4 / 4 - 4 s^10 / 15, and (S_t / 2) s_t^2.
    fn stored_energy(&self, contact: &Contact, history: &ContactHistory) -> StoredInContact {
        let scale = self.scale(contact.reduced_radius);
        let s = neck(contact.overlap / self.overlap_scale(scale));
        let radius = scale * scale * (s * s);
        let normal = self.neck_energy(s, scale);
        StoredInContact { normal, tangential: self.elastic.tangential_energy(radius, history) }
    }

    /// In addition to dashpots and friction, the work of formation: a new contact has the energy of its neck at once,
    /// without work of the bodies.
    fn work(&self, step: &ContactStep<'_>) -> ContactWork {
        let scale = self.scale(step.contact.reduced_radius);
        let overlaps = [step.overlap_before(), step.contact.overlap];
        let radii = overlaps.map(|overlap| {
            let s = neck(overlap / self.overlap_scale(scale));
            scale * scale * (s * s)
        });
        let adhesion = if step.began { self.neck_energy(1.0, scale) } else { 0.0 };
        self.elastic.work(step, radii) + ContactWork { adhesion, ..ContactWork::default() }
    }

    /// The spheres are in contact if they overlap, or while a neck joins them that formed when they did.
    #[inline(always)]
    fn touches(&self, contact: &Contact, history: &ContactHistory) -> bool {
        let spanned = contact.overlap > -self.contact_range(contact.reduced_radius);
        contact.overlap > 0.0 || (history.largest_overlap > 0.0 && spanned)
    }

    #[inline(always)]
    fn contact_range(&self, reduced_radius: f64) -> f64 {
        LARGEST_SEPARATION * self.overlap_scale(self.scale(reduced_radius))
    }

    #[inline(always)]
    fn stiffness(&self, overlap: f64, reduced_radius: f64) -> f64 {
        let scale = self.scale(reduced_radius);
        let s = neck(overlap / self.overlap_scale(scale));
        self.elastic.normal_stiffness(scale * scale * (s * s))
    }

    fn contact_duration(&self, reduced_mass: f64, reduced_radius: f64) -> f64 {
        self.elastic.contact_duration(reduced_mass, reduced_radius)
    }

    fn largest_force(&self, overlap: f64, reduced_radius: f64) -> f64 {
        self.elastic.hertz_force(overlap, reduced_radius) + self.pull_off_force(reduced_radius)
    }
}

impl RegisteredContactLaw for Jkr {
    const MEANING: &'static str = "elastic spheres with surface energy";
    const KEYS: &'static [Key] = &{
        let [young_modulus, poisson_ratio] = Elasticity::KEYS;
        [young_modulus, poisson_ratio, SURFACE_ENERGY]
    };
    const ADHESION: Adhesion = Adhesion { keys: &[SURFACE_ENERGY.name], replaces_cohesion: true };

    fn from_keys(values: &dyn ContactLawValues) -> Option<Result<Self, InvalidContactLaw>> {
        let parameters = ElasticParameters::from_keys(values)?;
        let energy = values.number("surface_energy")?;
        Some(parameters.and_then(|of| Self::new(of.moduli, energy, of.restitution, of.friction)))
    }

    const OVERLAP_EXPONENT: f64 = 1.5;

    fn stiffened(&self, factor: f64) -> Self {
        Self::of(self.elastic.stiffened(factor), self.surface_energy)
    }

    fn keeping_work(&self, reduction: f64) -> Self {
        let factor = adhesion_factor(reduction, Self::OVERLAP_EXPONENT);
        Self::of(self.elastic, factor * self.surface_energy)
    }

    fn coarse_grained(&self, parcels: &CoarseGraining) -> Self {
        let elastic = self.elastic.stiffened(parcels.stress());
        Self::of(elastic, parcels.stiffness() * self.surface_energy)
    }

    fn examples(scales: ExampleScales) -> Vec<Self> {
        let surface_energy = 0.05 * scales.stiffness * scales.overlap;
        let moduli = ContactModuli::example(scales);
        Self::new(moduli, surface_energy, scales.restitution, 0.4).into_iter().collect()
    }
}
