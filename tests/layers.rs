//! Who may know whom: every path into the crate, in every file of src, against the table of ARCHITECTURE.md.
//! Comments, texts and test modules do not count.

#![allow(clippy::unwrap_used, reason = "in tests a panic is the report")]

use std::fs;
use std::path::{Path, PathBuf};

/// Each module at the top of the crate, and what it may name.
const MAY_KNOW: [(&str, &[&str]); 18] = [
    ("rules", &[]),
    ("numbers", &[]),
    ("domain", &["numbers"]),
    ("particles", &["domain", "numbers"]),
    ("contact", &["domain", "numbers", "particles"]),
    ("grid", &["domain", "numbers"]),
    (
        "gas",
        &[
            "coupling",
            "domain",
            "grid",
            "linear_solver",
            "numbers",
            "parallel",
            "particles",
            "rules",
        ],
    ),
    ("parallel", &["domain", "grid", "numbers", "particles"]),
    ("linear_solver", &["domain", "grid", "numbers", "parallel"]),
    ("coupling", &["domain", "grid", "numbers", "parallel", "particles"]),
    ("timers", &["parallel"]),
    ("state", &["contact", "domain", "gas", "numbers", "parallel", "particles", "rules", "timers"]),
    (
        "time_step",
        &["contact", "domain", "gas", "numbers", "parallel", "particles", "state", "timers"],
    ),
    (
        "analysis",
        &["coupling", "domain", "gas", "grid", "numbers", "parallel", "particles", "state"],
    ),
    ("output", &["analysis", "domain", "grid", "numbers", "parallel", "particles", "state"]),
    (
        "case",
        &[
            "contact",
            "domain",
            "gas",
            "grid",
            "linear_solver",
            "numbers",
            "particles",
            "rules",
            "state",
        ],
    ),
    (
        "simulation",
        &[
            "analysis",
            "case",
            "contact",
            "coupling",
            "domain",
            "gas",
            "grid",
            "numbers",
            "output",
            "parallel",
            "particles",
            "state",
            "time_step",
            "timers",
        ],
    ),
    (
        "command_line",
        &[
            "analysis",
            "case",
            "contact",
            "domain",
            "gas",
            "output",
            "parallel",
            "rules",
            "simulation",
            "state",
            "time_step",
            "timers",
        ],
    ),
];

/// Single items that cross the table, each with its reason.
const EXCEPTIONS: [(&str, &str, &str); 1] = [
    // An initial bed is made of the plain records that travel between ranks and stand in checkpoints.
    ("case/bed/mod.rs", "parallel", "ParticleRecord"),
];

/// Crates that only one file, or those of one folder and the file of its name, may name.
const ONE_PLACE: [(&str, &str); 2] =
    [("mpi", "parallel/mpi_ranks"), ("hdf5_sys", "output/hdf5_file/rows")];

/// Files that may name any module: they hold nothing of their own.
const FREE: [&str; 2] = ["lib.rs", "main.rs"];

/// What is left of a file without comments, texts and items for tests.
fn code_of(text: &str) -> String {
    without_test_items(&without_comments_and_texts(text))
}

