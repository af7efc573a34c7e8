//! A section that is checked against its table of keys when it is opened, and then read key by key.

use super::allowed_values::{check, description, words_of};
use super::errors::{InputError, Problems};
use super::suggestion::advice;
use super::tree::{Node, Value};
use super::wall_time;
use std::time::Duration;
use talcum_engine::schema::{self, ActiveKeys, Key, KeyValues, Kind, Required};

/// An open section. What is wrong with it has been reported: whatever is missing or wrong reads as `None`.
pub struct Section<'a> {
    /// What the file says.
    pub node: &'a Node,
    /// Where errors go.
    pub problems: &'a Problems,
    keys: ActiveKeys,
}

/// Contents of a section that the file leaves out.
static NOTHING: Node = Node::EMPTY;

impl<'a> Section<'a> {
    /// Checks a node and all below against a table, and opens it.
    pub fn open(node: &'a Node, keys: &'static [Key], problems: &'a Problems) -> Option<Self> {
        if let Err(message) = check(&Kind::Table(keys), node) {
            problems.add(node.error(message));
            return None;
        }
        let keys = ActiveKeys::of(keys, &|key| node.get(key).and_then(Node::as_text));
        let section = Self { node, problems, keys };
        section.check_entries();
        section.check_presence();
        Some(section)
    }

    /// Checks values, and keys that are unknown or not used by a chosen word.
    fn check_entries(&self) {
        for (name, node) in self.node.entries() {
            if let Some(key) = self.keys.active.iter().find(|key| key.name == name) {
                self.check_value(key, node);
                continue;
            }
            let inactive = self.keys.inactive.iter().filter(|(key, _)| key.name == name);
            let (mut open, mut refused) = (None, None);
            for (key, chosen) in inactive {
                match chosen {
                    Some(chosen) => refused = Some(chosen),
                    None => open = Some(key),
                }
            }
            match (open, refused) {
                // It may be correct once the word that decides is correct.
                (Some(key), _) => self.check_value(key, node),
                (None, Some(chosen)) => self.problems.add(node.error(format!(
                    "cannot be given: {} {:?} has no use for it",
                    chosen.key, chosen.word
                ))),
                (None, None) => self.problems.add(node.error(self.unknown(name))),
            }
        }
    }

    fn check_value(&self, key: &'static Key, node: &'a Node) {
        let kind = &key.kind;
        if let Err(message) = check(kind, node) {
            // The meaning of a list is more helpful than its length.
            let is_shape =
                matches!(kind, Kind::Vector(..)) && message.starts_with("must be a list");
            let meaning = if is_shape { format!(" ({})", key.meaning) } else { String::new() };
            self.problems.add(node.error(message + &meaning));
        } else if !matches!(kind, Kind::Merged(_) | Kind::Settings) {
            let tables: Vec<&Node> = match &node.value {
                Value::Table(named) if matches!(kind, Kind::Named(_)) => {
                    named.iter().map(|(_, table)| table).collect()
                }
                Value::Table(_) => vec![node],
                _ if matches!(kind, Kind::Tables(_)) => node.items().iter().collect(),
                _ => Vec::new(),
            };
            for table in tables {
                Self::open(table, kind.keys(), self.problems);
            }
        }
    }

    fn unknown(&self, name: &str) -> String {
        let open = self.keys.inactive.iter().filter(|(_, chosen)| chosen.is_none());
        let keys = self.keys.active.iter().copied().chain(open.map(|(key, _)| *key));
        let mut known: Vec<&str> = keys.map(|key| key.name).collect();
        known.sort_unstable();
        known.dedup();
        format!("unknown key: {}", advice(name, &known))
    }

    /// Checks for keys that are missing, that exclude each other, or that belong to another one.
    fn check_presence(&self) {
        for key in &self.keys.active {
            if self.has(key.name) {
                self.check_companions(key);
            } else if key.required == Required::Always {
                self.check_missing(key);
            } else if key.required == Required::Never && !self.has_any(key.partners) {
                self.note_default(key.name);
            }
        }
    }

    fn check_companions(&self, key: &Key) {
        let place = |name: &str| self.node.get(name).map(|node| &node.place);
        let rank = |name: &str| self.keys.active.iter().position(|other| other.name == name);
        let order = |name: &str| (place(name), rank(name));
        let first =
            key.partners.iter().filter(|name| self.has(name)).min_by_key(|name| order(name));
        if let Some(first) = first.filter(|first| order(first) < order(key.name)) {
            self.fail(key.name, format!("cannot be given together with {first}: give one only"));
        }
        let owner =
            key.with.filter(|owner| !self.has(owner)).and_then(|owner| self.keys.find(owner));
        // An owner that is missing itself has been reported.
        if let Some(owner) = owner
            && (owner.required != Required::Always || self.has_any(owner.partners))
        {
            self.fail(key.name, format!("cannot be given without {}", owner.name));
        }
    }

