//! The recipes in packaging/, CITATION.cff and the scripts agree with Cargo.toml on version, compiler and licence.

use std::fs;
use std::path::Path;

/// Files that name the version of Talcum, and the text before it.
const VERSIONS: [(&str, &str); 4] = [
    ("CITATION.cff", "\nversion: "),
    ("packaging/conda/recipe.yaml", "\n  version: "),
    ("packaging/spack/package.py", "version("),
    ("packaging/talcum.def", "version "),
];

/// Files that name the least version of Rust, and the text before it.
const COMPILERS: [(&str, &str); 5] = [
    ("scripts/install", "least_rust="),
    ("packaging/conda/recipe.yaml", "rust >="),
    ("packaging/spack/package.py", "rust@"),
    ("docs/packaging.md", "Rust "),
    (".github/workflows/tests.yml", "toolchain install "),
];

/// Where a public address stands when there is one; until then the mark, which the list in docs/packaging.md explains.
const ADDRESSES: [&str; 3] =
    ["packaging/conda/recipe.yaml", "packaging/spack/package.py", "CITATION.cff"];
/// A name that nobody can own.
const MARK: &str = "talcum.invalid";

fn read(path: &str) -> String {
    let full = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    fs::read_to_string(full).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// What stands behind the first occurrence of a text that a number follows, without quotes.
fn number_behind<'t>(text: &'t str, before: &str) -> Option<&'t str> {
    let rests =
        text.match_indices(before).map(|(at, _)| text[at + before.len()..].trim_start_matches('"'));
    let number = |rest: &'t str| {
        let end = rest.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(rest.len());
        let number = rest[..end].trim_end_matches('.');
        (!number.is_empty()).then_some(number)
    };
    rests.filter_map(number).next()
}

#[test]
fn recipes_name_the_version_of_cargo_toml() {
    for (file, before) in VERSIONS {
        assert_eq!(number_behind(&read(file), before), Some(env!("CARGO_PKG_VERSION")), "{file}");
    }
    assert_eq!(number_behind("version: \"1.2.3\"\n", "version: "), Some("1.2.3"));
    assert_eq!(number_behind("version of 3", "version "), None);
}

#[test]
fn recipes_name_the_compiler_of_cargo_toml() {
    for (file, before) in COMPILERS {
        assert_eq!(
            number_behind(&read(file), before),
            Some(env!("CARGO_PKG_RUST_VERSION")),
            "{file}"
        );
    }
}

#[test]
fn there_is_no_address_that_may_belong_to_somebody_else() {
    let address = std::env::var("CARGO_PKG_REPOSITORY").unwrap_or_default();
    let has_address = !address.is_empty();
    assert!(!address.contains(MARK), "{address}");
    let checklist = read("docs/packaging.md");
    assert_eq!(checklist.contains(MARK), !has_address, "docs/packaging.md");
    for file in ADDRESSES {
        assert_eq!(
            read(file).contains(MARK),
            !has_address,
            "{file}: {MARK} marks what a release must replace"
        );
    }
}
