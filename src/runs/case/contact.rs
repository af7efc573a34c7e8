//! The section on contacts: between particles, and at walls.

use super::contact_laws::{AdhesionContext, read_law};
use super::merging::merge;
use super::schema::AT_WALL;
use super::species::{SharedSection, SpeciesSections};
use crate::input::{Node, Problems, Section, Value};
use talcum_engine::contact::{
    ByPair, BySpecies, ContactLaw, ContactModel, Elasticity, RollingFriction, RollingKind,
    Softening, TwistingFriction,
};

/// The contacts of a stage.
pub(super) struct Contacts {
    pub(super) particles: ByPair<ContactModel>,
    /// Contacts at walls, by the numbers of the walls.
    pub(super) at_walls: Vec<BySpecies<ContactModel>>,
}

/// Reads `[contact]`, `[contact.wall]`, and the keys of each species, each pair and each wall.
///
/// Walls inherit the keys of `[contact]`, changed by those of the species, of `[contact.wall]`, of the species at
/// walls, and by their own; a change that names a law inherits nothing.
pub(super) fn read_contact(
    section: &Section<'_>,
    walls: &[Option<&Node>],
    species: &SpeciesSections<'_>,
    adhesion: &AdhesionContext<'_>,
) -> Option<Contacts> {
    let base = without_walls(section.node);
    let shared = SharedSection { name: "contact", keys: AT_WALL, base: &base };
    let sections = species.section_of_each(shared);
    let body = |node: &Node| {
        Section::open(node, AT_WALL, section.problems)
            .and_then(|section| Elasticity::from_keys(&section))
    };
    let bodies: Vec<Option<Elasticity>> = sections.iter().map(body).collect();
    let particles = species.read_pairs(section, shared, |of_pair, [one, other]| {
        read_model(of_pair, bodies[other].filter(|_| one != other), adhesion)
    });
    let for_all = section.node.get("wall").filter(|wall| matches!(wall.value, Value::Table(_)));
    let at_wall = |number: usize, own: Option<&Node>| {
        let of_species = species.at_walls(number);
        let changes: Vec<&Node> = for_all.into_iter().chain(of_species).chain(own).collect();
        require_adhesion(section, &changes);
        let side = ParticleSide { particles: &sections[number], body: bodies[number] };
        read_at_wall(side, &changes, section.problems, adhesion)
    };
    let at_walls = |own: Option<&Node>| species.for_each(|number| at_wall(number, own));
    if let (true, Some(_)) = (walls.is_empty(), for_all) {
        // The keys for walls must be correct even if there are no walls.
        at_walls(None);
    }
    let at_walls: Vec<Option<_>> = walls.iter().map(|own| at_walls(*own)).collect();
    let at_walls = at_walls.into_iter().collect::<Option<_>>()?;
    Some(Contacts { particles: particles?, at_walls })
}

/// The particles that touch a wall: the section of their contacts, and their material.
struct ParticleSide<'a> {
    particles: &'a Node,
    body: Option<Elasticity>,
}

/// The model at a wall, if the section of the particles is changed there; otherwise the model of the particles.
fn read_at_wall(
    ParticleSide { particles, body }: ParticleSide<'_>,
    changes: &[&Node],
    problems: &Problems,
    adhesion: &AdhesionContext<'_>,
) -> Option<ContactModel> {
    let change = |node: Option<Node>, change: &&Node| {
        Some(changed(node.as_ref().unwrap_or(particles), change))
    };
    let node = changes.iter().fold(None, change);
    let section = Section::open(node.as_ref().unwrap_or(particles), AT_WALL, problems)?;
    read_model(&section, body.filter(|_| node.is_some()), adhesion)
}

/// The section without its subsection on walls.
fn without_walls(contact: &Node) -> Node {
    let mut contact = contact.clone();
    if let Value::Table(entries) = &mut contact.value {
        entries.retain(|(key, _)| key != "wall");
    }
    contact
}

/// A section with its own keys replaced by those of a change; only the change if it names a law.
fn changed(section: &Node, change: &Node) -> Node {
    let mut node = change.clone();
    if change.get("law").is_none()
        && let Value::Table(entries) = &mut node.value
    {
        let changes = std::mem::replace(entries, section.entries().to_vec());
        merge(entries, changes, AT_WALL);
    }
    node
}

/// Walls do not inherit the adhesion of particles unless the case says so.
fn require_adhesion(contact: &Section<'_>, changes: &[&Node]) {
    let law = contact.word("law").unwrap_or_default();
    let keys = ContactLaw::adhesion_of(law).map_or(&[][..], |adhesion| adhesion.keys);
    if !keys.iter().any(|key| contact.has(key)) {
        return; // the law has none, or it is missed with the keys of particles
    }
    let says = |change: &&Node| ["law"].iter().chain(keys).any(|key| change.get(key).is_some());
    if !changes.iter().any(says) {
        let keys: Vec<String> = keys.iter().map(|key| format!("contact.wall.{key}")).collect();
        let keys = keys.join(" or ");
        let message = format!("missing: walls need an adhesion of their own: give {keys}");
        contact.fail("wall", message);
    }
}

/// Law and rolling friction; the other body has the elasticity `other`, or the same one.
fn read_model(
    section: &Section<'_>,
    other: Option<Elasticity>,
    adhesion: &AdhesionContext<'_>,
) -> Option<ContactModel> {
    let law = read_law(section, other, adhesion);
    let (rolling, twisting) = (read_rolling(section), read_twisting(section));
    let softening = read_softening(section);
    let (law, rolling, twisting, softening) = (law?, rolling?, twisting?, softening?);
    let law = match softening {
        Some(Softening { reduction, keeps_work: true }) => law.keeping_work(reduction),
        _ => law,
    };
    Some(ContactModel { law, rolling, twisting, softening })
}

/// Twisting friction; `Some(None)` if there is none.
fn read_twisting(section: &Section<'_>) -> Option<Option<TwistingFriction>> {
    if section.word("twisting")? == "none" {
        return Some(None);
    }
    let number = |key| section.number(key);
    let (friction, stiffness) = (number("twisting_friction")?, number("twisting_stiffness")?);
    TwistingFriction::new(friction, stiffness, number("twisting_damping")?)
        .map_err(|error| section.fail(error.parameter, error.to_string()))
        .map(Some)
        .ok()
}

/// Softening relative to stiffer, real particles; `Some(None)` if there is none.
fn read_softening(section: &Section<'_>) -> Option<Option<Softening>> {
    let keeps_work = match section.word("softening")? {
        "keeps_force" => false,
        "keeps_work" => true,
        _ => return Some(None),
    };
    Some(Some(Softening { reduction: section.number("stiffness_reduction")?, keeps_work }))
}

/// Rolling friction; `Some(None)` if there is none, or its coefficient is 0.
fn read_rolling(section: &Section<'_>) -> Option<Option<RollingFriction>> {
    let kind = match section.word("rolling")? {
        "constant_torque" => RollingKind::ConstantTorque,
        "elastic_plastic" => {
            RollingKind::ElasticPlastic { damping: section.number("rolling_damping")? }
        }
        _ => return Some(None),
    };
    RollingFriction::new(kind, section.number("rolling_friction")?)
        .map_err(|error| section.fail(error.parameter, error.to_string()))
        .map(|rolling| Some(rolling).filter(RollingFriction::resists))
        .ok()
}
