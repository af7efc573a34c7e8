//! Questions about a table of keys as a whole.

use super::{Key, Value};

/// The keys of a table, and those that the words chosen in it bring.
#[derive(Debug, Default)]
pub struct ActiveKeys {
    /// Keys that may stand in the table.
    pub active: Vec<&'static Key>,
    /// Keys of words that are not chosen, with the key and the word that are; without if that word is missing or wrong.
    pub inactive: Vec<(&'static Key, Option<Chosen>)>,
}

/// A word that a table chooses.
#[derive(Clone, Copy, Debug)]
pub struct Chosen {
    /// The key that chooses.
    pub key: &'static str,
    /// The word.
    pub word: &'static str,
}

impl ActiveKeys {
    /// The keys of a table in which `word_of` says which word a key has, if it has one.
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

    /// The declaration of a key: the active one, or else any.
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
            // The first declaration counts, that of what is chosen first.
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

/// Every declaration that a table holds, with those of all words that may be chosen in it.
pub fn every_key(keys: &'static [Key]) -> Vec<&'static Key> {
    let mut found = Vec::new();
    for key in keys {
        found.push(key);
        found.extend(key.kind.words().iter().flat_map(|word| every_key(word.keys)));
    }
    found
}

/// The declaration of a name that a key of the table has, or had before if none has it now. Of several declarations of one name
/// it is the one with keys of its own.
pub fn declaration_of(keys: &'static [Key], name: &str) -> Option<&'static Key> {
    let all = every_key(keys);
    let had_before = || all.iter().find(|key| key.former.contains(&name));
    let present = all.iter().find(|key| key.name == name).or_else(had_before)?.name;
    let mut declared = all.iter().copied().filter(|key| key.name == present);
    let has_keys = |key: &&Key| !key.kind.keys().is_empty();
    declared.clone().find(has_keys).or_else(|| declared.next())
}

/// Names of the keys of which a key takes the place when it is set: its partners, and those that it had before.
pub fn displaced_by(keys: &'static [Key], name: &str) -> Vec<&'static str> {
    let declared = every_key(keys).into_iter().filter(|key| key.name == name);
    declared.flat_map(|key| key.partners.iter().chain(key.former).copied()).collect()
}
