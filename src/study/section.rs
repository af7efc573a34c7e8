//! Reading of a section of a study file key by key, with collection of its errors.

use crate::study::problem::{Problem, Problems};
use std::cell::RefCell;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The text that is read, and the errors found in it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source<'a> {
    /// The text.
    pub(crate) text: &'a str,
    /// Its errors.
    pub(crate) problems: &'a Problems,
}

impl Source<'_> {
    fn line_at(&self, offset: usize) -> usize {
        self.text.as_bytes().iter().take(offset).filter(|&&byte| byte == b'\n').count() + 1
    }
}

/// A value of the file, with its place.
#[derive(Clone, Debug)]
pub(crate) struct Entry<'a> {
    /// The value.
    pub(crate) value: &'a DeValue<'a>,
    /// Path of the key.
    pub(crate) path: String,
    /// Line of the key, from 1.
    pub(crate) line: usize,
    /// The value as it was written.
    pub(crate) written: &'a str,
    /// Source to which errors are reported.
    pub(crate) source: Source<'a>,
}

impl<'a> Entry<'a> {
    /// Reports an error of the value.
    pub(crate) fn fail(&self, message: impl Into<String>) {
        let is_section = matches!(self.value, DeValue::Table(_));
        let value = (!is_section).then(|| self.written.to_owned());
        let (line, key) = (Some(self.line), self.path.clone());
        self.source.problems.add(Problem { line, key, value, message: message.into() });
    }

    /// The number, or an error.
    pub(crate) fn number(&self) -> Option<f64> {
        let number = number_of(self.value).filter(|number| number.is_finite());
        if number.is_none() {
            self.fail("must be a number");
        }
        number
    }

    /// The whole number in a range, or an error.
    pub(crate) fn count(&self, least: u64, most: u64) -> Option<u64> {
        let count = match self.value {
            DeValue::Integer(integer) => {
                u64::from_str_radix(integer.as_str(), integer.radix()).ok()
            }
            _ => None,
        };
        let count = count.filter(|count| (least..=most).contains(count));
        if count.is_none() {
            self.fail(format!("must be a whole number from {least} to {most}"));
        }
        count
    }

    /// The text, or an error.
    pub(crate) fn text(&self) -> Option<String> {
        match self.value {
            DeValue::String(text) if !text.trim().is_empty() => Some(text.to_string()),
            _ => {
                self.fail("must be a text in quotes, not empty");
                None
            }
        }
    }

    /// The members of a list, or an error; an empty list is an error too.
    pub(crate) fn list(&self) -> Option<Vec<Entry<'a>>> {
        match self.value {
            DeValue::Array(items) if !items.is_empty() => {
                Some(items.iter().enumerate().map(|(index, item)| self.item(index, item)).collect())
            }
            DeValue::Array(_) => {
                self.fail("must not be empty");
                None
            }
            _ => {
                self.fail("must be a list in brackets");
                None
            }
        }
    }

    /// The value as a section, or an error.
    pub(crate) fn section(&self) -> Option<Section<'a>> {
        match self.value {
            DeValue::Table(table) => {
                let (path, line, source) = (self.path.clone(), self.line, self.source);
                Some(Section { table, path, line, source, known: RefCell::default() })
            }
            _ => {
                self.fail(format!("must be a section of keys, [{}] or {{ ... }}", self.path));
                None
            }
        }
    }

    /// The value as a section if the condition holds.
    pub(crate) fn section_if(&self, condition: bool) -> Option<Section<'a>> {
        if condition { self.section() } else { None }
    }

    fn item(&self, index: usize, item: &'a Spanned<DeValue<'a>>) -> Entry<'a> {
        let (source, span) = (self.source, item.span());
        let path = format!("{}.{}", self.path, index + 1);
        let written = source.text.get(span.clone()).unwrap_or_default();
        Entry { value: item.get_ref(), path, line: source.line_at(span.start), written, source }
    }
}

/// The value of a number, whole or not.
pub(crate) fn number_of(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(integer) => {
            i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|whole| whole as f64)
        }
        _ => None,
    }
}

/// A section that is being read. A value that is missing or wrong is reported and read as `None`.
#[derive(Debug)]
pub(crate) struct Section<'a> {
    table: &'a DeTable<'a>,
    /// Path of the section.
    pub(crate) path: String,
    /// Its line, from 1.
    pub(crate) line: usize,
    /// Source to which errors are reported.
    pub(crate) source: Source<'a>,
    known: RefCell<Vec<&'static str>>,
}

impl<'a> Section<'a> {
    /// The file itself.
    pub(crate) fn root(table: &'a DeTable<'a>, source: Source<'a>) -> Self {
        Self { table, path: String::new(), line: 1, source, known: RefCell::default() }
    }

    /// The value of a key, of any kind.
    pub(crate) fn optional(&self, key: &'static str) -> Option<Entry<'a>> {
        self.known.borrow_mut().push(key);
        self.entries().into_iter().find(|(name, _)| name == key).map(|(_, entry)| entry)
    }

    /// The value of a required key; `allowed` describes the allowed values.
    pub(crate) fn required(&self, key: &'static str, allowed: &str) -> Option<Entry<'a>> {
        let entry = self.optional(key);
        if entry.is_none() {
            self.fail(key, format!("missing: must be {allowed}"));
        }
        entry
    }

    /// Reports an error of a missing key, at the line of the section.
    pub(crate) fn fail(&self, key: &str, message: impl Into<String>) {
        let (line, key) = (Some(self.line), self.path_of(key));
        self.source.problems.add(Problem { line, key, value: None, message: message.into() });
    }

    /// All keys with their values, in the order of the file.
    pub(crate) fn entries(&self) -> Vec<(String, Entry<'a>)> {
        let source = self.source;
        let entry = |(key, value): (&'a Spanned<_>, &'a Spanned<DeValue<'a>>)| {
            let name = AsRef::<str>::as_ref(key.get_ref()).to_owned();
            let line = source.line_at(key.span().start);
            let written = source.text.get(value.span()).unwrap_or_default();
            let path = self.path_of(&name);
            (key.span().start, name, Entry { value: value.get_ref(), path, line, written, source })
        };
        let table: &'a DeTable<'a> = self.table;
        let mut entries: Vec<_> = table.iter().map(entry).collect();
        entries.sort_by_key(|(start, _, _)| *start);
        entries.into_iter().map(|(_, name, entry)| (name, entry)).collect()
    }

    /// Reports the keys that have not been read.
    pub(crate) fn finish(&self) {
        let mut known = self.known.borrow().clone();
        known.sort_unstable();
        known.dedup();
        for (name, entry) in self.entries() {
            if !known.contains(&name.as_str()) {
                entry.fail(format!("unknown key: {}", advice(&name, &known)));
            }
        }
    }

    fn path_of(&self, key: &str) -> String {
        match self.path.as_str() {
            "" => key.to_owned(),
            path => format!("{path}.{key}"),
        }
    }
}

/// A suggestion for an unknown name: the most similar one, or the list of all.
pub(crate) fn advice(unknown: &str, known: &[&str]) -> String {
    let likeness = |name: &&&str| (strsim::jaro_winkler(unknown, name) * 1.0e6) as u64;
    let nearest = known.iter().max_by_key(likeness);
    match nearest {
        Some(near) if strsim::jaro_winkler(unknown, near) > 0.8 => format!("did you mean {near}?"),
        _ => format!("known here are {}", known.join(", ")),
    }
}