    fn check_missing(&self, key: &Key) {
        let is_reported =
            |other: &&Key| other.partners.contains(&key.name) && !self.has_any(other.partners);
        let mut before = self.keys.active.iter().take_while(|other| other.name != key.name);
        let is_free = key.with.is_none_or(|owner| self.has(owner));
        if is_free && !self.has_any(key.partners) && !before.any(is_reported) {
            self.require(key.name);
        }
    }

    /// Reports that a key is missing unless it or a partner is given, for example because the condition holds under
    /// which its table requires it.
    pub fn require(&self, name: &'static str) {
        let Some(key) = self.key(name) else { return };
        if self.has(name) || self.has_any(key.partners) {
            return;
        }
        let excluded = |partner: &str| {
            let given = self.keys.active.iter().filter(|key| self.has(key.name));
            given.flat_map(|key| key.partners).any(|other| *other == partner)
        };
        let has_no_use = |partner: &str| {
            let mut inactive = self.keys.inactive.iter();
            inactive.any(|(key, chosen)| key.name == partner && chosen.is_some())
        };
        let partners = key.partners.iter().copied();
        let partners = partners.filter(|partner| !excluded(partner) && !has_no_use(partner));
        let choices: Vec<&str> = std::iter::once(name).chain(partners).collect();
        let reason = match key.required {
            Required::When(condition) => format!(", since {}", condition.replace('`', "")),
            _ => String::new(),
        };
        self.fail(
            name,
            match key.kind {
                _ if choices.len() > 1 => format!("missing: give {}", choices.join(" or ")),
                Kind::Table(_) | Kind::Merged(_) => {
                    format!("missing: must be a section [{}]", self.path_of(name))
                }
                Kind::Text => {
                    let meaning = key.meaning.replace('`', "");
                    format!("missing: must be a text in quotes{reason} ({meaning})")
                }
                kind => format!("missing: must be {}{reason}", description(&kind)),
            },
        );
    }

    /// Notes what stands for a key that is left out, if its table says that this is printed.
    pub fn note_default(&self, name: &'static str) {
        let default = self.key(name).filter(|_| !self.has(name)).and_then(|key| key.default);
        if let Some(schema::Fallback { value, printed: Some(reason) }) = default {
            let reason = if reason.is_empty() { String::new() } else { format!(", {reason}") };
            self.problems.note(format!("{} is not given: {value}{reason}", self.path_of(name)));
        }
    }

    /// Reports an error of a key, at its line or, if it is left out, at that of the section.
    pub fn fail(&self, name: &str, message: impl Into<String>) {
        let error = match self.node.get(name) {
            Some(node) => node.error(message),
            None => InputError {
                place: self.node.place.clone(),
                key: self.path_of(name),
                value: None,
                message: message.into(),
            },
        };
        self.problems.add(error);
    }

    /// Path of a key of this section.
    pub fn path_of(&self, name: &str) -> String {
        match self.node.path.as_str() {
            "" => name.to_owned(),
            path => format!("{path}.{name}"),
        }
    }

    /// Whether a key is given.
    pub fn has(&self, name: &str) -> bool {
        self.node.get(name).is_some()
    }

    fn has_any(&self, names: &[&str]) -> bool {
        names.iter().any(|name| self.has(name))
    }

    /// Which one of several keys is given; `None` if more than one are, or none is.
    pub fn given(&self, names: &[&'static str]) -> Option<&'static str> {
        let mut given = names.iter().copied().filter(|name| self.has(name));
        let first = given.next();
        first.filter(|_| given.next().is_none())
    }

    fn key(&self, name: &str) -> Option<&'static Key> {
        let key = self.keys.find(name);
        debug_assert!(key.is_some(), "{} is in no table", self.path_of(name));
        key
    }

    /// The value of a key, if it is what the table allows.
    pub fn right(&self, name: &str) -> Option<&'a Node> {
        let (key, node) = (self.key(name)?, self.node.get(name)?);
        check(&key.kind, node).is_ok().then_some(node)
    }

    /// Default of a key that is left out.
    fn default(&self, name: &str) -> Option<schema::Value> {
        let key = self.key(name).filter(|_| !self.has(name))?;
        key.default.map(|default| default.value)
    }

    /// A number, or its default.
    pub fn number(&self, name: &str) -> Option<f64> {
        match self.default(name) {
            Some(schema::Value::Number(number)) => Some(number),
            _ => self.right(name)?.as_number(),
        }
    }

