//! What a key of an input file is: its name, unit, kind of value, range, default, partners and meaning, as plain data.
//!
//! Tables of keys stand beside what they belong to: those of a section in `case/schema` or `study/schema`, those of a law
//! beside the law. Reading, `--set`, the merging of stages, error messages, the manual and the schema for editors all follow
//! from these tables, so no range and no default is written twice. This module knows nothing else of the crate.

mod allowed;
mod mixing;
mod schedule;
mod table;
mod values;

pub use allowed::Allowed;
pub use mixing::Mixing;
pub use schedule::{NOT_NEGATIVE_SCHEDULE, SIGNED_SCHEDULE};
pub use table::{ActiveKeys, declaration_of, displaced_by, every_key};
pub use values::KeyValues;

use std::fmt;

/// One key of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// As it is written in the file.
    pub name: &'static str,
    /// Unit of its numbers; empty if they have none.
    pub unit: &'static str,
    /// What its value may be.
    pub kind: Kind,
    /// Whether it must be given.
    pub required: Required,
    /// What stands for it if it is left out.
    pub default: Option<Fallback>,
    /// Keys of which only one can stand beside the others: each takes the place of this one. If this one is required,
    /// one of them is.
    pub partners: &'static [&'static str],
    /// The key that this one belongs to: it has no meaning without.
    pub with: Option<&'static str>,
    /// How the value for a pair of species follows from those of each.
    pub mixing: Mixing,
    /// Names that it had before, the oldest last. Who writes one of them is given the present one.
    pub former: &'static [&'static str],
    /// One sentence, without its full stop.
    pub meaning: &'static str,
}

