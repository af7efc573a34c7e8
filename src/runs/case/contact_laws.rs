//! The contact laws, from their keys.

use super::context::ReadContext;
use super::forces::positive_gravity;
use super::units::Units;
use crate::input::Section;
use talcum_engine::contact::{ContactLaw, ContactLawValues, Elasticity};
use talcum_engine::rules::attraction_of_bond_number;
use talcum_engine::schema::KeyValues;

/// Data from the rest of the file for laws with adhesion.
pub(super) struct AdhesionContext<'a> {
    /// Whether `[cohesion]` is on.
    pub(super) cohesive: bool,
    pub(super) read: ReadContext<'a>,
}

/// The interface through which a law reads its keys.
struct LawSection<'a> {
    section: &'a Section<'a>,
    other_body: Option<Elasticity>,
    adhesion: &'a AdhesionContext<'a>,
}

/// The law of a section; the other body has this elasticity, or the same one.
pub(super) fn read_law(
    section: &Section<'_>,
    other_body: Option<Elasticity>,
    adhesion: &AdhesionContext<'_>,
) -> Option<ContactLaw> {
    let name = section.word("law").unwrap_or_default();
    let own = ContactLaw::adhesion_of(name);
    if adhesion.cohesive && own.is_some_and(|own| own.replaces_cohesion) {
        section.fail("law", "brings its own adhesion: it cannot stand beside [cohesion]");
    }
    let values = LawSection { section, other_body, adhesion };
    ContactLaw::from_keys(name, &values)
        .and_then(|law| law.map_err(|error| section.fail(error.parameter, error.to_string())).ok())
}

impl KeyValues for LawSection<'_> {
    fn number(&self, key: &str) -> Option<f64> {
        self.section.number(key)
    }

    fn word(&self, key: &str) -> Option<&str> {
        self.section.word(key)
    }

    fn is_given(&self, key: &str) -> bool {
        self.section.has(key)
    }
}

impl ContactLawValues for LawSection<'_> {
    fn require(&self, key: &'static str) {
        self.section.require(key);
    }

    fn note_default(&self, key: &'static str) {
        self.section.note_default(key);
    }

    fn fail(&self, key: &'static str, message: String) {
        self.section.fail(key, message);
    }

    fn is_cohesive(&self) -> bool {
        self.adhesion.cohesive
    }

    fn is_si(&self) -> bool {
        self.adhesion.read.units == Some(Units::Si)
    }

    fn other_body(&self) -> Option<Elasticity> {
        self.other_body
    }

    fn attraction_of_bond_number(
        &self,
        bond_number: f64,
        key: &'static str,
        instead: &'static str,
    ) -> Option<f64> {
        let context = self.adhesion.read;
        let gravity = positive_gravity(self.section, key, instead, context.gravity);
        let (mass, gravity) = context.scales.mass().zip(gravity)?;
        Some(attraction_of_bond_number(bond_number, mass, gravity))
    }
}
