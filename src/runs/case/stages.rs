//! The stages of a run: the base of the file, changed by one stage after another.

use super::contact::read_contact;
use super::contact_laws::AdhesionContext;
use super::context::{ReadContext, require_a_step};
use super::forces::{read_cohesion, read_gravity, read_vibration, softened};
use super::gas::read_gas;
use super::merging::StageSection;
use super::schema::COHESION;
use super::species::SharedSection;
use super::stage::Stage;
use super::walls::contacts_of;
use crate::input::Section;
use std::ops::Range;
use talcum_engine::contact::{ByPair, ContactModel, Exchanges, VanDerWaals};
use talcum_engine::domain::EffectiveGravity;
use talcum_engine::gas::GasModel;
use talcum_engine::state::Physics;

/// Stages, as far as they are determined by their own keys.
struct Timetable {
    names: Vec<Option<String>>,
    times: Vec<Range<f64>>,
}

/// Reads `[time]`, `[[stage]]` and the sections of the models that act on particles. Also returns the time step.
pub(super) fn read_stages(
    root: &Section<'_>,
    context: ReadContext<'_>,
) -> (Option<Vec<Stage>>, Option<f64>) {
    let members = root.tables("stage");
    let (step, end) = read_time(root);
    let Timetable { names, times } = if root.has("stage") {
        timetable(&members, step)
    } else {
        Timetable {
            names: vec![Some("run".to_owned())],
            times: std::iter::once(0.0..end.unwrap_or(1.0)).collect(),
        }
    };
    let mut sections = StageSection::all();
    sections.iter_mut().for_each(|section| section.change(root, 0));
    if times.is_empty() {
        return (None, step);
    }
    let context = ReadContext { times: &times, ..context };
    let mut stages = Vec::new();
    for (index, (name, time)) in names.iter().zip(&times).enumerate() {
        if let Some(member) = members.get(index) {
            sections.iter_mut().for_each(|section| section.change(member, index));
        }
        let physics = read_physics(&sections, root, context, step);
        StageSection::mark(&mut sections);
        stages.push(physics.and_then(|physics| {
            let Range { start, end } = time.clone();
            Some(Stage { name: name.clone()?, start, end, physics })
        }));
    }
    // A section that no stage switches on must also be correct.
    if StageSection::switch_on_unused(&mut sections) {
        read_physics(&sections, root, context, step);
    }
    (stages.into_iter().collect(), step)
}

/// Reads `[time]`: step and end.
fn read_time(root: &Section<'_>) -> (Option<f64>, Option<f64>) {
    let Some(section) = root.table("time") else { return (None, None) };
    let (step, end) = (section.number("step"), section.number("end"));
    match (root.has("stage"), section.has("end")) {
        (true, true) => {
            section.fail(
                "end",
                "cannot be given together with stages: it follows from their durations",
            );
        }
        (true, false) => {}
        (false, _) => section.require("end"),
    }
    require_a_step(&section, "end", end, step);
    (step, end)
}

/// Names and times of the stages.
fn timetable(sections: &[Section<'_>], step: Option<f64>) -> Timetable {
    let mut names: Vec<Option<String>> = Vec::new();
    let mut times = Vec::new();
    let mut start = 0.0;
    for section in sections {
        let name = section.text("name");
        if name.is_some() && names.contains(&name) {
            section.fail("name", "there is another stage of this name");
        }
        names.push(name);
        let duration = section.number("duration");
        require_a_step(section, "duration", duration, step);
        let end = start + duration.unwrap_or(1.0);
        times.push(start..end);
        start = end;
    }
    Timetable { names, times }
}

/// The models that act in a stage.
fn read_physics(
    sections: &[StageSection],
    root: &Section<'_>,
    context: ReadContext<'_>,
    step: Option<f64>,
) -> Option<Physics> {
    let open = |name| StageSection::open(sections, name, root.problems);
    let (gravity, contact, cohesion_section) = (open("gravity"), open("contact"), open("cohesion"));
    for (name, section) in [("gravity", &gravity), ("contact", &contact)] {
        if section.is_none() {
            root.require(name);
        }
    }
    let magnitude = gravity.and_then(|section| read_gravity(&section, context.units));
    let context = ReadContext { gravity: magnitude, ..context };
    let walls = context.domain.map(|domain| contacts_of(root.node, domain)).unwrap_or_default();
    let adhesion = AdhesionContext { cohesive: cohesion_section.is_some(), read: context };
    let species = context.species;
    let contact = contact.and_then(|section| read_contact(&section, &walls, species, &adhesion));
    let vibration = open("vibration").map(|section| read_vibration(&section, context));
    let models = contact.as_ref().map(|contact| &contact.particles);
    let cohesion = cohesion_section.map(|section| read_attraction(&section, models, context));
    let gas = open("gas").map(|section| read_gas(&section, context));
    let magnitude = magnitude?;
    // A section that exists but is wrong invalidates the stage.
    let (vibration, cohesion) = (all_or_none(vibration)?, all_or_none(cohesion)?);
    let contact = contact?;
    Some(Physics {
        contact: contact.particles,
        at_walls: contact.at_walls,
        cohesion,
        exchanges: Exchanges::default(),
        gas: gas.unwrap_or(Some(GasModel::None))?,
        gravity: EffectiveGravity { magnitude, vibration },
        time_step: step?,
    })
}

/// Reads `[cohesion]` for all pairs of species, softened like their contacts.
fn read_attraction(
    section: &Section<'_>,
    models: Option<&ByPair<ContactModel>>,
    context: ReadContext<'_>,
) -> Option<ByPair<VanDerWaals>> {
    let shared = SharedSection { name: "cohesion", keys: COHESION, base: section.node };
    context.species.read_pairs(section, shared, |of_pair, pair| {
        let cohesion = read_cohesion(of_pair, context)?;
        softened(cohesion, models?.of(pair), of_pair, context)
    })
}

/// `Some(None)` if there is none, `None` if it is wrong.
fn all_or_none<T>(read: Option<Option<T>>) -> Option<Option<T>> {
    read.map_or(Some(None), |read| read.map(Some))
}
