//! The index of tests in docs/tests.md says what each file of tests shows, and by which tests. After a change,
//! `TALCUM_WRITE_DOCS=1 cargo test --test project index` writes it again.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

/// The folders of the index, and what their tests are.
const PARTS: [(&str, &str); 9] = [
    ("tests/physics", "Physics: `cargo test --test physics`"),
    ("tests/gas", "Volume-averaged gas: `cargo test --test gas`"),
    ("tests/parallel", "Ranks as threads: `cargo test --test parallel`"),
    ("tests/mpi_communicator", "Processes of MPI: `cargo test --test mpi_communicator`"),
    ("tests/threads", "The program on threads: `cargo test --test threads`"),
    ("tests/program", "The program: `cargo test --test program`"),
    ("tests/allocator", "The allocator: `cargo test --test allocator`"),
    ("tests/project", "The project: `cargo test --test project`"),
    ("src", "Units, beside the code: `cargo test --lib`"),
];

const INTRODUCTION: &str = "\
# What the tests show

Every file of tests, what it shows, and the names of its tests. `scripts/test` runs them all; CONTRIBUTING.md says how to run
some. Measured numbers are in [verification.md](verification.md).

This page is written from the heads of the files and the names of the tests (`tests/project/index.rs` checks it).
";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// All Rust files below a folder, in the order of their names.
fn files_below(folder: &Path) -> Vec<PathBuf> {
    let mut found: Vec<PathBuf> = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files_below(&path));
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// The first paragraph of the comment at the head of a file.
fn claim(text: &str) -> String {
    let head = text.lines().map_while(|line| line.strip_prefix("//!").map(str::trim));
    head.take_while(|line| !line.is_empty()).collect::<Vec<_>>().join(" ")
}

/// The names of the tests in a file: functions behind `#[test]`, other attributes and comments between.
fn tests_in(text: &str) -> Vec<&str> {
    let mut names = Vec::new();
    let mut is_test = false;
    for line in text.lines().map(str::trim) {
        if line == "#[test]" {
            is_test = true;
        } else if let Some(rest) = line.strip_prefix("fn ") {
            let name = rest.split(['(', '<']).next();
            names.extend(name.filter(|_| is_test));
            is_test = false;
        }
    }
    names
}

fn index_of(folder: &str) -> String {
    let mut index = String::new();
    for path in files_below(&root().join(folder)) {
        let text = fs::read_to_string(&path).unwrap();
        let tests = tests_in(&text);
        if tests.is_empty() {
            continue;
        }
        let shown = path.strip_prefix(root()).unwrap().display();
        write!(index, "\n**`{shown}`**: {}\n\n", claim(&text)).unwrap();
        for name in tests {
            writeln!(index, "* {}", name.replace('_', " ")).unwrap();
        }
    }
    index
}

fn page() -> String {
    let mut page = INTRODUCTION.to_owned();
    for (folder, title) in PARTS {
        write!(page, "\n## {title}\n{}", index_of(folder)).unwrap();
    }
    page
}

#[test]
fn index_is_what_the_tests_say() {
    let file = root().join("docs/tests.md");
    if std::env::var_os("TALCUM_WRITE_DOCS").is_some() {
        fs::write(&file, page()).unwrap();
    }
    let kept = fs::read_to_string(&file).unwrap_or_default();
    assert!(
        kept == page(),
        "docs/tests.md is out of date: TALCUM_WRITE_DOCS=1 cargo test --test project index"
    );
}

#[test]
fn every_file_of_tests_says_what_it_shows() {
    for (folder, _) in PARTS {
        for path in files_below(&root().join(folder)) {
            let text = fs::read_to_string(&path).unwrap();
            let silent = !tests_in(&text).is_empty() && claim(&text).is_empty();
            assert!(!silent, "{} has tests, but no comment at its head", path.display());
        }
    }
}

#[test]
fn a_test_is_found_behind_attributes_and_comments() {
    let text = "//! Head\n//! of it.\n//!\n//! More.\n#[test]\n/// Why.\n#[ignore]\nfn one_is_one() {}\nfn no_test() {}";
    assert_eq!((claim(text).as_str(), tests_in(text)), ("Head of it.", vec!["one_is_one"]));
}
