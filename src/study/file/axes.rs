//! The axes of a study: lists, ranges, keys that move together, and replicates.

use crate::study::definition::{Axis, Study};
use crate::study::problem::Problem;
use crate::study::section::{Entry, Section, advice, number_of};
use crate::study::setting::{SEED, Setting, Value, rounded};
use toml::de::DeValue;

/// An axis, and whether it holds replicates of each point instead of points.
pub(super) struct GivenAxis {
    pub(super) axis: Axis,
    pub(super) replicate: bool,
}

/// Largest number of values in a range: a larger one is a typing error.
const MOST_VALUES: u64 = 100_000;

/// All axes that can be read, in the order of the file.
pub(super) fn axes(root: &Section<'_>) -> Vec<GivenAxis> {
    let Some(entry) = root.optional("axis") else { return Vec::new() };
    let entries = entry.list().unwrap_or_default();
    entries.iter().filter_map(|entry| axis(&entry.section()?)).collect()
}

fn axis(section: &Section<'_>) -> Option<GivenAxis> {
    let keys = keys(section);
    let name = section.optional("name").map(|entry| entry.text());
    let replicate = match section.optional("replicate") {
        None => false,
        Some(entry) => match entry.value {
            DeValue::Boolean(truth) => *truth,
            _ => {
                entry.fail("must be true or false");
                false
            }
        },
    };
    let (list, range) = (section.optional("values"), section.optional("range"));
    section.finish();
    let keys = keys?;
    let values = match (list, range) {
        (Some(list), None) => listed(&list, keys.len())?,
        (None, Some(entry)) if keys.len() == 1 => range_values(&entry)?,
        (None, Some(entry)) => {
            entry.fail("a range has one key: list the values of keys that move together");
            return None;
        }
        (None, None) => {
            section.fail("values", "missing: give values or range");
            return None;
        }
        (Some(_), Some(entry)) => {
            entry.fail("cannot be given together with values: give one only");
            return None;
        }
    };
    let name = name.unwrap_or_else(|| keys.first().cloned())?;
    Some(GivenAxis { axis: Axis { name, keys, values, line: section.line }, replicate })
}

/// The key, or the keys that move together.
fn keys(section: &Section<'_>) -> Option<Vec<String>> {
    match (section.optional("key"), section.optional("keys")) {
        (Some(key), None) => Some(vec![key.text()?]),
        (None, Some(keys)) => keys.list()?.iter().map(Entry::text).collect(),
        (None, None) => {
            section.fail("key", "missing: give key, or keys that move together");
            None
        }
        (Some(_), Some(keys)) => {
            keys.fail("cannot be given together with key: give one only");
            None
        }
    }
}

/// Listed values: one for each position, or for several keys a list for each position.
fn listed(entry: &Entry<'_>, keys: usize) -> Option<Vec<Vec<Value>>> {
    let row = |item: &Entry<'_>| {
        if keys == 1 {
            return Some(vec![value(item)]);
        }
        let row: Vec<Value> = item.list()?.iter().map(value).collect();
        if row.len() != keys {
            item.fail(format!("must have {keys} values, one for each of keys"));
            return None;
        }
        Some(row)
    };
    entry.list()?.iter().map(row).collect()
}

/// Any value of a key of the case.
pub(super) fn value(entry: &Entry<'_>) -> Value {
    Value::new(entry.written, number_of(entry.value))
}

/// `{ from, to, step }` or `{ from, to, count, scale }`.
fn range_values(entry: &Entry<'_>) -> Option<Vec<Vec<Value>>> {
    let section = entry.section()?;
    let from = section.required("from", "a number");
    let to = section.required("to", "a number");
    let (step, count) = (section.optional("step"), section.optional("count"));
    let scale = scale(&section);
    section.finish();
    let (from_entry, to_entry) = (from?, to?);
    let (from, to) = (from_entry.number()?, to_entry.number()?);
    let logarithmic = scale?;
    if logarithmic && (from <= 0.0 || to <= 0.0) {
        entry.fail("a logarithmic range must lie above 0");
        return None;
    }
    let whole = |entry: &Entry<'_>| matches!(entry.value, DeValue::Integer(_));
    let mut all_whole = whole(&from_entry) && whole(&to_entry);
    let numbers: Vec<f64> = match (step, count) {
        (Some(step), None) if !logarithmic => {
            all_whole &= whole(&step);
            let intervals = intervals(&step, from, to)?;
            let step = step.number()?;
            (0..=intervals).map(|index| rounded(from + index as f64 * step)).collect()
        }
        (None, Some(count)) => {
            let count = count.count(2, MOST_VALUES)?;
            (0..count).map(|index| between(from, to, index, count - 1, logarithmic)).collect()
        }
        _ => {
            entry.fail("must have either step (not logarithmic) or count");
            return None;
        }
    };
    all_whole &= numbers.iter().all(|number| number.fract() == 0.0);
    Some(numbers.into_iter().map(|number| vec![of_range(number, all_whole)]).collect())
}

