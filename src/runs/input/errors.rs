//! What is wrong with a file: every error with its place, key, value and what is allowed.

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
pub struct InputError {
    /// Its place.
    pub place: SourcePlace,
    /// Path of the key, for example `contact.restitution`; empty if the error does not belong to a key.
    pub key: String,
    /// The value as it was written, if there is one.
    pub value: Option<String>,
    /// The error, or the allowed values.
    pub message: String,
}

impl InputError {
    /// The error without the ends of a long value and a long message.
    pub(super) fn shortened(self) -> Self {
        let value = self.value.map(|value| shortened(&value, LONGEST_VALUE));
        let message = shortened(&self.message, LONGEST_MESSAGE);
        Self { value, message, ..self }
    }
}

/// All errors of a file, in the order of its lines; at least one.
#[derive(Clone, Debug, PartialEq, Error)]
pub struct InputErrors {
    /// Name of the file, as given by the user.
    pub file_name: String,
    /// The errors.
    pub errors: Vec<InputError>,
}

impl InputErrors {
    /// The first errors, and one that counts the others.
    pub fn first(mut self, most: usize) -> Self {
        let more = self.errors.len().saturating_sub(most);
        if more > 0 {
            self.errors.truncate(most);
            let message = format!("and {more} more");
            let (place, key, value) = (SourcePlace::File, String::new(), None);
            self.errors.push(InputError { place, key, value, message });
        }
        self
    }
}

impl fmt::Display for InputErrors {
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

/// The longest value that is printed, in characters.
const LONGEST_VALUE: usize = 400;

/// The longest message, in characters: it may list names that are known, or hold the errors of another file.
const LONGEST_MESSAGE: usize = 2000;

/// A text, or its beginning if it is long.
fn shortened(text: &str, longest: usize) -> String {
    match text.char_indices().nth(longest) {
        Some((end, _)) => format!("{} ... ({} bytes in all)", &text[..end], text.len()),
        None => text.to_owned(),
    }
}

/// Collects errors, and notes on values that the file leaves to a default.
#[derive(Debug, Default)]
pub struct Problems {
    errors: RefCell<Vec<InputError>>,
    notes: RefCell<Vec<String>>,
}

impl Problems {
    /// Adds an error, once: stages repeat what they take over from the base.
    pub fn add(&self, error: InputError) {
        let error = error.shortened();
        let mut errors = self.errors.borrow_mut();
        if !errors.contains(&error) {
            errors.push(error);
        }
    }

    /// Adds an error that belongs to no key.
    pub fn add_at(&self, place: SourcePlace, message: impl Into<String>) {
        self.add(InputError { place, key: String::new(), value: None, message: message.into() });
    }

    /// Adds a note, once.
    pub fn note(&self, note: String) {
        let mut notes = self.notes.borrow_mut();
        if !notes.contains(&note) {
            notes.push(note);
        }
    }

    /// Whether nothing is wrong so far.
    pub fn is_empty(&self) -> bool {
        self.errors.borrow().is_empty()
    }

    /// The notes so far.
    pub fn notes(&self) -> Vec<String> {
        self.notes.borrow().clone()
    }

    /// The value if nothing is wrong, else the errors.
    ///
    /// # Errors
    /// If there are any, or if there is no value.
    pub fn result<T>(self, file_name: &str, value: Option<T>) -> Result<T, InputErrors> {
        match value {
            Some(value) if self.is_empty() => Ok(value),
            _ => Err(self.into_errors(file_name)),
        }
    }

    /// The errors in the order of their places.
    pub fn into_errors(self, file_name: &str) -> InputErrors {
        let mut errors = self.errors.into_inner();
        errors.sort_by(|a, b| a.place.cmp(&b.place));
        InputErrors { file_name: file_name.to_owned(), errors }
    }
}