fn without_comments_and_texts(text: &str) -> String {
    let messages: Vec<char> = text.chars().collect();
    let mut code = String::new();
    let mut at = 0;
    while at < messages.len() {
        let rest = &messages[at..];
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

/// Letters up to and including the first `end` from place `from` on, or all.
fn until(messages: &[char], from: usize, end: &[char]) -> usize {
    let found = messages[from..].windows(end.len()).position(|window| window == end);
    found.map_or(messages.len() + 1, |place| from + place + end.len()).min(messages.len() + 1)
}

fn length_of_text(messages: &[char]) -> usize {
    let mut at = 1;
    while at < messages.len() && messages[at] != '"' {
        at += if messages[at] == '\\' { 2 } else { 1 };
    }
    at + 1
}

/// Drops what follows `#[cfg(test)]`: up to a semicolon, or to the end of its braces.
fn without_test_items(code: &str) -> String {
    let Some((before, after)) = code.split_once("#[cfg(test)]") else { return code.to_owned() };
    let mut depth = 0;
    let end = after.char_indices().find_map(|(place, message)| {
        match message {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        (depth == 0 && (message == '}' || message == ';')).then_some(place + 1)
    });
    before.to_owned() + &without_test_items(&after[end.unwrap_or(after.len())..])
}

/// The words and signs of code: names, `::`, and single characters.
fn tokens(code: &str) -> Vec<&str> {
    let mut tokens = Vec::new();
    let mut rest = code;
    while let Some(first) = rest.chars().next() {
        let is_name = |message: char| message.is_alphanumeric() || message == '_';
        let length = if is_name(first) {
            rest.find(|letter| !is_name(letter)).unwrap_or(rest.len())
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

/// The modules along the path of a file: `case/bed/mod.rs` is `[case, bed]`.
fn module_of(file: &str) -> Vec<&str> {
    let path = file.trim_end_matches(".rs");
    path.trim_end_matches("/mod").split('/').filter(|name| *name != "lib").collect()
}

/// Every path from the crate's root that a file names, as (module, next name).
fn paths_into_the_crate<'a>(file: &'a str, tokens: &[&'a str]) -> Vec<(&'a str, &'a str)> {
    let here = module_of(file);
    let mut found = Vec::new();
    for at in 0..tokens.len() {
        if at > 0 && tokens[at - 1] == "::" {
            continue;
        }
        let (mut next, mut stem) = match tokens[at] {
            "crate" | "talcum" => (at + 1, Vec::new()),
            "super" => (at + 1, here[..here.len().saturating_sub(1)].to_vec()),
            _ => continue,
        };
        while tokens.get(next..next + 2) == Some(&["::", "super"]) {
            stem.pop();
            next += 2;
        }
        if tokens.get(next) != Some(&"::") {
            continue;
        }
        for leaf in leaves(&tokens[next + 1..]) {
            let path: Vec<&str> = stem.iter().copied().chain(leaf).collect();
            found.push((path[0], path.get(1).copied().unwrap_or("")));
        }
    }
    found
}

/// The paths of a tree: `a::{b, c::d}` gives `[a, b]` and `[a, c, d]`.
fn leaves<'a>(tokens: &[&'a str]) -> Vec<Vec<&'a str>> {
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

/// What a file names against the table, in words.
fn violations(file: &str, text: &str) -> Vec<String> {
    let code = code_of(text);
    let tokens = tokens(&code);
    let mut found = Vec::new();
    for (name, only) in ONE_PLACE {
        let inside = file.strip_prefix(only).is_some_and(|rest| rest.starts_with(['.', '/']));
        let named = tokens.windows(2).enumerate().any(|(at, pair)| {
            pair == [name, "::"] && (at == 0 || tokens[at - 1] != "::") || pair == ["use", name]
        });
        if named && !inside {
            found.push(format!("{file} names {name}, as only {only} may"));
        }
    }
    if FREE.contains(&file) {
        return found;
    }
    let own = module_of(file)[0];
    let Some((_, allowed)) = MAY_KNOW.iter().find(|(name, _)| *name == own) else {
        found.push(format!("{file}: the table has no row for {own}"));
        return found;
    };
    for (module, item) in paths_into_the_crate(file, &tokens) {
        let excepted = EXCEPTIONS.contains(&(file, module, item));
        if module != own && !allowed.contains(&module) && !excepted {
            found.push(format!("{file} names {module}::{item}, which {own} must not know"));
        }
    }
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

#[test]
fn every_file_keeps_to_its_layer() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let files = files_of(&source);
    assert!(files.len() > 60);
    let mut found = Vec::new();
    for path in files {
        let file = path.strip_prefix(&source).unwrap().to_str().unwrap();
        found.extend(violations(file, &fs::read_to_string(&path).unwrap()));
    }
    assert!(found.is_empty(), "\n{}", found.join("\n"));
}

#[test]
fn exceptions_are_still_needed() {
    for (file, module, item) in EXCEPTIONS {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src").join(file);
        let code = code_of(&fs::read_to_string(path).unwrap());
        let named = paths_into_the_crate(file, &tokens(&code));
        assert!(named.contains(&(module, item)), "{file} no longer names {module}::{item}");
    }
}

#[test]
fn no_two_modules_know_each_other() {
    for (one, known) in MAY_KNOW {
        for other in known {
            let (_, back) = MAY_KNOW.iter().find(|(name, _)| name == other).expect("has a row");
            assert!(!back.contains(&one), "{one} and {other} know each other");
        }
    }
}

#[test]
fn planted_violations_are_caught() {
    for (file, text) in [
        ("contact/forces.rs", "use crate::gas::DragLaw;"),
        ("contact/forces.rs", "use crate::{domain::Wall, gas::{self, DragLaw}};"),
        ("contact/forces.rs", "use crate::{\n    domain::{Wall, Face},\n    parallel,\n};"),
        ("contact/forces.rs", "use super::super::parallel::Communicator;"),
        ("contact/mod.rs", "pub use super::gas::DragLaw as Drag;"),
        ("contact/mod.rs", "fn f(ranks: &dyn crate::parallel::Communicator) {}"),
        (
            "contact/mod.rs",
            "const QUOTE: char = '\"'; use crate::case::Case; const S: &str = \"\";",
        ),
        ("timers.rs", "use super::state;"),
        ("gas/column.rs", "/* a note */ use crate::particles::*; // why"),
        ("case/bed/mod.rs", "use crate::parallel::{ParticleRecord, Communicator};"),
        ("case/bed/mod.rs", "use crate::parallel::ContactRecord;"),
        ("case/units.rs", "use crate::parallel::ParticleRecord;"),
        ("analysis/digest.rs", "#[cfg(test)]\nmod tests { fn f() {} }\nuse crate::output::Series;"),
        ("command_line/run.rs", "use mpi::topology::Communicator;"),
        ("parallel/migrate.rs", "fn f() { ::mpi::initialize(); mpi::initialize(); }"),
        ("parallel/mpi_ranks_too.rs", "use mpi::Tag;"),
        ("output/seal.rs", "extern crate hdf5_sys; fn f() { hdf5_sys::h5::H5open(); }"),
        ("turbulence/mod.rs", ""),
    ] {
        assert!(!violations(file, text).is_empty(), "{file}: {text}");
    }
}

#[test]
fn what_is_allowed_is_not_caught() {
    for (file, text) in [
        ("contact/forces.rs", "use crate::{domain::Wall, numbers::{Quantum, in_wide_vectors}};"),
        ("contact/forces.rs", "use super::lanes::evaluate; use crate::contact::Contact;"),
        ("case/bed/mod.rs", "use crate::parallel::ParticleRecord;"),
        (
            "gas/column.rs",
            "// use crate::particles::Particles;\nconst S: &str = \"crate::case::Case\";",
        ),
        (
            "gas/column.rs",
            "/// [`crate::particles`] \n#[cfg(test)]\nuse crate::particles::Particles;",
        ),
        ("gas/column.rs", "#[cfg(test)]\nmod tests { use crate::case::Case; fn f() { { } } }"),
        ("parallel/mpi_ranks.rs", "use mpi::Tag;"),
        ("parallel/mpi_ranks/messages.rs", "use mpi::Tag;"),
        ("parallel/mod.rs", "mod mpi_ranks; pub use mpi_ranks::MpiRanks;"),
        (
            "command_line/mod.rs",
            "use crate::{case, simulation}; fn f() { talcum::parallel::agree() }",
        ),
    ] {
        assert_eq!(violations(file, text), [""; 0], "{file}: {text}");
    }
}
