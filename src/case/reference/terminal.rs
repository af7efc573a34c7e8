//! Description of keys in the terminal.

use super::super::schema::{CHAPTERS, Chapter};
use super::{Explained, Group, Owner, absence, allowed, explained, groups};
use crate::schema::text::nearest;
use std::fmt::Write;
use thiserror::Error;

/// The requested name is neither that of a section nor of a key of a section.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("there is no section or key {name:?}: {advice}")]
pub struct UnknownSection {
    /// The requested name.
    pub name: String,
    /// Suggestions of similar names.
    pub advice: String,
}

/// The keys of a section, with unit, range, default and meaning; of all sections if none is named. The section may be
/// followed by one of its keys, or a word that brings keys: `gas.drag`, `measure.stress`.
///
/// # Errors
/// If there is no such section, key or word.
pub fn terminal(section: Option<&str>) -> Result<String, UnknownSection> {
    let name = section.map(|name| name.trim_matches(['[', ']']).to_lowercase());
    let is_asked_for = |chapter: &&Chapter| match &name {
        None => true,
        Some(name) => name_of(chapter) == name,
    };
    let mut shown: Vec<String> = CHAPTERS
        .iter()
        .filter(is_asked_for)
        .map(|chapter| show(chapter, &groups(chapter)))
        .collect();
    let part = name.as_deref().filter(|_| shown.is_empty()).and_then(|name| name.rsplit_once('.'));
    if let Some((section, part)) = part {
        let chapters = CHAPTERS.iter().filter(|chapter| name_of(chapter) == section);
        shown = chapters.filter_map(|chapter| show_part(chapter, part)).collect();
    }
    match name {
        Some(name) if shown.is_empty() => {
            let names: Vec<String> = CHAPTERS.iter().flat_map(names_in).collect();
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let sections: Vec<&str> = CHAPTERS.iter().map(name_of).collect();
            let advice = match nearest(&name, &names) {
                Some(near) => format!("did you mean {near}?"),
                None => format!("there are {}", sections.join(", ")),
            };
            Err(UnknownSection { name, advice })
        }
        _ => Ok(shown.join("\n")),
    }
}

/// Path of a section; for the top level, its title in one word.
fn name_of(chapter: &Chapter) -> &str {
    match (chapter.path, chapter.title) {
        ("", "Schedules") => "schedules",
        ("", _) => "top",
        (path, _) => path,
    }
}

/// The name of a section, and those of its keys and of words that bring keys, prefixed by it.
fn names_in(chapter: &Chapter) -> Vec<String> {
    let section = name_of(chapter);
    let groups = groups(chapter);
    let keys = groups.iter().flat_map(|group| &group.keys);
    let parts = keys.flat_map(|(key, words)| words.iter().copied().chain([key.name]));
    let mut names = vec![section.to_owned()];
    names.extend(parts.map(|part| format!("{section}.{part}")));
    names
}

/// A key of a section, or the keys that a word brings; `None` if there are none.
fn show_part(chapter: &Chapter, part: &str) -> Option<String> {
    let mut groups = groups(chapter);
    // A group follows that of the key whose words bring it.
    let mut brought = Vec::new();
    for group in &mut groups {
        let belongs = match &group.of {
            Owner::Words { key, word } => brought.contains(key) || *word == Some(part),
            Owner::Tables(names) => {
                names.iter().any(|name| *name == part || brought.contains(name))
            }
            Owner::Section => false,
        };
        let by_word = |words: &[&str]| belongs || words.contains(&part);
        brought
            .extend(group.keys.iter().filter(|(_, words)| by_word(words)).map(|(key, _)| key.name));
        group.keys.retain(|(key, words)| key.name == part || by_word(words));
    }
    groups.retain(|group| !group.keys.is_empty());
    (!groups.is_empty()).then(|| show(chapter, &groups))
}

fn show(chapter: &Chapter, groups: &[Group]) -> String {
    let mut text = match chapter.path {
        "" => format!("{}\n", chapter.title),
        path => format!("[{path}]\n"),
    };
    if chapter.keys.is_empty() {
        let _ = writeln!(text, "  {}", chapter.before.replace('\n', "\n  "));
    }
    for (number, group) in groups.iter().enumerate() {
        show_group(&mut text, group);
        show_words(&mut text, &explained(groups, number));
    }
    text
}

fn show_group(text: &mut String, group: &Group) {
    let _ = match &group.of {
        Owner::Section => Ok(()),
        Owner::Words { key, word: None } => writeln!(text, "\n  Keys that depend on {key}:\n"),
        Owner::Words { key, word: Some(word) } => writeln!(text, "\n  With {key} = {word:?}:\n"),
        Owner::Tables(names) => writeln!(text, "\n  Inside the braces of {}:\n", names.join(", ")),
    };
    for (key, words) in &group.keys {
        let unit = if key.unit.is_empty() { String::new() } else { format!(" [{}]", key.unit) };
        let of = if words.is_empty() { String::new() } else { format!(" ({})", words.join(", ")) };
        let _ = writeln!(text, "  {}{unit}{of}", key.name);
        let _ = writeln!(text, "      {}.", key.meaning.replace('`', ""));
        let _ = writeln!(text, "      Allowed: {}.", allowed(&key.kind).replace('`', ""));
        let _ = match absence(key).as_str() {
            needed if needed.starts_with("required") || needed.starts_with("this or") => {
                writeln!(text, "      Needed: {}.", needed.replace('`', ""))
            }
            default => writeln!(text, "      Default: {}.", default.replace('`', "")),
        };
    }
}

fn show_words(text: &mut String, explained: &[Explained]) {
    for Explained { keys, choices } in explained {
        let _ = writeln!(text, "\n  Words of {}:", keys.join(", "));
        for word in choices.iter().filter(|word| !word.meaning.is_empty()) {
            let _ = writeln!(text, "      {:?}: {}", word.name, word.meaning.replace('`', ""));
        }
    }
}
