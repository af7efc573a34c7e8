//! Queries about a table of keys as a whole.

use super::{Key, Value};

/// The keys of a table, and those brought by the words chosen in it.
#[derive(Debug, Default)]
pub struct ActiveKeys {
    /// Keys that are allowed in the table.
    pub active: Vec<&'static Key>,
    /// Keys of words that are not chosen, with the chosen word and its key; without these if the word is missing or
    /// wrong.
    pub inactive: Vec<(&'static Key, Option<Chosen>)>,
}

/// A word chosen in a table.
#[derive(Clone, Copy, Debug)]
pub struct Chosen {
    /// The key that has the word.
    pub key: &'static str,
    /// The word.
    pub word: &'static str,
}

impl ActiveKeys {
    /// The keys of a table; `word_of` gives the word of a key, if it has one.
    pub fn of<'a>(
        keys: &'static [Key],
        word_of: &impl Fn(&'static str) -> Option<&'a str>,
    ) -> Self {
        let mut found = Self::default();
        found.add(keys, word_of);
        let Self { active, inactive } = &mut found;
        inactive.retain(|(key, _)| active.iter().all(|other| other.name != key.name));
        found
    }

    /// The declaration of a key: the active one, or else any other.
    pub fn find(&self, name: &str) -> Option<&'static Key> {
        let inactive = self.inactive.iter().map(|(key, _)| *key);
        self.active.iter().copied().chain(inactive).find(|key| key.name == name)
    }

    fn add<'a>(
        &mut self,
        keys: &'static [Key],
        word_of: &impl Fn(&'static str) -> Option<&'a str>,
    ) {
        for key in keys {
            // The first declaration counts; that of the chosen word comes first.
            if self.active.iter().any(|known| known.name == key.name) {
                continue;
            }
            self.active.push(key);
            let default = match key.default.map(|default| default.value) {
                Some(Value::Word(word)) => Some(word),
                _ => None,
            };
            let given = word_of(key.name).or(default);
            let chosen = key.kind.words().iter().find(|word| Some(word.name) == given);
            for word in key.kind.words() {
                match chosen {
                    Some(chosen) if chosen.name == word.name => self.add(word.keys, word_of),
                    _ => {
                        let chosen = chosen.map(|word| Chosen { key: key.name, word: word.name });
                        self.inactive
                            .extend(every_key(word.keys).into_iter().map(|key| (key, chosen)));
                    }
                }
            }
        }
    }
}

/// All declarations in a table, with those of all words that may be chosen in it.
pub fn every_key(keys: &'static [Key]) -> Vec<&'static Key> {
    let mut found = Vec::new();
    for key in keys {
        found.push(key);
        found.extend(key.kind.words().iter().flat_map(|word| every_key(word.keys)));
    }
    found
}

/// The declaration of the key with a name or, if there is none, with this former name. If a name has several
/// declarations, it is the one with keys of its own.
pub fn declaration_of(keys: &'static [Key], name: &str) -> Option<&'static Key> {
    let all = every_key(keys);
    let had_before = || all.iter().find(|key| key.former.contains(&name));
    let present = all.iter().find(|key| key.name == name).or_else(had_before)?.name;
    let mut declared = all.iter().copied().filter(|key| key.name == present);
    let has_keys = |key: &&Key| !key.kind.keys().is_empty();
    declared.clone().find(has_keys).or_else(|| declared.next())
}

/// Names of the keys that a key replaces when it is set: its partners, and its former names.
pub fn displaced_by(keys: &'static [Key], name: &str) -> Vec<&'static str> {
    let declared = every_key(keys).into_iter().filter(|key| key.name == name);
    declared.flat_map(|key| key.partners.iter().chain(key.former).copied()).collect()
}
