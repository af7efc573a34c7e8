//! The section of contact: between particles, and at walls.

use super::allowed::Allowed;
use super::contact_laws::{ADHESION, read_law};
use super::particles::Scales;
use super::section::Section;
use super::stages::take_over;
use super::tree::{Node, Value};
use super::units::Units;
use crate::contact::{ContactModel, Elasticity, RollingFriction, RollingKind};
use serde::Deserialize;

/// What laws need from the rest of the file.
pub(super) struct Adhering {
    /// Whether `[cohesion]` is on.
    pub(super) cohesive: bool,
    pub(super) units: Option<Units>,
    pub(super) scales: Scales,
    /// g.
    pub(super) gravity: Option<f64>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Rolling {
    None,
    ConstantTorque,
    ElasticPlastic,
}

/// `[contact]`, `[contact.wall]` and what each wall says: the interface of particles, and those at the walls.
///
/// Walls take the keys of `[contact]`, changed by those of `[contact.wall]` and by their own; a change that names
/// a law stands for itself.
pub(super) fn read_contact(
    section: Section<'_>,
    walls: &[Option<&Node>],
    adhering: &Adhering,
) -> Option<(ContactModel, Vec<ContactModel>)> {
    let for_all = section.optional_section("wall").map(|wall| wall.node);
    let (particles, elasticity) = read_interface(&section, None, adhering);
    section.finish();
    let base = without_walls(section.node);
    let at_wall = |own: Option<&Node>| {
        let changes: Vec<&Node> = for_all.into_iter().chain(own).collect();
        require_adhesion(&section, &changes);
        let Some(node) = changes
            .iter()
            .fold(None, |node, change| Some(changed(node.as_ref().unwrap_or(&base), change)))
        else {
            return particles.clone();
        };
        let changed = Section::of(&node, section.problems)?;
        let (interface, _) = read_interface(&changed, elasticity, adhering);
        changed.finish();
        interface
    };
    if let (true, Some(change)) = (walls.is_empty(), for_all) {
        // What is said about walls must be right, also without any.
        at_wall(Some(change));
    }
    let at_walls: Vec<Option<ContactModel>> = walls.iter().map(|own| at_wall(*own)).collect();
    Some((particles?, at_walls.into_iter().collect::<Option<_>>()?))
}

/// The section without its sub-section on walls.
fn without_walls(contact: &Node) -> Node {
    let mut contact = contact.clone();
    if let Value::Table(entries) = &mut contact.value {
        entries.retain(|(key, _)| key != "wall");
    }
    contact
}

/// A section with the keys of a change in the place of its own; the change alone if it names a law.
fn changed(section: &Node, change: &Node) -> Node {
    let mut node = change.clone();
    if change.get("law").is_none()
        && let Value::Table(entries) = &mut node.value
    {
        let changes = std::mem::replace(entries, section.entries().to_vec());
        take_over(entries, changes);
    }
    node
}

/// Walls do not inherit the adhesion of particles unseen.
fn require_adhesion(contact: &Section<'_>, changes: &[&Node]) {
    let law = contact.node.get("law").and_then(Node::as_text).unwrap_or_default();
    let Some((_, keys)) = ADHESION.iter().find(|(name, _)| *name == law) else { return };
    if !keys.iter().any(|key| contact.node.get(key).is_some()) {
        return; // missed with the keys of particles
    }
    let says = |change: &&Node| ["law"].iter().chain(*keys).any(|key| change.get(key).is_some());
    if !changes.iter().any(says) {
        let keys: Vec<String> = keys.iter().map(|key| format!("contact.wall.{key}")).collect();
        let words =
            format!("missing: walls need an adhesion of their own: give {}", keys.join(" or "));
        contact.fail("wall", words);
    }
}

/// Law and rolling friction; also what the bodies of an elastic law are made of.
fn read_interface(
    section: &Section<'_>,
    particles: Option<Elasticity>,
    adhering: &Adhering,
) -> (Option<ContactModel>, Option<Elasticity>) {
    let (law, elasticity) = read_law(section, particles, adhering);
    let rolling = read_rolling(section);
    let interface = law.zip(rolling).map(|(law, rolling)| ContactModel { law, rolling });
    (interface, elasticity)
}

/// Rolling friction; `Some(None)`: none.
fn read_rolling(section: &Section<'_>) -> Option<Option<RollingFriction>> {
    let kind = match section.has("rolling") {
        true => section.value("rolling")?,
        false => Rolling::None,
    };
    let kind = match kind {
        Rolling::None => return Some(None),
        Rolling::ConstantTorque => Some(RollingKind::ConstantTorque),
        Rolling::ElasticPlastic => section
            .number("rolling_damping", Allowed::between(0.0, 1.0))
            .map(|damping| RollingKind::ElasticPlastic { damping }),
    };
    let coefficient = section.number("rolling_friction", Allowed::NOT_NEGATIVE);
    RollingFriction::new(kind?, coefficient?)
        .map_err(|error| section.fail(error.parameter, error.to_string()))
        .map(Some)
        .ok()
}
