//! The axes of a study: lists, ranges, keys that move together, and replicates.

use super::value;
use crate::study::definition::{Axis, Study};
use crate::study::problem::error_at;
use crate::study::schema::MOST_VALUES;
use crate::study::setting::{SEED, Setting, Value, rounded};
use talcum_runs::input::{self, Section, advice};

/// An axis, and whether it holds replicates of each point instead of points.
pub(super) struct GivenAxis {
    pub(super) axis: Axis,
    pub(super) replicate: bool,
}

/// All axes that can be read, in the order of the file.
pub(super) fn axes(root: &Section<'_>, text: &str) -> Vec<GivenAxis> {
    root.tables("axis").iter().filter_map(|section| axis(section, text)).collect()
}

fn axis(section: &Section<'_>, text: &str) -> Option<GivenAxis> {
    let keys = match section.given(&["key", "keys"])? {
        "key" => vec![section.text("key")?],
        _ => section.texts("keys")?,
    };
    let values = match section.given(&["values", "range"])? {
        "values" => listed(section, keys.len(), text)?,
        _ if keys.len() == 1 => range_values(section)?,
        _ => {
            section
                .fail("range", "a range has one key: list the values of keys that move together");
            return None;
        }
    };
    let name = if section.has("name") { section.text("name")? } else { keys.first()?.clone() };
    let axis = Axis { name, keys, values, line: section.node.line() };
    Some(GivenAxis { axis, replicate: section.boolean("replicate")? })
}

/// Listed values: one for each position, or for several keys a list for each position.
fn listed(section: &Section<'_>, keys: usize, text: &str) -> Option<Vec<Vec<Value>>> {
    let row = |item: &input::Node| {
        if keys == 1 {
            return Some(vec![value(item, text)]);
        }
        if item.items().len() != keys {
            let message = format!("must have {keys} values, one for each of keys");
            section.problems.add(item.error(message));
            return None;
        }
        Some(item.items().iter().map(|member| value(member, text)).collect())
    };
    section.right("values")?.items().iter().map(row).collect()
}

/// `{ from, to, step }` or `{ from, to, count, scale }`.
fn range_values(axis: &Section<'_>) -> Option<Vec<Vec<Value>>> {
    let range = axis.table("range")?;
    let (from, to) = (range.number("from")?, range.number("to")?);
    let logarithmic = range.word("scale")? == "logarithmic";
    if logarithmic && (from <= 0.0 || to <= 0.0) {
        axis.fail("range", "a logarithmic range must lie above 0");
        return None;
    }
    let numbers: Vec<f64> = match range.given(&["step", "count"])? {
        "count" => {
            let last = range.count("count")? - 1;
            (0..=last).map(|index| between([from, to], index, last, logarithmic)).collect()
        }
        _ if logarithmic => {
            range.fail("step", "cannot be given on a logarithmic scale: give count");
            return None;
        }
        _ => {
            let (step, intervals) = (range.number("step")?, intervals(&range, from, to)?);
            (0..=intervals).map(|index| rounded(from + index as f64 * step)).collect()
        }
    };
    let is_whole = |key: &&str| {
        range.right(key).is_none_or(|node| matches!(node.value, input::Value::Integer(_)))
    };
    let all_whole = ["from", "to", "step"].iter().all(is_whole)
        && numbers.iter().all(|number| number.fract() == 0.0);
    Some(numbers.into_iter().map(|number| vec![of_range(number, all_whole)]).collect())
}

fn intervals(range: &Section<'_>, from: f64, to: f64) -> Option<u64> {
    // The end belongs to the range although its distance is no exact multiple of the step in binary.
    let intervals = ((to - from) / range.number("step")? + 1.0e-9).floor();
    if !(0.0..MOST_VALUES as f64).contains(&intervals) {
        let message = format!("must lead from {from} to {to} in less than {MOST_VALUES} steps");
        range.fail("step", message);
        return None;
    }
    Some(intervals as u64)
}

fn between([from, to]: [f64; 2], index: u64, last: u64, logarithmic: bool) -> f64 {
    let share = index as f64 / last as f64;
    match index {
        0 => from,
        _ if index == last => to,
        _ if logarithmic => rounded(from * libm::pow(to / from, share)),
        _ => rounded(from + share * (to - from)),
    }
}

fn of_range(number: f64, whole: bool) -> Value {
    if whole {
        Value::new(&format!("{number:.0}"), Some(number))
    } else {
        Value::from_number(number)
    }
}

/// The replicates: `seeds`, or the one axis with `replicate = true`.
pub(super) fn replicates(root: &Section<'_>, axes: &[GivenAxis]) -> Option<Axis> {
    let given: Vec<&Axis> = axes.iter().filter(|axis| axis.replicate).map(|a| &a.axis).collect();
    let has_seeds = root.has("seeds");
    if let (Some(second), true) = (given.get(usize::from(!has_seeds)), !given.is_empty()) {
        let message = "there can be one axis of replicates only, or seeds".to_owned();
        root.problems.add(error_at(second.line, "axis.replicate", message));
        return None;
    }
    if !has_seeds {
        return given.first().map(|axis| (*axis).clone());
    }
    let node = root.right("seeds")?;
    let seeds = match node.as_count() {
        Some(count) => (1..=count).collect(),
        None => node.as_list(input::Node::as_count)?,
    };
    let values = seeds.into_iter().map(|seed| vec![Value::from_count(seed)]).collect();
    let (name, keys, line) = (SEED.to_owned(), vec![SEED.to_owned()], node.line());
    Some(Axis { name, keys, values, line })
}

/// The position of the axis that a key of a section names.
pub(super) fn find(section: &Section<'_>, key: &str, axes: &[Axis]) -> Option<usize> {
    let name = section.text(key)?;
    let position = axes.iter().position(|axis| axis.name == name);
    if position.is_none() {
        let names: Vec<&str> = axes.iter().map(|axis| axis.name.as_str()).collect();
        let message = match names.as_slice() {
            [] => "there is no axis".to_owned(),
            _ => format!("no such axis: {}", advice(&name, &names)),
        };
        section.fail(key, message);
    }
    position
}

/// Rejects a key that is set in two places, and values that occur twice on an axis.
pub(super) fn check_keys(study: &Study, root: &Section<'_>) {
    let fail = |line: usize, key: &str, message: String| {
        root.problems.add(error_at(line, key, message));
    };
    let of_axes = study.axes.iter().chain(&study.replicates);
    let mut places: Vec<(&str, usize)> =
        study.common.iter().map(|Setting { key, line, .. }| (key.as_str(), *line)).collect();
    places.extend(of_axes.flat_map(|axis| axis.keys.iter().map(|key| (key.as_str(), axis.line))));
    places.extend(study.bisection.iter().map(|search| (search.key.as_str(), search.line)));
    for (index, &(key, line)) in places.iter().enumerate() {
        if let Some((_, first)) = places[..index].iter().find(|(other, _)| *other == key) {
            fail(line, key, format!("is already set at line {first}"));
        }
    }
    let continued = study.continuation.as_ref().map(|continuation| continuation.axis);
    for (position, axis) in study.axes.iter().enumerate() {
        // A ramp up and down passes the same value twice, with different histories.
        if axis.repeats() && continued != Some(position) {
            fail(axis.line, &axis.name, "has the same values twice".to_owned());
        }
    }
    if let Some(axis) = study.replicates.as_ref().filter(|axis| axis.repeats()) {
        fail(axis.line, &axis.name, "has the same values twice".to_owned());
    }
}
