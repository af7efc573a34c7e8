//! The manual of a kind of file.

use super::{Chapter, Explained, FileKeys, Group, Owner, absence, allowed, explained};
use std::fmt::Write;
use talcum_engine::schema::{Key, Kind, Required};

/// The manual, in Markdown.
pub(super) fn manual(file: &FileKeys) -> String {
    let mut text = file.head.to_owned();
    for chapter in file.chapters {
        let _ = write!(text, "\n{}\n", heading(file, chapter));
        add_paragraph(&mut text, chapter.before);
        let groups = file.groups(chapter);
        for (number, group) in groups.iter().enumerate() {
            add_group(&mut text, group);
            add_words(&mut text, &explained(&groups, number));
        }
        add_paragraph(&mut text, chapter.after);
    }
    text
}

fn add_paragraph(text: &mut String, paragraph: &str) {
    if !paragraph.is_empty() {
        let _ = write!(text, "\n{paragraph}\n");
    }
}

fn heading(file: &FileKeys, chapter: &Chapter) -> String {
    let Chapter { path, title, .. } = *chapter;
    if path.is_empty() {
        return format!("## {title}");
    }
    let level = "#".repeat(2 + path.matches('.').count());
    let key = file.declaration_of(path);
    let name = match key.map(|key| key.kind) {
        Some(Kind::Tables(_)) => format!("[[{path}]]"),
        Some(Kind::Named(_)) => format!("[{path}.NAME]"),
        _ => format!("[{path}]"),
    };
    let is_optional = key.is_some_and(|key| key.required == Required::Never);
    let optional = if is_optional { " (optional)" } else { "" };
    let title = if title.is_empty() { String::new() } else { format!(": {title}") };
    format!("{level} `{name}`{optional}{title}")
}

fn as_code(names: &[&str]) -> String {
    let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    names.join(", ")
}

fn add_group(text: &mut String, group: &Group) {
    let selector = match &group.of {
        Owner::Section => None,
        Owner::Words { key, word: None } => {
            let _ = write!(text, "\nKeys that depend on `{key}`:\n");
            Some(*key)
        }
        Owner::Words { key, word: Some(word) } => {
            let _ = write!(text, "\nWith `{key} = \"{word}\"`:\n");
            None
        }
        Owner::Tables(names) => {
            let _ = write!(text, "\nInside the braces of {}:\n", as_code(names));
            None
        }
    };
    add_keys(text, group, selector);
}

fn add_words(text: &mut String, explained: &[Explained]) {
    for Explained { keys, choices } in explained {
        let _ = write!(text, "\n{}:\n\n", as_code(keys));
        for word in choices.iter() {
            match word.meaning {
                "" => drop(writeln!(text, "* `\"{}\"`", word.name)),
                meaning => drop(writeln!(text, "* `\"{}\"`: {meaning}", word.name)),
            }
        }
    }
}

/// Rows of keys; neighbours that differ only in their names share one.
fn add_keys(text: &mut String, group: &Group, selector: Option<&str>) {
    let column = selector.map_or(String::new(), |key| format!(" of `{key}` |"));
    let _ = writeln!(text, "\n| key |{column} unit | meaning | allowed | default |");
    let rule = if selector.is_some() { " --- |" } else { "" };
    let _ = writeln!(text, "| --- |{rule} --- | --- | --- | --- |");
    let is_alike = |a: &Key, b: &Key| Key { name: a.name, ..*b } == *a;
    for alike in group.keys.chunk_by(|(a, _), (b, _)| is_alike(a, b)) {
        let names: Vec<&str> = alike.iter().map(|(key, _)| key.name).collect();
        let (key, words) = &alike[0];
        let words = selector.map_or(String::new(), |_| format!(" {} |", as_code(words)));
        let default = match absence(key).as_str() {
            "required" => String::new(),
            absence => quoted(absence),
        };
        let (names, allowed) = (as_code(&names), quoted(&allowed(&key.kind)));
        let row =
            format!("| {names} |{words} {} | {} | {allowed} | {default} |", key.unit, key.meaning);
        let _ = writeln!(text, "{}", row.replace("|  |", "| |"));
    }
}

/// Words in quotes become code.
fn quoted(text: &str) -> String {
    let parts: Vec<&str> = text.split('"').collect();
    let mut found = String::new();
    for (number, part) in parts.iter().enumerate() {
        match number % 2 {
            0 => found.push_str(part),
            _ => drop(write!(found, "`\"{part}\"`")),
        }
    }
    found.replace("``", "`")
}