/// What the value of a key may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A text that is not empty.
    Text,
    /// A span of wall-clock time such as `3h50m`.
    WallTime,
    /// True or false.
    Boolean,
    /// A number.
    Number(Allowed),
    /// A number that may change with time: itself, or a table of these keys.
    Schedule(Allowed, &'static [Key]),
    /// A whole number from the first to the second.
    Count(u64, u64),
    /// Three whole numbers, along x, y and z, each from the first to the second.
    Counts(u64, u64),
    /// Any number of whole numbers, at least one, each from the first to the second.
    CountList(u64, u64),
    /// So many numbers.
    Vector(Allowed, usize),
    /// Any number of lists of so many numbers, at least one.
    Vectors(Allowed, usize),
    /// Any number of numbers, at least one.
    List(Allowed),
    /// One of several words; each may bring keys of its own.
    Word(&'static [Word]),
    /// Any number of texts, at least one.
    Texts,
    /// Any number of these words, each once, at least one.
    Words(&'static [Word]),
    /// Any number of values of any kind, at least one.
    Values,
    /// Keys of a case by their paths, each with a value of any kind.
    Settings,
    /// A section, or a table in braces.
    Table(&'static [Key]),
    /// A list of sections.
    Tables(&'static [Key]),
    /// Sections of names that the user chooses.
    Named(&'static [Key]),
    /// A section whose keys later stages, or walls, may change: only what has been merged is complete.
    Merged(Merged),
    /// One of several kinds; what is written shows which.
    Either(&'static [Kind]),
}

/// A section that is merged from several places of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Merged {
    /// The section of which these are the keys.
    pub section: &'static str,
    /// Its keys.
    pub keys: &'static [Key],
    /// Whether `"off"` and `"on"` may stand in its place.
    pub switched: bool,
}

/// A word that may be chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Word {
    /// As it is written in the file.
    pub name: &'static str,
    /// What it stands for; empty if the name says it.
    pub meaning: &'static str,
    /// Keys that stand beside it in its section if it is chosen, and only then.
    pub keys: &'static [Key],
}

/// Whether a key must be given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Required {
    /// It must.
    Always,
    /// It may be left out.
    Never,
    /// It must be given under a condition that reaches beyond its section.
    When(&'static str),
    /// It must be given here or in the first stage.
    AtStart,
}

/// What stands for a key that is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fallback {
    /// The value.
    pub value: Value,
    /// For a default that touches physics: it is printed, with this reason, which may be empty.
    pub printed: Option<&'static str>,
}

/// A value that stands in a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A number.
    Number(f64),
    /// A whole number.
    Count(u64),
    /// A word.
    Word(&'static str),
    /// True or false.
    Boolean(bool),
    /// What the reader makes of it, in a few words.
    Derived(&'static str),
}

impl Word {
    /// A word that brings no keys.
    pub const fn new(name: &'static str, meaning: &'static str) -> Self {
        Self { name, meaning, keys: &[] }
    }

    /// A word that brings keys.
    pub const fn with(name: &'static str, meaning: &'static str, keys: &'static [Key]) -> Self {
        Self { name, meaning, keys }
    }
}

impl Key {
    /// A key that must be given.
    pub const fn new(name: &'static str, kind: Kind, meaning: &'static str) -> Self {
        Self {
            name,
            unit: "",
            kind,
            required: Required::Always,
            default: None,
            partners: &[],
            with: None,
            mixing: Mixing::None,
            former: &[],
            meaning,
        }
    }

    /// A number in a range.
    pub const fn number(name: &'static str, allowed: Allowed, meaning: &'static str) -> Self {
        Self::new(name, Kind::Number(allowed), meaning)
    }

    /// One of several words.
    pub const fn word(name: &'static str, words: &'static [Word], meaning: &'static str) -> Self {
        Self::new(name, Kind::Word(words), meaning)
    }

    /// The unit of its numbers.
    pub const fn unit(mut self, unit: &'static str) -> Self {
        self.unit = unit;
        self
    }

    /// Exactly one of it and its partners is given, or at most one if it is optional.
    pub const fn or(mut self, partners: &'static [&'static str]) -> Self {
        self.partners = partners;
        self
    }

    /// It belongs to another key.
    pub const fn with(mut self, key: &'static str) -> Self {
        self.with = Some(key);
        self
    }

    /// How the value for a pair of species follows from those of each.
    pub const fn mixed(mut self, rule: Mixing) -> Self {
        self.mixing = rule;
        self
    }

    /// Names that it had before, the oldest last.
    pub const fn formerly(mut self, names: &'static [&'static str]) -> Self {
        self.former = names;
        self
    }

    /// It may be left out.
    pub const fn optional(mut self) -> Self {
        self.required = Required::Never;
        self
    }

    /// It may be left out, and what that means in a few words.
    pub const fn optionally(self, meaning: &'static str) -> Self {
        self.default(Value::Derived(meaning))
    }

    /// It must be given under a condition that reaches beyond its section.
    pub const fn required_when(mut self, condition: &'static str) -> Self {
        self.required = Required::When(condition);
        self
    }

    /// It must be given here or in the first stage.
    pub const fn required_at_start(mut self) -> Self {
        self.required = Required::AtStart;
        self
    }

    /// It may be left out, and what then stands for it.
    pub const fn default(mut self, value: Value) -> Self {
        self.default = Some(Fallback { value, printed: None });
        self.optional()
    }

    /// It may be left out; what then stands for it is printed, with a reason.
    pub const fn printed(mut self, value: Value, reason: &'static str) -> Self {
        self.default = Some(Fallback { value, printed: Some(reason) });
        self.optional()
    }
}

impl Kind {
    /// The words that may be chosen; none if it is no choice.
    pub fn words(&self) -> &'static [Word] {
        match self {
            Self::Word(words) => words,
            Self::Either(kinds) => {
                kinds.iter().map(Self::words).find(|words| !words.is_empty()).unwrap_or_default()
            }
            _ => &[],
        }
    }

    /// The keys of the table that may stand here; none if none may. Those of a schedule too.
    pub fn keys(&self) -> &'static [Key] {
        match self {
            Self::Table(keys)
            | Self::Tables(keys)
            | Self::Named(keys)
            | Self::Schedule(_, keys) => keys,
            Self::Merged(merged) => merged.keys,
            Self::Either(kinds) => {
                kinds.iter().map(Self::keys).find(|keys| !keys.is_empty()).unwrap_or_default()
            }
            _ => &[],
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => formatter.write_str(&allowed::short(*number)),
            Self::Count(count) => write!(formatter, "{count}"),
            Self::Word(word) => write!(formatter, "{word:?}"),
            Self::Boolean(truth) => write!(formatter, "{truth}"),
            Self::Derived(text) => write!(formatter, "{text}"),
        }
    }
}
