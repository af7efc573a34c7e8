//! The table of laws in docs/laws.md is generated from the registries and the heads of the laws' files. After a change,
//! `TALCUM_WRITE_DOCS=1 cargo test --test physics contact_laws::documentation` regenerates it.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use talcum::contact::ContactLaw;
use talcum::gas::DragLaw;

const CONTACT: &str = "src/engine/contact/laws";
const DRAG: &str = "src/engine/gas/drag";

/// Laws whose sources have no DOI: volumes of the 1950s and 1960s that were never registered.
const WITHOUT_DOI: [&str; 3] = ["ergun", "wen_yu", "wen_yu_creeping"];

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// The lines of the comment at the head of a file.
fn head_of(file: &Path) -> Vec<String> {
    let text = fs::read_to_string(root().join(file)).unwrap();
    let lines = text.lines().map_while(|line| line.strip_prefix("//!"));
    lines.map(|line| line.trim().to_owned()).collect()
}

/// What a head says before its references, and the references.
fn summary_and_references(head: &[String]) -> (String, Vec<String>) {
    let at = head.iter().position(|line| line == "References:").unwrap_or(head.len());
    let summary = head[..at].join(" ").trim().trim_end_matches('.').to_owned();
    let mut references: Vec<String> = Vec::new();
    for line in head.iter().skip(at + 1) {
        match (line.strip_prefix("* "), references.last_mut()) {
            (Some(begin), _) => references.push(begin.to_owned()),
            (None, Some(reference)) => *reference = format!("{reference} {line}"),
            (None, None) => {}
        }
    }
    (summary, references)
}

/// The file of each drag law: the registry's line says `"name" => file::Type`.
fn drag_file(name: &str) -> PathBuf {
    let registry = fs::read_to_string(root().join(DRAG).join("mod.rs")).unwrap();
    let line = format!("\"{name}\" => ");
    let (_, rest) = registry.split_once(&line).unwrap();
    Path::new(DRAG).join(rest.split_once("::").unwrap().0).with_extension("rs")
}

fn table(rows: impl Iterator<Item = (String, PathBuf)>) -> String {
    let mut table = "| name | law | file | references |\n| --- | --- | --- | --- |\n".to_owned();
    for (name, file) in rows {
        let (summary, references) = summary_and_references(&head_of(&file));
        let (shown, references) = (file.display(), references.join("; "));
        writeln!(table, "| `{name}` | {summary} | `{shown}` | {references} |").unwrap();
    }
    table
}

fn tables() -> [(&'static str, String); 2] {
    let contact = ContactLaw::NAMES
        .iter()
        .map(|name| ((*name).to_owned(), Path::new(CONTACT).join(name).with_extension("rs")));
    let drag = DragLaw::NAMES.iter().map(|name| ((*name).to_owned(), drag_file(name)));
    [("contact laws", table(contact)), ("drag laws", table(drag))]
}

/// The text with what stands between the markers replaced.
fn with_table(text: &str, (name, table): &(&str, String)) -> String {
    let (begin, end) = (format!("<!-- {name}: generated -->\n"), format!("<!-- {name}: end -->"));
    let (before, rest) = text.split_once(&begin).unwrap();
    let (_, after) = rest.split_once(&end).unwrap();
    [before, &begin, table, &end, after].concat()
}

#[test]
fn table_of_laws_is_current() {
    let path = root().join("docs/laws.md");
    let text = fs::read_to_string(&path).unwrap();
    let current = tables().iter().fold(text.clone(), |text, table| with_table(&text, table));
    if std::env::var_os("TALCUM_WRITE_DOCS").is_some() {
        fs::write(&path, &current).unwrap();
        return;
    }
    assert!(text == current, "docs/laws.md is out of date: run with TALCUM_WRITE_DOCS=1");
    // Negative control: a law of another name is another table.
    assert_ne!(current.replace("`jkr`", "`other`"), text);
}

#[test]
fn every_law_cites_its_sources() {
    let contact = ContactLaw::NAMES.iter().map(|name| Path::new(CONTACT).join(name));
    let drag = DragLaw::NAMES.iter().map(|name| drag_file(name));
    for (name, file) in ContactLaw::NAMES.iter().chain(DragLaw::NAMES).zip(contact.chain(drag)) {
        let (summary, references) = summary_and_references(&head_of(&file.with_extension("rs")));
        assert!(!summary.is_empty() && !references.is_empty(), "{name} cites nothing");
        let doi = references.iter().any(|reference| reference.contains("<https://doi.org/10."));
        assert_eq!(doi, !WITHOUT_DOI.contains(name), "{name}: {references:?}");
    }
}

/// Blocks of code in the language "math", which docs/katex-header.html draws as formulas.
fn formulas(text: &str) -> usize {
    text.lines()
        .filter(|line| line.trim_start().trim_start_matches('/').trim() == "```math")
        .count()
}

#[test]
fn every_law_shows_its_formula() {
    let contact = ContactLaw::NAMES.iter().map(|name| Path::new(CONTACT).join(name));
    let drag = DragLaw::NAMES.iter().map(|name| drag_file(name));
    for file in contact.chain(drag) {
        let text = fs::read_to_string(root().join(file.with_extension("rs"))).unwrap();
        assert!(formulas(&text) > 0, "{} shows no formula", file.display());
    }
    // Negative control: a plain block is no formula.
    assert_eq!(formulas("/// ```text\n/// F = k delta\n/// ```"), 0);
}