    /// A whole number, or its default.
    pub fn count(&self, name: &str) -> Option<u64> {
        match self.default(name) {
            Some(schema::Value::Count(count)) => Some(count),
            _ => self.right(name)?.as_count(),
        }
    }

    /// True or false, or its default.
    pub fn boolean(&self, name: &str) -> Option<bool> {
        match self.default(name) {
            Some(schema::Value::Boolean(truth)) => Some(truth),
            _ => self.right(name)?.as_boolean(),
        }
    }

    /// A chosen word, or its default.
    pub fn word(&self, name: &str) -> Option<&'a str> {
        match self.default(name) {
            Some(schema::Value::Word(word)) => Some(word),
            _ => self.right(name)?.as_text(),
        }
    }

    /// What a chosen word stands for.
    pub fn choice<T: Clone>(&self, name: &str, meanings: &[(&str, T)]) -> Option<T> {
        let word = self.word(name)?;
        let meaning = meanings.iter().find(|(meant, _)| *meant == word);
        if meaning.is_none() {
            self.fail(
                name,
                format!("{word} is in the table of keys, but this version cannot read it"),
            );
        }
        meaning.map(|(_, meaning)| meaning.clone())
    }

    /// What the words of a list stand for.
    pub fn choices<T: Copy>(&self, name: &str, meanings: &[(&str, T)]) -> Option<Vec<T>> {
        let words = words_of(self.right(name)?)?;
        let meaning = |word: &String| meanings.iter().find(|(meant, _)| meant == word);
        words.iter().map(|word| meaning(word).map(|(_, meaning)| *meaning)).collect()
    }

    /// A text.
    pub fn text(&self, name: &str) -> Option<String> {
        let text = self.right(name)?.as_text()?;
        if text.chars().any(char::is_control) {
            self.fail(name, "must not contain control characters".to_owned());
            return None;
        }
        Some(text.to_owned())
    }

    /// The texts of a list.
    pub fn texts(&self, name: &str) -> Option<Vec<String>> {
        words_of(self.right(name)?)
    }

    /// A span of wall-clock time.
    pub fn wall_time(&self, name: &str) -> Option<Duration> {
        self.right(name)?.as_text().and_then(wall_time::parse)
    }

    /// A list of numbers.
    pub fn numbers(&self, name: &str) -> Option<Vec<f64>> {
        self.right(name)?.as_list(Node::as_number)
    }

    /// So many numbers.
    pub fn vector<const N: usize>(&self, name: &str) -> Option<[f64; N]> {
        self.numbers(name)?.try_into().ok()
    }

    /// Whole numbers along x, y and z.
    pub fn counts(&self, name: &str) -> Option<[usize; 3]> {
        let counts = self.right(name)?.as_list(Node::as_count)?;
        let [x, y, z] = counts.as_slice().try_into().ok()?;
        Some([x, y, z].map(|count: u64| count as usize))
    }

    /// A table, or a section; `None` if something else is written.
    pub fn table(&self, name: &str) -> Option<Section<'a>> {
        let node = self.right(name).filter(|node| matches!(node.value, Value::Table(_)))?;
        Self::open(node, self.key(name)?.kind.keys(), self.problems)
    }

    /// A section that may be left out: then all its keys have their defaults.
    pub fn table_or_defaults(&self, name: &str) -> Option<Section<'a>> {
        if self.has(name) {
            self.table(name)
        } else {
            Self::open(&NOTHING, self.key(name)?.kind.keys(), self.problems)
        }
    }

    /// The sections of names that the user chose, each with its name.
    pub fn named(&self, name: &str) -> Vec<(&'a str, Section<'a>)> {
        let Some((node, key)) = self.right(name).zip(self.key(name)) else { return Vec::new() };
        let open = |(name, table): &'a (String, Node)| {
            Some((name.as_str(), Self::open(table, key.kind.keys(), self.problems)?))
        };
        node.entries().iter().filter_map(open).collect()
    }

    /// The sections of a list.
    pub fn tables(&self, name: &str) -> Vec<Section<'a>> {
        let Some((node, key)) = self.right(name).zip(self.key(name)) else { return Vec::new() };
        let open = |item| Self::open(item, key.kind.keys(), self.problems);
        node.items().iter().filter_map(open).collect()
    }
}

impl KeyValues for Section<'_> {
    fn number(&self, key: &str) -> Option<f64> {
        Section::number(self, key)
    }

    fn word(&self, key: &str) -> Option<&str> {
        Section::word(self, key)
    }

    fn is_given(&self, key: &str) -> bool {
        self.has(key)
    }
}
