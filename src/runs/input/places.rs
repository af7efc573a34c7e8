//! Where the values of a file stand, for errors that are found after the file was read.

use super::errors::{InputError, InputErrors, SourcePlace};
use super::tree::Node;
use std::collections::BTreeMap;

/// Where each value stands. It is no part of what a file says: any two are equal.
#[derive(Clone, Debug, Default)]
pub struct Places {
    file_name: String,
    /// Errors without a message, by the path of their key.
    values: BTreeMap<String, InputError>,
}

impl PartialEq for Places {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Places {
    /// Finds the places of a file's values; members of lists of numbers are not distinguished.
    pub fn of(tree: &Node) -> Self {
        let mut places = Self::default();
        places.add(tree);
        places
    }

    /// Sets what errors call the file.
    pub fn set_file_name(&mut self, file_name: &str) {
        file_name.clone_into(&mut self.file_name);
    }

    fn add(&mut self, node: &Node) {
        let error = node.error("").shortened();
        self.values.insert(error.key.clone(), error);
        node.entries().iter().for_each(|(_, entry)| self.add(entry));
        node.items()
            .iter()
            .filter(|item| !item.entries().is_empty())
            .for_each(|item| self.add(item));
    }

    /// Errors of keys: each (key, message). A key that the file leaves out is looked for where its section begins.
    pub fn errors(&self, wrong: impl IntoIterator<Item = (&'static str, String)>) -> InputErrors {
        let errors = wrong.into_iter().map(|(key, message)| self.error(key, message)).collect();
        InputErrors { file_name: self.file_name.clone(), errors }
    }

    fn error(&self, key: &str, message: String) -> InputError {
        if let Some(error) = self.values.get(key) {
            return InputError { message, ..error.clone() }.shortened();
        }
        let section = key.rsplit_once('.').and_then(|(section, _)| self.values.get(section));
        let place = section.map_or(SourcePlace::File, |section| section.place.clone());
        InputError { place, key: key.to_owned(), value: None, message }.shortened()
    }
}