/// Whether the scale is logarithmic.
pub(super) fn scale(section: &Section<'_>) -> Option<bool> {
    let Some(entry) = section.optional("scale") else { return Some(false) };
    match entry.text()?.as_str() {
        "linear" => Some(false),
        "logarithmic" => Some(true),
        _ => {
            entry.fail("must be \"linear\" or \"logarithmic\"");
            None
        }
    }
}

fn intervals(step: &Entry<'_>, from: f64, to: f64) -> Option<u64> {
    // The end belongs to the range, although its distance is not an exact multiple of the step in binary.
    let intervals = ((to - from) / step.number()? + 1.0e-9).floor();
    if !(0.0..MOST_VALUES as f64).contains(&intervals) {
        step.fail(format!("must lead from {from} to {to} in less than {MOST_VALUES} steps"));
        return None;
    }
    Some(intervals as u64)
}

fn between(from: f64, to: f64, index: u64, last: u64, logarithmic: bool) -> f64 {
    let share = index as f64 / last as f64;
    match index {
        0 => from,
        _ if index == last => to,
        _ if logarithmic => rounded(from * libm::pow(to / from, share)),
        _ => rounded(from + share * (to - from)),
    }
}

fn of_range(number: f64, whole: bool) -> Value {
    match whole {
        true => Value::new(&format!("{number:.0}"), Some(number)),
        false => Value::from_number(number),
    }
}

/// The replicates: `seeds`, or the one axis with `replicate = true`.
pub(super) fn replicates(root: &Section<'_>, axes: &[GivenAxis]) -> Option<Axis> {
    let given: Vec<&Axis> = axes.iter().filter(|axis| axis.replicate).map(|a| &a.axis).collect();
    let seeds = root.optional("seeds");
    if let (Some(second), true) = (given.get(usize::from(seeds.is_none())), !given.is_empty()) {
        let (line, key, value) = (Some(second.line), "axis.replicate".to_owned(), None);
        let message = "there can be one axis of replicates only, or seeds".to_owned();
        root.source.problems.add(Problem { line, key, value, message });
        return None;
    }
    let Some(entry) = seeds else { return given.first().map(|axis| (*axis).clone()) };
    let values = match entry.value {
        DeValue::Array(_) => {
            let seeds: Option<Vec<u64>> =
                entry.list()?.iter().map(|seed| seed.count(0, i64::MAX as u64)).collect();
            seeds?.into_iter().map(Value::from_count).collect()
        }
        _ => (1..=entry.count(1, 10_000)?).map(Value::from_count).collect::<Vec<_>>(),
    };
    let values = values.into_iter().map(|value| vec![value]).collect();
    let (name, keys, line) = (SEED.to_owned(), vec![SEED.to_owned()], entry.line);
    Some(Axis { name, keys, values, line })
}

/// The position of the axis named by an entry.
pub(super) fn find(entry: &Entry<'_>, axes: &[Axis]) -> Option<usize> {
    let name = entry.text()?;
    let position = axes.iter().position(|axis| axis.name == name);
    if position.is_none() {
        let names: Vec<&str> = axes.iter().map(|axis| axis.name.as_str()).collect();
        entry.fail(match names.as_slice() {
            [] => "there is no axis".to_owned(),
            _ => format!("no such axis: {}", advice(&name, &names)),
        });
    }
    position
}

/// Rejects a key that is set in two places, and values that occur twice on an axis.
pub(super) fn check_keys(study: &Study, root: &Section<'_>) {
    let fail = |line: usize, key: &str, message: String| {
        let (line, key) = (Some(line), key.to_owned());
        root.source.problems.add(Problem { line, key, value: None, message });
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
