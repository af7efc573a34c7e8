//! Words that readers of this field would not understand are not used in sources and documents. The list is the last
//! table of docs/glossary.md.

use std::fs;
use std::path::{Path, PathBuf};

/// Files, or folders, that still use some of the words, to be mended.
const STILL_OPEN: [&str; 0] = [];

/// Files that name the words on purpose: the list itself, and a mark in checkpoints that older ones have too.
const ON_PURPOSE: [&str; 3] =
    ["docs/glossary.md", "src/results/output/checksum.rs", "docs/files.md"];

/// The first column of the table of words that are not used, one entry for each phrase.
fn retired(glossary: &str) -> Vec<Vec<String>> {
    let table = glossary.split("| not | but |").nth(1).expect("the glossary ends in the table");
    let rows = table.lines().filter_map(|line| line.strip_prefix("| "));
    let cells = rows.filter(|row| !row.starts_with("---")).filter_map(|row| row.split('|').next());
    let phrases = cells.flat_map(|cell| cell.split(','));
    phrases.map(|phrase| words_of(phrase).collect()).collect()
}

/// The words of a line in small letters; identifiers fall into their words.
fn words_of(line: &str) -> impl Iterator<Item = String> {
    let mut spaced = String::new();
    let mut before = ' ';
    for character in line.chars() {
        if character.is_uppercase() && before.is_lowercase() {
            spaced.push(' ');
        }
        spaced.push(if character.is_alphanumeric() { character } else { ' ' });
        before = character;
    }
    spaced.to_lowercase().split_whitespace().map(str::to_owned).collect::<Vec<_>>().into_iter()
}

/// Lines at which a text uses a phrase, also one that runs over the end of a line.
fn uses(text: &str, phrases: &[Vec<String>]) -> Vec<(usize, String)> {
    let numbered = text.lines().zip(1..);
    let words: Vec<(String, usize)> = numbered
        .flat_map(|(line, number)| words_of(line).map(move |word| (word, number)))
        .collect();
    let mut found = Vec::new();
    for phrase in phrases {
        for window in words.windows(phrase.len()) {
            if window.iter().map(|(word, _)| word).eq(phrase) {
                found.push((window[0].1, phrase.join(" ")));
            }
        }
    }
    found
}

/// Sources and documents, by their paths in the repository.
fn files(folder: &Path, root: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let is_text =
            path.extension().is_some_and(|extension| extension == "rs" || extension == "md");
        if path.is_dir() {
            found.extend(files(&path, root));
        } else if is_text {
            found.push(path.strip_prefix(root).unwrap().to_owned());
        }
    }
    found
}

#[test]
fn no_retired_word_is_used() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let phrases = retired(&fs::read_to_string(root.join("docs/glossary.md")).unwrap());
    assert!(phrases.len() > 30, "{phrases:?}");
    let documents = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md"];
    let mut paths: Vec<PathBuf> = documents.iter().map(PathBuf::from).collect();
    paths.extend(["src", "docs"].iter().flat_map(|folder| files(&root.join(folder), root)));
    let mut found = Vec::new();
    for path in paths {
        let name = path.to_str().unwrap();
        if ON_PURPOSE.contains(&name) || STILL_OPEN.iter().any(|open| name.starts_with(open)) {
            continue;
        }
        // A space in a formula of LaTeX is no word.
        let text = fs::read_to_string(root.join(&path)).unwrap().replace("\\quad", "");
        let uses = uses(&text, &phrases).into_iter();
        found.extend(uses.map(|(line, phrase)| format!("{name}:{line}: {phrase:?}")));
    }
    assert!(found.is_empty(), "docs/glossary.md says what to write instead:\n{}", found.join("\n"));
}

#[test]
fn retired_words_are_found_in_prose_and_in_identifiers() {
    let phrases =
        retired("| not | but |\n| --- | --- |\n| letter, letters | message |\n| in words | x |\n");
    assert_eq!(phrases.len(), 3);
    for text in
        ["a letter", "fn exchange_letters()", "struct LetterBox;", "it says in\n/// words what"]
    {
        assert_eq!(uses(text, &phrases).len(), 1, "{text}");
    }
    for text in ["lettering", "in other words", "words in"] {
        assert!(uses(text, &phrases).is_empty(), "{text}");
    }
    assert_eq!(uses("one\ntwo\nInWords", &phrases), [(3, "in words".to_owned())]);
}
