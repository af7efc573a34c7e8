//! Paths that the documents name exist.

use std::fs;
use std::path::Path;

/// Documents besides those of the book, which are all that lie in docs/.
const DOCUMENTS: [&str; 8] = [
    "README.md",
    "ARCHITECTURE.md",
    "CONTRIBUTING.md",
    "CHANGELOG.md",
    "cases/benchmark/README.md",
    "cases/experiments/README.md",
    "cases/liu2016/README.md",
    "cases/moon2006/README.md",
];

/// Endings of files of the repository; others are results.
const ENDINGS: [&str; 6] = [".rs", ".md", ".py", ".toml", ".sh", ".slurm"];

/// Texts between backticks, and targets of links, that look like paths.
fn paths_in(text: &str) -> Vec<&str> {
    let quoted = text.split('`').skip(1).step_by(2);
    let linked = text.split("](").skip(1).filter_map(|rest| rest.split([')', '#']).next());
    let is_path = |path: &&str| {
        let plain = path.chars().all(|c| c.is_ascii_alphanumeric() || "/._-".contains(c));
        let top = [
            "src/",
            "tests/",
            "docs/",
            "scripts/",
            "cases/",
            "jobs/",
            "benches/",
            "examples/",
            "packaging/",
        ];
        let is_inside = top.iter().any(|folder| path.starts_with(folder));
        plain && !path.starts_with(['/', '.']) && (is_inside || ends_like_ours(path))
    };
    quoted.chain(linked).filter(is_path).collect()
}

fn ends_like_ours(path: &str) -> bool {
    path.contains('/') && ENDINGS.iter().any(|ending| path.ends_with(ending))
}

/// Whether a path exists in the repository, in its sources, or beside the document that names it.
fn exists(path: &str, document: &str) -> bool {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let beside = Path::new(document).parent().unwrap();
    ["", "src", "src/engine", "src/results", "src/runs", "src/program"]
        .iter()
        .map(Path::new)
        .chain([beside])
        .any(|folder| root.join(folder).join(path).exists())
}

/// The pages of the book, in docs/ and the folders in it.
fn pages(folder: &str) -> Vec<String> {
    let mut found = Vec::new();
    for entry in fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)).unwrap() {
        let name = format!("{folder}/{}", entry.unwrap().file_name().to_str().unwrap());
        if !name.contains('.') {
            found.extend(pages(&name));
        } else if name.ends_with(".md") {
            found.push(name);
        }
    }
    found
}

#[test]
fn paths_named_in_documents_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (mut found, mut count) = (Vec::new(), 0);
    let pages = pages("docs");
    assert!(pages.len() > 20, "{pages:?}");
    for document in DOCUMENTS.into_iter().chain(pages.iter().map(String::as_str)) {
        let text = fs::read_to_string(root.join(document)).unwrap();
        let paths = paths_in(&text);
        count += paths.len();
        let missing = paths.into_iter().filter(|path| !exists(path, document));
        found.extend(missing.map(|path| format!("{document} names {path}")));
    }
    assert!(count > 50, "{count}");
    assert!(found.is_empty(), "there is no such file:\n{}", found.join("\n"));
}

#[test]
fn a_path_that_does_not_exist_is_found() {
    let text = "See `src/engine/timers.rs`, `output/nowhere.rs`, [a](docs/lost.md#there), `a / b`, `results/x.h5`.";
    let paths = paths_in(text);
    assert_eq!(paths, ["src/engine/timers.rs", "output/nowhere.rs", "docs/lost.md"]);
    let missing: Vec<&&str> = paths.iter().filter(|path| !exists(path, "README.md")).collect();
    assert_eq!(missing, [&"output/nowhere.rs", &"docs/lost.md"]);
}

/// The step between its two marks in the source.
fn step_in_source() -> String {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/engine/time_step/mod.rs");
    let text = fs::read_to_string(source).unwrap();
    let after = text.split_once("    // [step]\n").unwrap().1;
    after.split_once("    // [/step]").unwrap().0.to_owned()
}

/// The first block of Rust in a text.
fn first_block(text: &str) -> &str {
    text.split_once("```rust\n").unwrap().1.split_once("```").unwrap().0
}

#[test]
fn the_step_that_architecture_shows_is_that_of_the_source() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(root.join("ARCHITECTURE.md")).unwrap();
    let shown = first_block(text.split_once("## One step").unwrap().1);
    assert_eq!(shown, step_in_source());
    // Negative control: a line less is seen.
    let drifted = text.replacen("    staggered.leave_kick(dt);\n", "", 1);
    assert_ne!(first_block(drifted.split_once("## One step").unwrap().1), step_in_source());
}

#[test]
fn the_step_is_a_flat_list() {
    let step = step_in_source();
    let is_nested = |line: &str| line.starts_with("         ") || line.contains("|state");
    let lines = step.lines().count();
    assert!(lines <= 20 && !step.lines().any(is_nested), "{lines} lines:\n{step}");
}
