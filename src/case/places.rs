//! Places of the values of a case, for errors that are found after the file was read.

use super::errors::{CaseError, CaseErrors, SourcePlace, shortened};
use super::tree::Node;
use std::collections::BTreeMap;

/// Places of all values. They are not part of the contents of a case: any two are equal.
#[derive(Clone, Debug, Default)]
pub struct Places {
    file_name: String,
    /// Errors without a message, by the path of their key.
    values: BTreeMap<String, CaseError>,
}

impl PartialEq for Places {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Places {
    /// Finds the places of a file's values; members of lists of numbers are not distinguished.
    pub(super) fn of(tree: &Node) -> Self {
        let mut places = Self::default();
        places.add(tree);
        places
    }

    /// Sets the name of the file in errors.
    pub(super) fn set_file_name(&mut self, file_name: &str) {
        file_name.clone_into(&mut self.file_name);
    }

    fn add(&mut self, node: &Node) {
        let mut error = node.error("");
        error.value = error.value.map(|value| shortened(&value));
        self.values.insert(error.key.clone(), error);
        node.entries().iter().for_each(|(_, entry)| self.add(entry));
        node.items()
            .iter()
            .filter(|item| !item.entries().is_empty())
            .for_each(|item| self.add(item));
    }

    /// Errors of keys: each (key, message). The place of a key that the file leaves out is the start of its section.
    pub fn errors(&self, wrong: impl IntoIterator<Item = (&'static str, String)>) -> CaseErrors {
        let errors = wrong.into_iter().map(|(key, message)| self.error(key, message)).collect();
        CaseErrors { file_name: self.file_name.clone(), errors }
    }

    fn error(&self, key: &str, message: String) -> CaseError {
        let message = shortened(&message);
        if let Some(error) = self.values.get(key) {
            return CaseError { message, ..error.clone() };
        }
        let section = key.rsplit_once('.').and_then(|(section, _)| self.values.get(section));
        let place = section.map_or(SourcePlace::File, |section| section.place.clone());
        CaseError { place, key: key.to_owned(), value: None, message }
    }
}
