//! Keys as the terminal shows them.

use super::super::schema::{CHAPTERS, Chapter};
use super::super::suggestion::nearest;
use super::{Explained, Group, Owner, absence, allowed, explained, groups};
use std::fmt::Write;
use thiserror::Error;

/// No section, and no key of a section, has the name that was asked for.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("there is no section {name:?}: {advice}")]
pub struct UnknownSection {
    /// What was asked for.
    pub name: String,
    /// What may have been meant.
    pub advice: String,
}

/// The keys of a section, with unit, range, default and meaning; of all sections if none is named.
///
/// # Errors
/// If there is no such section.
pub fn terminal(section: Option<&str>) -> Result<String, UnknownSection> {
    let name = section.map(|name| name.trim_matches(['[', ']']).to_lowercase());
    let is_asked_for = |chapter: &&Chapter| match &name {
        None => true,
        Some(name) => name_of(chapter) == name,
    };
    let shown: Vec<String> = CHAPTERS.iter().filter(is_asked_for).map(show).collect();
    match name {
        Some(name) if shown.is_empty() => {
            let names: Vec<&str> = CHAPTERS.iter().map(name_of).collect();
            let advice = match nearest(&name, &names) {
                Some(near) => format!("did you mean {near}?"),
                None => format!("there are {}", names.join(", ")),
            };
            Err(UnknownSection { name, advice })
        }
        _ => Ok(shown.join("\n")),
    }
}

/// Path of a section; of what is none, its title in one word.
fn name_of(chapter: &Chapter) -> &str {
    match (chapter.path, chapter.title) {
        ("", "Schedules") => "schedules",
        ("", _) => "top",
        (path, _) => path,
    }
}

fn show(chapter: &Chapter) -> String {
    let mut text = match chapter.path {
        "" => format!("{}\n", chapter.title),
        path => format!("[{path}]\n"),
    };
    if chapter.keys.is_empty() {
        let _ = writeln!(text, "  {}", chapter.before.replace('\n', "\n  "));
    }
    let groups = groups(chapter);
    for (number, group) in groups.iter().enumerate() {
        show_group(&mut text, group);
        show_words(&mut text, &explained(&groups, number));
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
