//! Reads one section key by key and collects what is wrong with it.

use super::allowed::Allowed;
use super::errors::{CaseError, Problems};
use super::leaf::{nearest, words_for};
use super::tree::{Node, Value};
use crate::numbers::Schedule;
use serde::Deserialize;
use std::cell::RefCell;
use std::ops::Range;

/// A section that is being read. A value that is missing or wrong is reported and read as `None`.
pub(super) struct Section<'a> {
    pub(super) node: &'a Node,
    pub(super) problems: &'a Problems,
    known: RefCell<Vec<&'static str>>,
}

impl<'a> Section<'a> {
    /// A node as a section.
    pub(super) fn of(node: &'a Node, problems: &'a Problems) -> Option<Self> {
        if !matches!(node.value, Value::Table(_)) {
            let name = node.path.clone();
            problems.add(node.error(format!("must be a section of keys, [{name}] or {{ ... }}")));
            return None;
        }
        Some(Self { node, problems, known: RefCell::default() })
    }

    /// A sub-section that must be there.
    pub(super) fn section(&self, key: &'static str) -> Option<Section<'a>> {
        match self.get(key) {
            Some(node) => Section::of(node, self.problems),
            None => {
                self.missing(key, &format!("a section [{}]", self.path_of(key)));
                None
            }
        }
    }

    /// A sub-section that may be left out.
    pub(super) fn optional_section(&self, key: &'static str) -> Option<Section<'a>> {
        self.get(key).and_then(|node| Section::of(node, self.problems))
    }

    /// The value of a key, whatever it is.
    pub(super) fn get(&self, key: &'static str) -> Option<&'a Node> {
        self.known.borrow_mut().push(key);
        self.node.get(key)
    }

    /// Whether a key is given.
    pub(super) fn has(&self, key: &'static str) -> bool {
        self.get(key).is_some()
    }

    /// Reports an error of a key, at its line or, if it is left out, at that of the section.
    pub(super) fn fail(&self, key: &'static str, message: impl Into<String>) {
        let error = match self.node.get(key) {
            Some(node) => node.error(message),
            None => CaseError {
                place: self.node.place.clone(),
                key: self.path_of(key),
                value: None,
                message: message.into(),
            },
        };
        self.problems.add(error);
    }

    /// Notes that a key was left out and what stands for it.
    pub(super) fn note_default(&self, key: &'static str, default: &str) {
        if self.node.get(key).is_none() {
            self.problems.note(format!("{} is not given: {default}", self.path_of(key)));
        }
    }

    /// A value of any type that must be there.
    pub(super) fn value<T: Deserialize<'a>>(&self, key: &'static str) -> Option<T> {
        match self.get(key) {
            Some(_) => self.optional(key),
            None => {
                let wrong = words_for::<T>();
                self.missing(key, wrong.strip_prefix("must be ").unwrap_or(&wrong));
                None
            }
        }
    }

    /// A value of any type that may be left out.
    pub(super) fn optional<T: Deserialize<'a>>(&self, key: &'static str) -> Option<T> {
        let node = self.get(key)?;
        node.to().map_err(|mismatch| self.problems.add(node.error(mismatch.0))).ok()
    }

    /// A text that must be there and not be empty.
    pub(super) fn text(&self, key: &'static str) -> Option<String> {
        let text: String = self.value(key)?;
        if text.trim().is_empty() {
            self.fail(key, "must not be empty");
            return None;
        }
        Some(text)
    }

    /// A number in a range that must be there.
    pub(super) fn number(&self, key: &'static str, allowed: Allowed) -> Option<f64> {
        if !self.has(key) {
            self.missing(key, &allowed.to_string());
        }
        self.optional_number(key, allowed)
    }

    /// A number in a range that may be left out.
    pub(super) fn optional_number(&self, key: &'static str, allowed: Allowed) -> Option<f64> {
        self.number_of(self.get(key)?, allowed)
    }

    /// A number in a range; what stands for it if it is left out.
    pub(super) fn number_or(&self, key: &'static str, allowed: Allowed, default: f64) -> f64 {
        self.optional_number(key, allowed).unwrap_or(default)
    }

    /// A whole number in a range that may be left out.
    pub(super) fn optional_count(&self, key: &'static str, range: Range<u64>) -> Option<u64> {
        let count: u64 = self.optional(key)?;
        if !range.contains(&count) {
            self.fail(key, format!("must be between {} and {}", range.start, range.end - 1));
            return None;
        }
        Some(count)
    }

    /// A list of numbers, each in a range, that must be there and not be empty.
    pub(super) fn numbers(&self, key: &'static str, allowed: Allowed) -> Option<Vec<f64>> {
        let values: Vec<f64> = self.value(key)?;
        if values.is_empty() {
            self.fail(key, "must not be empty");
            return None;
        }
        match values.iter().all(|&value| allowed.check(value).is_ok()) {
            true => Some(values),
            false => {
                self.fail(key, format!("each must be {allowed}"));
                None
            }
        }
    }

    /// A number that may change with time: constant, a ramp `{ from, to }` over the stage that sets it, or
    /// steps `{ values, every }` or a sine `{ mean, amplitude, frequency }` from the begin of that stage.
    pub(super) fn schedule(
        &self,
        key: &'static str,
        allowed: Allowed,
        stages: &[Range<f64>],
    ) -> Option<Schedule> {
        let node = self.get(key)?;
        if !matches!(node.value, Value::Table(_)) {
            return self.number_of(node, allowed).map(Schedule::Constant);
        }
        let stage = stages[node.stage].clone();
        let section = Section::of(node, self.problems)?;
        let schedule = if section.has("values") || section.has("every") {
            let values = section.numbers("values", allowed);
            let every = section.number("every", Allowed::POSITIVE);
            values.zip(every).map(|(values, every)| Schedule::Steps {
                values,
                start: stage.start,
                every,
            })
        } else if ["mean", "amplitude", "frequency"].into_iter().any(|key| section.has(key)) {
            let mean = section.number("mean", allowed);
            let amplitude = section.number("amplitude", Allowed::FINITE);
            let frequency = section.number("frequency", Allowed::POSITIVE);
            mean.zip(amplitude).zip(frequency).map(|((mean, amplitude), frequency)| {
                Schedule::Sine { mean, amplitude, frequency, start: stage.start }
            })
        } else {
            let from = section.number("from", allowed);
            let to = section.number("to", allowed);
            let Range { start, end } = stage;
            from.zip(to).map(|(from, to)| Schedule::Ramp { from, to, start, end })
        };
        section.finish();
        schedule
    }

    /// Which one of several keys is given; an error unless it is exactly one.
    pub(super) fn exactly_one(&self, keys: &[&'static str]) -> Option<&'static str> {
        let given = self.at_most_one(keys)?;
        if given.is_none() {
            self.fail(keys[0], format!("missing: give {}", keys.join(" or ")));
        }
        given
    }

    /// Which one of several keys is given, `Some(None)` if none is; an error if several are.
    pub(super) fn at_most_one(&self, keys: &[&'static str]) -> Option<Option<&'static str>> {
        let mut given: Vec<&'static str> =
            keys.iter().copied().filter(|key| self.has(key)).collect();
        given.sort_by_key(|key| self.node.get(key).map(|node| &node.place));
        if let [first, others @ ..] = given.as_slice() {
            for other in others {
                self.fail(other, format!("cannot be given together with {first}: give one only"));
            }
            return others.is_empty().then_some(Some(first));
        }
        Some(None)
    }

    /// Reports the keys that nobody asked for.
    pub(super) fn finish(&self) {
        let known = self.known.borrow();
        let mut unique = known.clone();
        unique.sort_unstable();
        unique.dedup();
        for (key, node) in self.node.entries() {
            if known.contains(&key.as_str()) {
                continue;
            }
            let advice = match nearest(key, &unique) {
                Some(near) => format!("did you mean {near}?"),
                None => format!("known here are {}", unique.join(", ")),
            };
            self.problems.add(node.error(format!("unknown key: {advice}")));
        }
    }

    /// Path of a key of this section.
    pub(super) fn path_of(&self, key: &str) -> String {
        match self.node.path.as_str() {
            "" => key.to_owned(),
            path => format!("{path}.{key}"),
        }
    }

    fn missing(&self, key: &'static str, allowed: &str) {
        self.fail(key, format!("missing: must be {allowed}"));
    }

    fn number_of(&self, node: &Node, allowed: Allowed) -> Option<f64> {
        let checked = node.to().map_err(|mismatch| mismatch.0).and_then(|number| {
            allowed.check(number).map(|()| number).map_err(|words| format!("must be {words}"))
        });
        checked.map_err(|words| self.problems.add(node.error(words))).ok()
    }
}
