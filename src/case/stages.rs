//! Stages: the base of the file, changed by one stage after another.

use super::allowed::Allowed;
use super::contact::{Adhering, read_contact};
use super::errors::Problems;
use super::forces::{read_cohesion, read_gravity, read_vibration};
use super::gas::read_gas;
use super::overrides::is_partner;
use super::particles::Scales;
use super::section::Section;
use super::tree::{Node, Value};
use super::units::Units;
use super::walls::contacts_of;
use crate::contact::{ContactModel, VanDerWaals};
use crate::domain::EffectiveGravity;
use crate::gas::GasModel;
use crate::state::{Domain, Limits, Models, SizeRange};
use std::ops::Range;

/// Sections that a stage may change.
const SECTIONS: [&str; 5] = ["gravity", "vibration", "contact", "cohesion", "gas"];
/// Their sub-sections, of which a stage may change single keys too.
const SUBSECTIONS: [&str; 1] = ["wall"];
/// Those that may be switched off.
const OPTIONAL: [&str; 3] = ["vibration", "cohesion", "gas"];

/// A part of the run during which the same models hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Stage {
    /// Its name.
    pub name: String,
    /// When it begins.
    pub start: f64,
    /// When it ends: the next one's start.
    pub end: f64,
    /// Length of a step.
    pub time_step: f64,
    /// Where particles touch.
    pub contact: ContactModel,
    /// Where they touch the walls, by the walls' numbers.
    pub at_walls: Vec<ContactModel>,
    /// Attraction.
    pub cohesion: Option<VanDerWaals>,
    /// Gas.
    pub gas: GasModel,
    /// Gravity in the frame of the plate.
    pub gravity: EffectiveGravity,
}

impl Stage {
    /// The models of this stage for particles of these sizes.
    ///
    /// The sizes are those at the start of the run, also in a restart: limits and lattices follow from them.
    pub fn models(&self, sizes: &SizeRange) -> Models {
        let limits = self.limits(sizes);
        Models {
            contact: self.contact.clone(),
            at_walls: self.at_walls.clone(),
            cohesion: self.cohesion.clone(),
            gas: self.gas.clone(),
            gravity: self.gravity,
            time_step: self.time_step,
            limits,
            force_quantum: limits.force_quantum(),
            torque_quantum: limits.torque_quantum(0.5 * sizes.largest_diameter),
        }
    }

    /// All ways in which bodies touch.
    pub fn interfaces(&self) -> impl Iterator<Item = &ContactModel> {
        std::iter::once(&self.contact).chain(&self.at_walls)
    }

    /// What particles of these sizes may not exceed.
    pub(super) fn limits(&self, sizes: &SizeRange) -> Limits {
        Limits::new(
            self.interfaces(),
            self.cohesion.as_ref(),
            [sizes.smallest_diameter, sizes.largest_diameter],
            sizes.largest_mass * self.gravity.largest(),
            self.time_step,
        )
    }
}

/// What the stages need from the rest of the file, as far as it is known.
pub(super) struct Surroundings<'a> {
    pub(super) units: Option<Units>,
    pub(super) scales: Scales,
    pub(super) domain: Option<&'a Domain>,
}

/// A section that stages may change: as it stands now, and whether it is switched on.
#[derive(Clone, Default)]
struct Current {
    node: Option<Node>,
    is_on: bool,
    was_on: bool,
}

/// `[time]`, `[[stage]]` and the sections of what acts on particles. Also returns the time step.
pub(super) fn read_stages(
    root: &Section<'_>,
    surroundings: &Surroundings<'_>,
) -> (Option<Vec<Stage>>, Option<f64>) {
    let problems = root.problems;
    let list = root.get("stage");
    let (step, end) = read_time(root, list.is_some());
    let members = list.map(|node| stage_sections(node, problems)).unwrap_or_default();
    let (names, times) = match list {
        Some(_) => timetable(&members, step),
        None => (vec![Some("run".to_owned())], std::iter::once(0.0..end.unwrap_or(1.0)).collect()),
    };
    let mut current: [Current; SECTIONS.len()] = Default::default();
    change_all(&mut current, root, 0);
    if times.is_empty() {
        return (None, step);
    }
    let mut stages = Vec::new();
    for (index, time) in times.iter().enumerate() {
        if let Some(section) = members.get(index) {
            change_all(&mut current, section, index);
        }
        let forces = read_forces(&current, root, surroundings, &times);
        current.iter_mut().for_each(|current| current.was_on |= current.is_on);
        stages.push(forces.and_then(|((contact, at_walls), cohesion, gas, gravity)| {
            let (name, time_step) = (names[index].clone()?, step?);
            let Range { start, end } = time.clone();
            Some(Stage { name, start, end, time_step, contact, at_walls, cohesion, gas, gravity })
        }));
    }
    // Also a section that no stage switches on must be right.
    if current.iter().any(|current| !current.was_on && current.node.is_some()) {
        current.iter_mut().for_each(|current| current.is_on |= !current.was_on);
        read_forces(&current, root, surroundings, &times);
    }
    members.iter().for_each(Section::finish);
    (stages.into_iter().collect(), step)
}

/// What the base of the file, or a stage, says about each of the sections.
fn change_all(current: &mut [Current; SECTIONS.len()], section: &Section<'_>, stage: usize) {
    for (name, current) in SECTIONS.into_iter().zip(current) {
        if let Some(node) = section.get(name) {
            current.change(name, node, stage, section.problems);
        }
    }
}

