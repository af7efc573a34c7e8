//! The contact laws, from their keys.

use super::context::ReadContext;
use super::forces::positive_gravity;
use super::section::Section;
use super::units::Units;
use crate::contact::{
    AdhesiveElasticPlastic, ContactLaw, ContactModuli, Elasticity, FrictionCap, HertzMindlin,
    HystereticParameters, InvalidContactLaw, Jkr, LinearHysteretic, LinearSpringDashpot,
};
use crate::rules::attraction_of_bond_number;

/// What laws with adhesion need from the rest of the file.
pub(super) struct AdhesionContext<'a> {
    /// Whether `[cohesion]` is on.
    pub(super) cohesive: bool,
    pub(super) read: ReadContext<'a>,
}

/// A law, and for an elastic one what the body is made of.
#[derive(Default)]
pub(super) struct LawAndBody {
    pub(super) law: Option<ContactLaw>,
    pub(super) body: Option<Elasticity>,
}

/// The keys that say how much adhesion a law brings; none if it brings none.
pub(super) fn adhesion_keys(law: &str) -> &'static [&'static str] {
    match law {
        "adhesive_elastic_plastic" => &["adhesion", "bond_number"],
        "jkr" => &["surface_energy"],
        "linear_hysteretic" => &["adhesion_stiffness"],
        _ => &[],
    }
}

/// The law of a section; the other body is of `particles`' elasticity, or of the same.
pub(super) fn read_law(
    section: &Section<'_>,
    particles: Option<Elasticity>,
    adhesion: &AdhesionContext<'_>,
) -> LawAndBody {
    let law = section.word("law").unwrap_or_default();
    if matches!(law, "adhesive_elastic_plastic" | "jkr") && adhesion.cohesive {
        section.fail("law", "brings its own adhesion: it cannot stand beside [cohesion]");
    }
    let alone = |law| LawAndBody { law, body: None };
    match law {
        "linear_spring_dashpot" => alone(read_linear_spring_dashpot(section, adhesion.cohesive)),
        "adhesive_elastic_plastic" => alone(read_adhesive_elastic_plastic(section, adhesion.read)),
        "linear_hysteretic" => alone(read_linear_hysteretic(section)),
        "hertz_mindlin" => read_elastic(section, particles, |moduli, e, mu| {
            Some(HertzMindlin::new(moduli, e, mu).map(ContactLaw::HertzMindlin))
        }),
        "jkr" => read_elastic(section, particles, |moduli, e, mu| {
            let energy = section.number("surface_energy")?;
            Some(Jkr::new(moduli, energy, e, mu).map(ContactLaw::Jkr))
        }),
        _ => LawAndBody::default(),
    }
}

/// A law, or its error at the key that it is about.
fn checked<T>(section: &Section<'_>, law: Result<T, InvalidContactLaw>) -> Option<T> {
    law.map_err(|error| section.fail(error.parameter, error.to_string())).ok()
}

fn read_linear_spring_dashpot(section: &Section<'_>, cohesive: bool) -> Option<ContactLaw> {
    match cohesive {
        true => section.require("friction_cap"),
        false => section.note_default("friction_cap"),
    }
    let normal = section.number("normal_stiffness")?;
    let tangential = match section.given(&["tangential_stiffness", "poisson_ratio"])? {
        "poisson_ratio" => {
            let ratio = section.number("poisson_ratio")?;
            LinearSpringDashpot::tangential_stiffness_of(normal, ratio)
        }
        key => section.number(key)?,
    };
    let cap = section
        .choice("friction_cap", &[("contact", FrictionCap::Contact), ("net", FrictionCap::Net)])?;
    let (restitution, friction) = (section.number("restitution")?, section.number("friction")?);
    let law = LinearSpringDashpot::new(normal, tangential, restitution, friction, cap);
    checked(section, law).map(ContactLaw::LinearSpringDashpot)
}

/// Stiffnesses, restitution and friction of a hysteretic law.
fn read_hysteretic(section: &Section<'_>) -> Option<HystereticParameters> {
    let unloading = section.number("unloading_stiffness")?;
    let loading = match section.given(&["loading_stiffness", "plasticity_index"])? {
        "plasticity_index" => (1.0 - section.number("plasticity_index")?) * unloading,
        key => section.number(key)?,
    };
    if loading > unloading {
        section
            .fail("loading_stiffness", format!("must be at most unloading_stiffness, {unloading}"));
    }
    let tangential = match section.has("tangential_stiffness") {
        true => section.number("tangential_stiffness")?,
        false => 2.0 / 7.0 * loading,
    };
    Some(HystereticParameters {
        loading_stiffness: loading,
        unloading_stiffness: unloading,
        tangential_stiffness: tangential,
        restitution: section.number("restitution")?,
        friction: section.number("friction")?,
    })
}

fn read_linear_hysteretic(section: &Section<'_>) -> Option<ContactLaw> {
    let law =
        LinearHysteretic::new(read_hysteretic(section)?, section.number("adhesion_stiffness")?);
    checked(section, law).map(ContactLaw::LinearHysteretic)
}

/// F0 = Bo m g at the reference diameter.
fn read_adhesive_elastic_plastic(
    section: &Section<'_>,
    context: ReadContext<'_>,
) -> Option<ContactLaw> {
    /// Diameter of the primary particles of Liu et al., m.
    const PRIMARY_DIAMETER: f64 = 20.0e-9;
    let parameters = read_hysteretic(section);
    let key = section.given(&["adhesion", "bond_number"]);
    let given = key.and_then(|key| section.number(key));
    let adhesion = match key {
        Some("bond_number") if given != Some(0.0) => {
            let gravity = positive_gravity(section, "bond_number", "adhesion", context.gravity);
            let mass = context.scales.mass();
            let weight = mass.zip(gravity);
            given.zip(weight).map(|(bond, (mass, g))| attraction_of_bond_number(bond, mass, g))
        }
        _ => given,
    };
    let has_default = context.units == Some(Units::Si);
    match has_default {
        true => section.note_default("primary_diameter"),
        false => section.require("primary_diameter"),
    }
    let primary = match section.has("primary_diameter") {
        true => section.number("primary_diameter"),
        false => has_default.then_some(PRIMARY_DIAMETER),
    };
    let law = AdhesiveElasticPlastic::new(parameters?, adhesion?, primary?);
    checked(section, law).map(ContactLaw::AdhesiveElasticPlastic)
}

/// Modulus, Poisson's ratio, restitution and friction of an elastic law.
fn read_elastic(
    section: &Section<'_>,
    particles: Option<Elasticity>,
    law: impl FnOnce(ContactModuli, f64, f64) -> Option<Result<ContactLaw, InvalidContactLaw>>,
) -> LawAndBody {
    let moduli = section.number("young_modulus").zip(section.number("poisson_ratio"));
    let Some((young_modulus, poisson_ratio)) = moduli else { return LawAndBody::default() };
    let body = Elasticity { young_modulus, poisson_ratio };
    let read = || {
        let (restitution, friction) = (section.number("restitution")?, section.number("friction")?);
        let moduli = checked(section, ContactModuli::between(particles.unwrap_or(body), body))?;
        checked(section, law(moduli, restitution, friction)?)
    };
    LawAndBody { law: read(), body: Some(body) }
}
