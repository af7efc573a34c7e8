//! The keys of each contact law.

use super::allowed::Allowed;
use super::contact::Adhering;
use super::forces::positive_gravity;
use super::particles::sphere_mass;
use super::section::Section;
use super::units::Units;
use crate::contact::{
    AdhesiveElasticPlastic, ContactLaw, ContactModuli, Elasticity, FrictionCap, HertzMindlin,
    HystereticParameters, InvalidContactLaw, Jkr, LinearHysteretic, LinearSpringDashpot,
};
use crate::rules::attraction_of_bond_number;
use serde::Deserialize;

/// Laws that bring an adhesion, and the keys that say how much.
pub(super) const ADHESION: [(&str, &[&str]); 3] = [
    ("adhesive_elastic_plastic", &["adhesion", "bond_number"]),
    ("jkr", &["surface_energy"]),
    ("linear_hysteretic", &["adhesion_stiffness"]),
];

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Law {
    LinearSpringDashpot,
    AdhesiveElasticPlastic,
    LinearHysteretic,
    HertzMindlin,
    Jkr,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Cap {
    Contact,
    Net,
}

/// The law of a section, and for an elastic one what the body is made of; the other body is of `particles`' kind,
/// or of the same.
pub(super) fn read_law(
    section: &Section<'_>,
    particles: Option<Elasticity>,
    adhering: &Adhering,
) -> (Option<ContactLaw>, Option<Elasticity>) {
    let law: Option<Law> = section.value("law");
    if let (Some(Law::AdhesiveElasticPlastic | Law::Jkr), true) = (law, adhering.cohesive) {
        section.fail("law", "brings its own adhesion: it cannot stand beside [cohesion]");
    }
    match law {
        // Without a known law the keys are checked all the same: all errors at once.
        Some(Law::LinearSpringDashpot) | None => {
            let model = read_linear_spring_dashpot(section, adhering.cohesive);
            (model.filter(|_| law.is_some()), None)
        }
        Some(Law::AdhesiveElasticPlastic) => {
            (read_adhesive_elastic_plastic(section, adhering), None)
        }
        Some(Law::LinearHysteretic) => (read_linear_hysteretic(section), None),
        Some(Law::HertzMindlin) => read_elastic(section, particles, |moduli, e, mu| {
            HertzMindlin::new(moduli, e, mu).map(ContactLaw::HertzMindlin)
        }),
        Some(Law::Jkr) => {
            let energy = section.number("surface_energy", Allowed::POSITIVE);
            let (model, elasticity) = read_elastic(section, particles, |moduli, e, mu| {
                // 1 stands for what is missing, which has been reported.
                Jkr::new(moduli, energy.unwrap_or(1.0), e, mu).map(ContactLaw::Jkr)
            });
            (model.filter(|_| energy.is_some()), elasticity)
        }
    }
}

/// A law, or its error at the key that it is about.
fn checked<T>(section: &Section<'_>, law: Result<T, InvalidContactLaw>) -> Option<T> {
    law.map_err(|error| section.fail(error.parameter, error.to_string())).ok()
}

fn read_linear_spring_dashpot(section: &Section<'_>, cohesive: bool) -> Option<ContactLaw> {
    let normal = section.number("normal_stiffness", Allowed::POSITIVE);
    let tangential = match section.exactly_one(&["tangential_stiffness", "poisson_ratio"]) {
        Some("poisson_ratio") => section
            .optional_number("poisson_ratio", Allowed::between(0.0, 0.5))
            .zip(normal)
            .map(|(ratio, normal)| LinearSpringDashpot::tangential_stiffness_of(normal, ratio)),
        Some(key) => section.optional_number(key, Allowed::NOT_NEGATIVE),
        None => None,
    };
    let restitution = section.number("restitution", Allowed::FRACTION);
    let friction = section.number("friction", Allowed::NOT_NEGATIVE);
    let cap = match section.has("friction_cap") || cohesive {
        true => section.value("friction_cap"),
        false => {
            section
                .note_default("friction_cap", "\"contact\", without cohesion the same as \"net\"");
            Some(Cap::Contact)
        }
    };
    let cap = cap.map(|cap| match cap {
        Cap::Contact => FrictionCap::Contact,
        Cap::Net => FrictionCap::Net,
    });
    let law = LinearSpringDashpot::new(normal?, tangential?, restitution?, friction?, cap?);
    checked(section, law).map(ContactLaw::LinearSpringDashpot)
}

/// Stiffnesses, restitution and friction of a hysteretic law.
fn read_hysteretic(section: &Section<'_>) -> Option<HystereticParameters> {
    let unloading = section.number("unloading_stiffness", Allowed::POSITIVE);
    let loading = match section.exactly_one(&["loading_stiffness", "plasticity_index"]) {
        Some("plasticity_index") => section
            .optional_number("plasticity_index", Allowed::from_to_below(0.0, 1.0))
            .zip(unloading)
            .map(|(index, unloading)| (1.0 - index) * unloading),
        Some(key) => section.optional_number(key, Allowed::POSITIVE),
        None => None,
    };
    if let (Some(loading), Some(unloading)) = (loading, unloading)
        && loading > unloading
    {
        section
            .fail("loading_stiffness", format!("must be at most unloading_stiffness, {unloading}"));
    }
    let tangential = match section.has("tangential_stiffness") {
        true => section.number("tangential_stiffness", Allowed::NOT_NEGATIVE),
        false => {
            section.note_default("tangential_stiffness", "2/7 of the loading stiffness");
            loading.map(|loading| 2.0 / 7.0 * loading)
        }
    };
    let restitution = section.number("restitution", Allowed::FRACTION);
    let friction = section.number("friction", Allowed::NOT_NEGATIVE);
    Some(HystereticParameters {
        loading_stiffness: loading?,
        unloading_stiffness: unloading?,
        tangential_stiffness: tangential?,
        restitution: restitution?,
        friction: friction?,
    })
}

fn read_linear_hysteretic(section: &Section<'_>) -> Option<ContactLaw> {
    let parameters = read_hysteretic(section);
    let adhesion = section.number("adhesion_stiffness", Allowed::NOT_NEGATIVE);
    let law = LinearHysteretic::new(parameters?, adhesion?);
    checked(section, law).map(ContactLaw::LinearHysteretic)
}

/// F0 = Bo m g at the reference diameter.
fn read_adhesive_elastic_plastic(section: &Section<'_>, adhering: &Adhering) -> Option<ContactLaw> {
    /// Diameter of the primary particles of Liu et al., m.
    const PRIMARY_DIAMETER: f64 = 20.0e-9;
    let parameters = read_hysteretic(section);
    let key = section.exactly_one(&["adhesion", "bond_number"]);
    let given = key.and_then(|key| section.optional_number(key, Allowed::NOT_NEGATIVE));
    let adhesion = match key {
        Some("bond_number") if given != Some(0.0) => {
            let gravity = positive_gravity(section, "bond_number", "adhesion", adhering.gravity);
            let (density, diameter) = (adhering.scales.density, adhering.scales.diameter);
            let mass =
                density.zip(diameter).map(|(density, diameter)| sphere_mass(density, diameter));
            given
                .zip(gravity)
                .zip(mass)
                .map(|((bond, gravity), mass)| attraction_of_bond_number(bond, mass, gravity))
        }
        _ => given,
    };
    let is_si = adhering.units == Some(Units::Si);
    let primary = match section.has("primary_diameter") || !is_si {
        true => section.number("primary_diameter", Allowed::NOT_NEGATIVE),
        false => {
            section.note_default("primary_diameter", "20 nm");
            Some(PRIMARY_DIAMETER)
        }
    };
    let law = AdhesiveElasticPlastic::new(parameters?, adhesion?, primary?);
    checked(section, law).map(ContactLaw::AdhesiveElasticPlastic)
}

/// Modulus, Poisson's ratio, restitution and friction of an elastic law.
fn read_elastic(
    section: &Section<'_>,
    particles: Option<Elasticity>,
    law: impl FnOnce(ContactModuli, f64, f64) -> Result<ContactLaw, InvalidContactLaw>,
) -> (Option<ContactLaw>, Option<Elasticity>) {
    let young_modulus = section.number("young_modulus", Allowed::POSITIVE);
    let poisson_ratio = section.number("poisson_ratio", Allowed::between(0.0, 0.5));
    let restitution = section.number("restitution", Allowed::FRACTION);
    let friction = section.number("friction", Allowed::NOT_NEGATIVE);
    let body = young_modulus
        .zip(poisson_ratio)
        .map(|(young_modulus, poisson_ratio)| Elasticity { young_modulus, poisson_ratio });
    let model = body.zip(restitution).zip(friction).and_then(|((body, restitution), friction)| {
        let moduli = checked(section, ContactModuli::between(particles.unwrap_or(body), body))?;
        checked(section, law(moduli, restitution, friction))
    });
    (model, body)
}
