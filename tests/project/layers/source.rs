//! Rust sources as used for the layers: the paths into the crate that a file names.

use std::fs;
use std::path::{Path, PathBuf};

/// The folder of the sources.
fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// Every file of the sources, as (path below `src`, code without comments, texts and items for tests).
pub(crate) fn all_files() -> Vec<(String, String)> {
    let (source, mut found) = (source(), Vec::new());
    for path in files_of(&source) {
        let file = path.strip_prefix(&source).unwrap().to_str().unwrap().to_owned();
        found.push((file, code_of(&fs::read_to_string(&path).unwrap())));
    }
    found.sort();
    found
}

fn files_of(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("the sources can be read") {
        let path = entry.expect("the sources can be read").path();
        if path.is_dir() {
            found.extend(files_of(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found
}

/// What is left of a file without comments, texts and items for tests.
pub(crate) fn code_of(text: &str) -> String {
    without_test_items(&without_comments_and_texts(text))
}

fn without_comments_and_texts(text: &str) -> String {
    let characters: Vec<char> = text.chars().collect();
    let mut code = String::new();
    let mut at = 0;
    while at < characters.len() {
        let rest = &characters[at..];
        at += match rest {
            ['/', '/', ..] => until(rest, 2, &['\n']) - 1,
            ['/', '*', ..] => until(rest, 2, &['*', '/']),
            ['r', '"', ..] => until(rest, 2, &['"']),
            ['r', '#', '"', ..] => until(rest, 3, &['"', '#']),
            ['"', ..] => length_of_text(rest),
            ['\'', '\\', _, '\'', ..] => 4,
            ['\'', _, '\'', ..] => 3,
            _ => {
                code.push(rest[0]);
                1
            }
        };
    }
    code
}

/// Characters up to and including the first `end` from place `from` on, or all.
fn until(characters: &[char], from: usize, end: &[char]) -> usize {
    let found = characters[from..].windows(end.len()).position(|window| window == end);
    found.map_or(characters.len() + 1, |place| from + place + end.len()).min(characters.len() + 1)
}

fn length_of_text(characters: &[char]) -> usize {
    let mut at = 1;
    while at < characters.len() && characters[at] != '"' {
        at += if characters[at] == '\\' { 2 } else { 1 };
    }
    at + 1
}

/// Drops what follows `#[cfg(test)]`: up to a semicolon, or to the end of its braces.
fn without_test_items(code: &str) -> String {
    let Some((before, after)) = code.split_once("#[cfg(test)]") else { return code.to_owned() };
    let mut depth = 0;
    let end = after.char_indices().find_map(|(place, character)| {
        match character {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        (depth == 0 && (character == '}' || character == ';')).then_some(place + 1)
    });
    before.to_owned() + &without_test_items(&after[end.unwrap_or(after.len())..])
}

/// The words and signs of code: names, `::`, and single characters.
pub(crate) fn tokens(code: &str) -> Vec<&str> {
    let mut tokens = Vec::new();
    let mut rest = code;
    while let Some(first) = rest.chars().next() {
        let is_name = |character: char| character.is_alphanumeric() || character == '_';
        let length = if is_name(first) {
            rest.find(|character| !is_name(character)).unwrap_or(rest.len())
        } else if rest.starts_with("::") {
            2
        } else {
            first.len_utf8()
        };
        if !first.is_whitespace() {
            tokens.push(&rest[..length]);
        }
        rest = &rest[length..];
    }
    tokens
}

/// The folders of `src` that are crates.
const CRATES: [&str; 4] = ["engine", "results", "runs", "program"];

/// The path of a file in its crate: `runs/beds/file/mod.rs` is `beds/file/mod.rs`.
pub(crate) fn path_in_crate(file: &str) -> &str {
    match file.split_once('/') {
        Some((folder, rest)) if CRATES.contains(&folder) => rest,
        _ => file,
    }
}

/// The modules along the path of a file: `runs/beds/file/mod.rs` is `[beds, file]`.
pub(crate) fn module_of(file: &str) -> Vec<&str> {
    let path = path_in_crate(file).trim_end_matches(".rs");
    path.trim_end_matches("/mod").split('/').filter(|name| *name != "lib").collect()
}

/// Every path from the root of a crate of Talcum that a file names: `[contact, lanes, evaluate]`.
pub(crate) fn paths_into_the_crate<'a>(file: &'a str, tokens: &[&'a str]) -> Vec<Vec<&'a str>> {
    let here = module_of(file);
    let mut found = Vec::new();
    for at in 0..tokens.len() {
        if at > 0 && tokens[at - 1] == "::" {
            continue;
        }
        let (mut next, mut stem) = match tokens[at] {
            "crate" | "talcum" => (at + 1, Vec::new()),
            name if is_crate(name) => (at + 1, Vec::new()),
            "self" => (at + 1, here.clone()),
            "super" => (at + 1, here[..here.len().saturating_sub(1)].to_vec()),
            _ => continue,
        };
        while tokens.get(next..next + 2) == Some(&["::", "super"]) {
            stem.pop();
            next += 2;
        }
        if tokens.get(next) == Some(&"::") {
            let join = |leaf| stem.iter().copied().chain(leaf).collect();
            found.extend(leaves(&tokens[next + 1..]).into_iter().map(join));
        }
    }
    found
}

/// Whether a name is that of a crate of Talcum, such as `talcum_engine`.
fn is_crate(name: &str) -> bool {
    name.strip_prefix("talcum_").is_some_and(|folder| CRATES.contains(&folder))
}

/// The paths of a tree: `a::{b, c::d}` gives `[a, b]` and `[a, c, d]`.
pub(crate) fn leaves<'a>(tokens: &[&'a str]) -> Vec<Vec<&'a str>> {
    let mut found = Vec::new();
    let mut path: Vec<&str> = Vec::new();
    let mut groups: Vec<usize> = Vec::new();
    let mut is_new = false;
    for &token in tokens {
        match token {
            "::" => {}
            "{" => groups.push(path.len()),
            "," | "}" if !groups.is_empty() => {
                if is_new {
                    found.push(path.clone());
                }
                is_new = false;
                if token == "}" {
                    groups.pop();
                }
                path.truncate(groups.last().copied().unwrap_or_default());
                if groups.is_empty() {
                    break;
                }
            }
            name if name == "*" || name.starts_with(|c: char| c.is_alphabetic() || c == '_') => {
                // A name after a name: `as other`, or the path has ended.
                if is_new && name == "as" && groups.is_empty() {
                    break;
                }
                path.push(name);
                is_new = true;
            }
            _ => break,
        }
    }
    if is_new {
        found.push(path);
    }
    found
}