/// `[time]`: step and end.
fn read_time(root: &Section<'_>, staged: bool) -> (Option<f64>, Option<f64>) {
    let Some(section) = root.section("time") else { return (None, None) };
    let step = section.number("step", Allowed::POSITIVE);
    let end = match (staged, section.has("end")) {
        (true, true) => {
            section.fail("end", "cannot be given together with stages: their durations say it");
            None
        }
        (true, false) => None,
        (false, _) => section.number("end", Allowed::POSITIVE),
    };
    if let (Some(step), Some(end)) = (step, end)
        && end < step
    {
        section.fail("end", format!("must be at least time.step, {step}"));
    }
    section.finish();
    (step, end)
}

fn stage_sections<'a>(node: &'a Node, problems: &'a Problems) -> Vec<Section<'a>> {
    if !matches!(node.value, Value::List(_)) || node.items().is_empty() {
        problems.add(node.error("must be a list of sections, each [[stage]]"));
    }
    node.items().iter().filter_map(|item| Section::of(item, problems)).collect()
}

/// Names and times of the stages.
fn timetable(
    sections: &[Section<'_>],
    step: Option<f64>,
) -> (Vec<Option<String>>, Vec<Range<f64>>) {
    let mut names: Vec<Option<String>> = Vec::new();
    let mut times = Vec::new();
    let mut start = 0.0;
    for section in sections {
        let name = section.text("name");
        if name.is_some() && names.contains(&name) {
            section.fail("name", "there is another stage of this name");
        }
        names.push(name);
        let duration = section.number("duration", Allowed::POSITIVE);
        if let (Some(duration), Some(step)) = (duration, step)
            && duration < step
        {
            section.fail("duration", format!("must be at least time.step, {step}"));
        }
        let end = start + duration.unwrap_or(1.0);
        times.push(start..end);
        start = end;
    }
    (names, times)
}

type Forces = ((ContactModel, Vec<ContactModel>), Option<VanDerWaals>, GasModel, EffectiveGravity);

fn read_forces(
    current: &[Current; SECTIONS.len()],
    root: &Section<'_>,
    surroundings: &Surroundings<'_>,
    times: &[Range<f64>],
) -> Option<Forces> {
    let Surroundings { units, scales, domain } = *surroundings;
    let bounds = domain.map(|domain| &domain.bounds);
    let [gravity, vibration, contact, cohesion, gas] =
        std::array::from_fn(|index| Current::section(&current[index], root.problems));
    // A section that must be there is missed at the top of the file.
    let is_missing = |name| root.node.get(name).is_none();
    for (name, section) in [("gravity", &gravity), ("contact", &contact)] {
        if section.is_none() && is_missing(name) {
            root.fail(name, format!("missing: must be a section [{name}]"));
        }
    }
    let magnitude = gravity.and_then(|section| read_gravity(section, units));
    let walls = domain.map(|domain| contacts_of(root.node, domain)).unwrap_or_default();
    let adhering = Adhering { cohesive: cohesion.is_some(), units, scales, gravity: magnitude };
    let contact = contact.and_then(|section| read_contact(section, &walls, &adhering));
    let vibration = vibration.map(|section| read_vibration(section, magnitude, times));
    let cohesion = cohesion.map(|section| read_cohesion(section, scales, magnitude, times));
    let gas = gas.map(|section| read_gas(section, scales, magnitude, bounds, times));
    let all = |magnitude| {
        let vibration = vibration.map_or(Some(None), |vibration| vibration.map(Some))?;
        let cohesion = cohesion.map_or(Some(None), |cohesion| cohesion.map(Some))?;
        let gas = gas.unwrap_or(Some(GasModel::None))?;
        Some((contact?, cohesion, gas, EffectiveGravity { magnitude, vibration }))
    };
    magnitude.and_then(all)
}

impl Current {
    /// The section, if it is switched on.
    fn section<'a>(current: &'a Current, problems: &'a Problems) -> Option<Section<'a>> {
        current.node.as_ref().filter(|_| current.is_on).and_then(|node| Section::of(node, problems))
    }

    /// What a stage, or the base of the file, says about this section.
    fn change(&mut self, name: &str, change: &Node, stage: usize, problems: &Problems) {
        let can_be_off = OPTIONAL.contains(&name);
        match (&change.value, change.as_text()) {
            (Value::Table(_), _) => {
                self.merge(change, stage);
                self.is_on = true;
            }
            (_, Some("off")) if can_be_off => self.is_on = false,
            (_, Some("on")) if can_be_off && self.node.is_some() => self.is_on = true,
            (_, Some("on")) if can_be_off => {
                problems
                    .add(change.error("there is nothing to switch on: no keys are given before"));
            }
            _ if can_be_off => {
                problems.add(change.error("must be a section of keys, \"off\" or \"on\""))
            }
            _ => problems.add(change.error("must be a section of keys")),
        }
    }

    /// Takes over the keys of a change; each replaces its partner of which only one is given.
    fn merge(&mut self, change: &Node, stage: usize) {
        let mut change = change.clone();
        change.for_each(&mut |node| node.stage = stage);
        let Some(Node { value: Value::Table(kept), .. }) = &mut self.node else {
            self.node = Some(change);
            return;
        };
        let Value::Table(entries) = change.value else { return };
        take_over(kept, entries);
    }
}

/// Puts entries in the place of those of the same key, or of a key that cannot stand beside them; those of
/// sub-sections are merged likewise.
pub(super) fn take_over(kept: &mut Vec<(String, Node)>, entries: Vec<(String, Node)>) {
    for (key, node) in entries {
        let inner =
            kept.iter_mut().find(|(name, _)| *name == key && SUBSECTIONS.contains(&name.as_str()));
        if let (Some((_, Node { value: Value::Table(inner), .. })), Value::Table(changes)) =
            (inner, &node.value)
        {
            take_over(inner, changes.clone());
            continue;
        }
        kept.retain(|(name, _)| *name != key && !is_partner(&key, name));
        kept.push((key, node));
    }
}
