//! Documentation of the tables of the case file, for people and for editors: the manual, a list in the terminal, a JSON
//! schema.

mod json;
mod markdown;
mod terminal;

pub use json::json_schema;
pub use markdown::manual;
pub use terminal::{UnknownSection, terminal};

use super::allowed_values::description;
use super::schema::{CHAPTERS, Chapter};
use crate::schema::{Allowed, Key, Kind, Required, Word};

/// The allowed values of a key, without its default.
fn allowed(kind: &Kind) -> String {
    match kind {
        Kind::Table(_) => "a table, see below".to_owned(),
        Kind::Either(kinds) => {
            let all: Vec<String> = kinds.iter().map(allowed).collect();
            all.join(" or ")
        }
        Kind::Number(allowed) | Kind::Schedule(allowed, _) => {
            let numbers = if *allowed == Allowed::FINITE {
                "a number".to_owned()
            } else {
                allowed.to_string()
            };
            match kind {
                Kind::Schedule(..) => format!("{numbers}; or a schedule"),
                _ => numbers,
            }
        }
        _ => description(kind),
    }
}

/// Effect of leaving out a key.
fn absence(key: &Key) -> String {
    let default = key.default.map(|default| match default.printed {
        Some(_) => format!("{} (printed)", default.value),
        None => default.value.to_string(),
    });
    let companion = key.with.map(|owner| format!("required with `{owner}`"));
    let partners: Vec<String> = key.partners.iter().map(|name| format!("`{name}`")).collect();
    let instead = (!partners.is_empty()).then(|| format!("this or {}", partners.join(" or ")));
    let needed = match key.required {
        Required::Always => companion.or(instead).unwrap_or("required".to_owned()),
        Required::AtStart => "required here or in the first stage".to_owned(),
        Required::When(condition) => {
            let instead = instead.map_or(String::new(), |instead| format!("{instead}; "));
            let needed = format!("{instead}required when {condition}");
            return match default {
                Some(default) => format!("{default}; {needed}"),
                None => needed,
            };
        }
        Required::Never if default.is_none() => match instead {
            Some(_) => format!("none; not together with {}", partners.join(" or ")),
            None => "none".to_owned(),
        },
        Required::Never => String::new(),
    };
    default.unwrap_or(needed)
}

/// Whether a key of a section is a section with its own chapter in the manual.
fn has_chapter(section: &str, key: &Key) -> bool {
    let path =
        if section.is_empty() { key.name.to_owned() } else { format!("{section}.{}", key.name) };
    CHAPTERS.iter().any(|chapter| !chapter.path.is_empty() && chapter.path == path)
}

/// A table of keys: those of a section itself, those brought by one of its words, or those of a table in braces.
struct Group {
    /// Owner of the keys.
    of: Owner,
    /// Each key with the words that bring it; without words if all of the group do.
    keys: Vec<(&'static Key, Vec<&'static str>)>,
}

/// Owner of a group of keys.
enum Owner {
    Section,
    /// One word, or several words that share keys, of a key.
    Words {
        key: &'static str,
        word: Option<&'static str>,
    },
    /// Tables that are values of these keys.
    Tables(Vec<&'static str>),
}

/// The tables of keys of a section, in the order in which they are printed.
fn groups(chapter: &Chapter) -> Vec<Group> {
    let mut found = Vec::new();
    let own = chapter.keys.iter().filter(|key| !has_chapter(chapter.path, key));
    let own: Vec<_> = own.map(|key| (key, Vec::new())).collect();
    if !own.is_empty() {
        add_groups(chapter, Owner::Section, own, &mut found);
    }
    found
}

fn add_groups(
    chapter: &Chapter,
    of: Owner,
    keys: Vec<(&'static Key, Vec<&'static str>)>,
    found: &mut Vec<Group>,
) {
    let declared: Vec<&'static Key> = keys.iter().map(|(key, _)| *key).collect();
    found.push(Group { of, keys });
    for key in &declared {
        add_words(chapter, key, found);
    }
    let mut tables: Vec<(&'static [Key], Vec<&'static str>)> = Vec::new();
    for key in declared {
        let inner = match key.kind {
            Kind::Table(keys) => keys,
            Kind::Either(_) => key.kind.keys(),
            _ => continue,
        };
        match tables.iter_mut().find(|(keys, _)| *keys == inner) {
            Some((_, names)) => names.push(key.name),
            None if !inner.is_empty() => tables.push((inner, vec![key.name])),
            None => {}
        }
    }
    for (keys, names) in tables {
        let known =
            found.iter().any(|group| matches!(&group.of, Owner::Tables(of) if *of == names));
        if !known {
            let keys = keys.iter().map(|key| (key, Vec::new())).collect();
            add_groups(chapter, Owner::Tables(names), keys, found);
        }
    }
}

/// Adds the keys brought by the words of a key: together if words share keys, otherwise word by word.
fn add_words(chapter: &Chapter, key: &'static Key, found: &mut Vec<Group>) {
    let choices = key.kind.words();
    let mut shared: Vec<(&'static Key, Vec<&'static str>)> = Vec::new();
    for word in choices {
        for inner in word.keys {
            match shared.iter_mut().find(|(known, _)| *known == inner) {
                Some((_, names)) => names.push(word.name),
                None => shared.push((inner, vec![word.name])),
            }
        }
    }
    if shared.iter().any(|(_, names)| names.len() > 1) {
        add_groups(chapter, Owner::Words { key: key.name, word: None }, shared, found);
        return;
    }
    for word in choices.iter().filter(|word| !word.keys.is_empty()) {
        let of = Owner::Words { key: key.name, word: Some(word.name) };
        let keys = word.keys.iter().map(|key| (key, Vec::new())).collect();
        add_groups(chapter, of, keys, found);
    }
}

/// Words to explain, and the keys that have them.
struct Explained {
    keys: Vec<&'static str>,
    choices: &'static [Word],
}

/// The words of a group whose meaning is to be explained, except for those explained by earlier groups.
fn explained(groups: &[Group], number: usize) -> Vec<Explained> {
    let words_of =
        |group: &Group| group.keys.iter().map(|(key, _)| key.kind.words()).collect::<Vec<_>>();
    let shown: Vec<&[Word]> = groups[..number].iter().flat_map(words_of).collect();
    let mut found: Vec<Explained> = Vec::new();
    for (key, _) in &groups[number].keys {
        let words = key.kind.words();
        if words.iter().all(|word| word.meaning.is_empty()) || shown.contains(&words) {
            continue;
        }
        match found.iter_mut().find(|known| known.choices == words) {
            Some(known) if known.keys.contains(&key.name) => {}
            Some(known) => known.keys.push(key.name),
            None => found.push(Explained { keys: vec![key.name], choices: words }),
        }
    }
    found
}
