//! The section of contact: between particles, and at walls.

use super::contact_laws::{AdhesionContext, LawAndBody, read_law};
use super::merging::merge;
use super::schema::AT_WALL;
use super::section::Section;
use super::tree::{Node, Value};
use crate::contact::{
    ContactLaw, ContactModel, Elasticity, RollingFriction, RollingKind, Softening, TwistingFriction,
};

/// The contacts of a stage.
pub(super) struct Contacts {
    pub(super) particles: ContactModel,
    /// By the numbers of the walls.
    pub(super) at_walls: Vec<ContactModel>,
}

/// A contact model, and for an elastic law what the body is made of.
struct ModelAndBody {
    model: Option<ContactModel>,
    body: Option<Elasticity>,
}

/// `[contact]`, `[contact.wall]` and what each wall says.
///
/// Walls take the keys of `[contact]`, changed by those of `[contact.wall]` and by their own; a change that names
/// a law stands for itself.
pub(super) fn read_contact(
    section: &Section<'_>,
    walls: &[Option<&Node>],
    adhesion: &AdhesionContext<'_>,
) -> Option<Contacts> {
    let for_all = section.node.get("wall").filter(|wall| matches!(wall.value, Value::Table(_)));
    let particles = read_model(section, None, adhesion);
    let base = without_walls(section.node);
    let at_wall = |own: Option<&Node>| {
        let changes: Vec<&Node> = for_all.into_iter().chain(own).collect();
        require_adhesion(section, &changes);
        let Some(node) = changes
            .iter()
            .fold(None, |node, change| Some(changed(node.as_ref().unwrap_or(&base), change)))
        else {
            return particles.model.clone();
        };
        let changed = Section::open(&node, AT_WALL, section.problems)?;
        read_model(&changed, particles.body, adhesion).model
    };
    if let (true, Some(change)) = (walls.is_empty(), for_all) {
        // What is said about walls must be right, also without any.
        at_wall(Some(change));
    }
    let at_walls: Vec<Option<ContactModel>> = walls.iter().map(|own| at_wall(*own)).collect();
    let at_walls = at_walls.into_iter().collect::<Option<_>>()?;
    Some(Contacts { particles: particles.model?, at_walls })
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

/// Law and rolling friction; the other body is of `particles`' elasticity, or of the same.
fn read_model(
    section: &Section<'_>,
    particles: Option<Elasticity>,
    adhesion: &AdhesionContext<'_>,
) -> ModelAndBody {
    let LawAndBody { law, body } = read_law(section, particles, adhesion);
    let (rolling, twisting) = (read_rolling(section), read_twisting(section));
    let spin = rolling.zip(twisting);
    let model = law.zip(spin).zip(read_softening(section)).map(|((law, spin), softening)| {
        let (rolling, twisting) = spin;
        let law = match softening {
            Some(Softening { reduction, keeps_work: true }) => law.keeping_work(reduction),
            _ => law,
        };
        ContactModel { law, rolling, twisting, softening }
    });
    ModelAndBody { model, body }
}

/// Twisting friction; `Some(None)`: none.
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

/// What is stated of stiffer, real particles; `Some(None)`: nothing.
fn read_softening(section: &Section<'_>) -> Option<Option<Softening>> {
    let keeps_work = match section.word("softening")? {
        "keeps_force" => false,
        "keeps_work" => true,
        _ => return Some(None),
    };
    Some(Some(Softening { reduction: section.number("stiffness_reduction")?, keeps_work }))
}

/// Rolling friction; `Some(None)`: none.
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
        .map(Some)
        .ok()
}
