//! Description of keys in the terminal.

use super::super::suggestion::nearest;
use super::{Chapter, Explained, FileKeys, Group, Owner, absence, allowed, explained};
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

/// What [`FileKeys::terminal`] gives.
pub(super) fn terminal(file: &FileKeys, section: Option<&str>) -> Result<String, UnknownSection> {
    let name = section.map(|name| name.trim_matches(['[', ']']).to_lowercase());
    let is_asked_for = |chapter: &&Chapter| match &name {
        None => true,
        Some(name) => name_of(chapter) == name,
    };
    let chapters = file.chapters.iter();
    let asked_for = chapters.clone().filter(is_asked_for);
    let mut shown: Vec<String> =
        asked_for.map(|chapter| show(chapter, &file.groups(chapter))).collect();
    let part = name.as_deref().filter(|_| shown.is_empty()).and_then(|name| name.rsplit_once('.'));
    if let Some((section, part)) = part {
        let of_section = chapters.clone().filter(|chapter| name_of(chapter) == section);
        let groups = of_section.map(|chapter| (chapter, file.groups(chapter)));
        shown = groups.filter_map(|(chapter, groups)| show_part(chapter, groups, part)).collect();
    }
    match name {
        Some(name) if shown.is_empty() => {
            let names =
                chapters.clone().flat_map(|chapter| names_in(chapter, &file.groups(chapter)));
            let names: Vec<String> = names.collect();
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let sections: Vec<&str> = chapters.map(name_of).collect();
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

/// A section, and its keys and the words that bring keys behind it.
fn names_in(chapter: &Chapter, groups: &[Group]) -> Vec<String> {
    let section = name_of(chapter);
    let keys = groups.iter().flat_map(|group| &group.keys);
    let parts = keys.flat_map(|(key, words)| words.iter().copied().chain([key.name]));
    let mut names = vec![section.to_owned()];
    names.extend(parts.map(|part| format!("{section}.{part}")));
    names
}

/// A key of a section, or the keys that a word brings; none if there are none.
fn show_part(chapter: &Chapter, mut groups: Vec<Group>, part: &str) -> Option<String> {
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
