//! Errors in a case file, each with its place, key, value and the allowed values.

use std::cell::RefCell;
use std::fmt;
use thiserror::Error;

/// Place of an error in the input.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SourcePlace {
    /// The file as a whole.
    File,
    /// A line, from 1.
    Line(usize),
    /// A line and a column, from 1, at which the parser failed.
    Column(usize, usize),
    /// An override `key.path=value` on the command line.
    Override(String),
}

/// One error.
#[derive(Clone, Debug, PartialEq)]
pub struct CaseError {
    /// Its place.
    pub place: SourcePlace,
    /// Path of the key, for example `contact.restitution`; empty if the error does not belong to a key.
    pub key: String,
    /// The value as it was written, if there is one.
    pub value: Option<String>,
    /// The error, or the allowed values.
    pub message: String,
}

/// All errors of a case file, in the order of its lines; at least one.
#[derive(Clone, Debug, PartialEq, Error)]
pub struct CaseErrors {
    /// Name of the file, as given by the user.
    pub file_name: String,
    /// The errors.
    pub errors: Vec<CaseError>,
}

impl fmt::Display for CaseErrors {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, error) in self.errors.iter().enumerate() {
            if index > 0 {
                writeln!(formatter)?;
            }
            let file = &self.file_name;
            match &error.place {
                SourcePlace::File => write!(formatter, "{file}")?,
                SourcePlace::Line(line) => write!(formatter, "{file}:{line}")?,
                SourcePlace::Column(line, column) => write!(formatter, "{file}:{line}:{column}")?,
                SourcePlace::Override(text) => write!(formatter, "{file}, --set {text}")?,
            }
            if !error.key.is_empty() {
                write!(formatter, ": {}", error.key)?;
                if let Some(value) = &error.value {
                    write!(formatter, " = {value}")?;
                }
            }
            write!(formatter, ": {}", error.message)?;
        }
        Ok(())
    }
}

/// The longest value or message that is printed, in characters.
const LONGEST: usize = 400;

/// A text, or its beginning if it is long.
pub(super) fn shortened(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{} ... ({} bytes in all)", &text[..end], text.len()),
        None => text.to_owned(),
    }
}

/// Collects errors, and notes on values that the file leaves to a default.
#[derive(Debug, Default)]
pub(super) struct Problems {
    errors: RefCell<Vec<CaseError>>,
    notes: RefCell<Vec<String>>,
}

impl Problems {
    /// Adds an error, but only once: stages repeat the keys that they inherit from the base.
    pub(super) fn add(&self, mut error: CaseError) {
        error.value = error.value.map(|value| shortened(&value));
        error.message = shortened(&error.message);
        let mut errors = self.errors.borrow_mut();
        if !errors.contains(&error) {
            errors.push(error);
        }
    }

    /// Adds an error that does not belong to a key.
    pub(super) fn add_at(&self, place: SourcePlace, message: impl Into<String>) {
        self.add(CaseError { place, key: String::new(), value: None, message: message.into() });
    }

    /// Adds a note, but only once.
    pub(super) fn note(&self, note: String) {
        let mut notes = self.notes.borrow_mut();
        if !notes.contains(&note) {
            notes.push(note);
        }
    }

    /// Whether there are no errors so far.
    pub(super) fn is_empty(&self) -> bool {
        self.errors.borrow().is_empty()
    }

    /// The notes so far.
    pub(super) fn notes(&self) -> Vec<String> {
        self.notes.borrow().clone()
    }

    /// The errors in the order of their places.
    pub(super) fn into_errors(self, file_name: &str) -> CaseErrors {
        let mut errors = self.errors.into_inner();
        errors.sort_by(|a, b| a.place.cmp(&b.place));
        CaseErrors { file_name: file_name.to_owned(), errors }
    }
}
