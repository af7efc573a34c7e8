//! Permitted imports: every path into a crate of Talcum, in every file of src, is compared with the table in ARCHITECTURE.md;
//! and there are no circles of imports inside a folder. Comments, texts and test modules do not count.

mod circles;
mod source;

use self::circles::circles;
use self::source::{all_files, code_of, module_of, path_in_crate, paths_into_the_crate, tokens};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Crates that only one file, or those of one folder and the file of its name, may name.
const ONE_PLACE: [(&str, &str); 2] =
    [("mpi", "parallel/mpi_ranks"), ("hdf5_sys", "output/hdf5_file")];

/// Files that may name any module: they hold nothing of their own.
const FREE: [&str; 3] = ["lib.rs", "main.rs", "gallery.rs"];

/// Whether a file may name any module.
fn is_free(file: &str) -> bool {
    FREE.contains(&path_in_crate(file))
}

/// Folders whose files still know each other in circles, to be mended; new ones are refused.
const OPEN_CIRCLES: [&str; 0] = [];

/// Each module at the top of the crate, and what it may name.
type Table = BTreeMap<String, BTreeSet<String>>;

/// The table of the section "Layers" of a document.
fn table_in(document: &str) -> Table {
    let section = document.split("\n## ").find(|section| section.starts_with("Layers"));
    let mut table = Table::new();
    for line in section.expect("there is a section \"Layers\"").lines() {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let [_, module, uses, _, _] = cells[..] else { continue };
        let Some(module) = module.strip_prefix('`').and_then(|name| name.strip_suffix('`')) else {
            continue;
        };
        let uses = uses.split(',').map(|name| name.trim().to_owned());
        let uses = uses.filter(|name| !name.is_empty() && name != "-").collect();
        assert!(table.insert(module.to_owned(), uses).is_none(), "two rows for {module}");
    }
    table
}

/// The table that ARCHITECTURE.md shows.
fn table() -> Table {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("ARCHITECTURE.md");
    table_in(&fs::read_to_string(path).unwrap())
}

/// What a file names against the table.
fn violations(file: &str, text: &str, table: &Table) -> Vec<String> {
    let code = code_of(text);
    let tokens = tokens(&code);
    let mut found = Vec::new();
    for (name, only) in ONE_PLACE {
        let inside =
            path_in_crate(file).strip_prefix(only).is_some_and(|rest| rest.starts_with(['.', '/']));
        let named = tokens.windows(2).enumerate().any(|(at, pair)| {
            pair == [name, "::"] && (at == 0 || tokens[at - 1] != "::") || pair == ["use", name]
        });
        if named && !inside {
            found.push(format!("{file} names {name}, as only {only} may"));
        }
    }
    if is_free(file) {
        return found;
    }
    let own = module_of(file)[0];
    let Some(allowed) = table.get(own) else {
        found.push(format!("{file}: the table has no row for {own}"));
        return found;
    };
    for (module, item) in modules_and_items(file, &tokens) {
        if module != own && !allowed.contains(&module) {
            found.push(format!("{file} names {module}::{item}, which {own} must not know"));
        }
    }
    found
}

/// What a file names, as (module at the top of the crate, next name).
fn modules_and_items(file: &str, tokens: &[&str]) -> Vec<(String, String)> {
    let paths = paths_into_the_crate(file, tokens);
    let name = |path: &[&str], place: usize| path.get(place).copied().unwrap_or("").to_owned();
    paths.iter().map(|path| (name(path, 0), name(path, 1))).collect()
}

#[test]
fn every_file_keeps_to_its_layer() {
    let (table, files) = (table(), all_files());
    assert!(table.len() > 15 && files.len() > 60);
    let found: Vec<String> =
        files.iter().flat_map(|(file, code)| violations(file, code, &table)).collect();
    assert!(found.is_empty(), "\n{}", found.join("\n"));
}

#[test]
fn the_table_allows_no_more_than_is_used() {
    let (mut used, mut found) = (Table::new(), Vec::new());
    for (file, code) in all_files() {
        let own = module_of(&file).first().map(|name| (*name).to_owned());
        let Some(own) = own.filter(|_| !is_free(&file)) else { continue };
        let named = modules_and_items(&file, &tokens(&code)).into_iter();
        let counted = named.map(|(module, _)| module).filter(|module| *module != own);
        used.entry(own.clone()).or_default().extend(counted);
    }
    for (module, allowed) in table() {
        let used = used.remove(&module).unwrap_or_else(|| panic!("there is no module {module}"));
        found.extend(allowed.difference(&used).map(|idle| format!("{module} does not use {idle}")));
    }
    assert!(found.is_empty(), "shorten the rows of the table:\n{}", found.join("\n"));
}

#[test]
fn no_two_modules_of_the_table_know_each_other() {
    let table = table();
    for (one, known) in &table {
        for other in known {
            let back = table.get(other).unwrap_or_else(|| panic!("{other} has no row"));
            assert!(!back.contains(one), "{one} and {other} know each other");
        }
    }
}

#[test]
fn no_files_of_a_folder_know_each_other_in_a_circle() {
    let is_open = |folder: &str| OPEN_CIRCLES.contains(&folder);
    let found: Vec<_> =
        circles(&all_files()).into_iter().filter(|(folder, _)| !is_open(folder)).collect();
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn planted_violations_are_caught() {
    let table = table();
    for (file, text) in [
        ("contact/forces.rs", "use crate::gas::DragLaw;"),
        ("results/analysis/digest.rs", "use talcum_runs::case::Case;"),
        ("engine/contact/forces.rs", "use talcum_engine::gas::DragLaw;"),
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
        ("gas/column.rs", "/* a note */ use crate::contact::*; // why"),
        ("case/reference/mod.rs", "use crate::parallel::{ParticleRecord, Communicator};"),
        ("analysis/digest.rs", "#[cfg(test)]\nmod tests { fn f() {} }\nuse crate::output::Series;"),
        ("command_line/run.rs", "use mpi::topology::Communicator;"),
        ("parallel/migrate.rs", "fn f() { ::mpi::initialize(); mpi::initialize(); }"),
        ("parallel/mpi_ranks_too.rs", "use mpi::Tag;"),
        ("output/checksum.rs", "extern crate hdf5_sys; fn f() { hdf5_sys::h5::H5open(); }"),
        ("turbulence/mod.rs", ""),
    ] {
        assert!(!violations(file, text, &table).is_empty(), "{file}: {text}");
    }
}

#[test]
fn what_is_allowed_is_not_caught() {
    let table = table();
    for (file, text) in [
        ("contact/forces.rs", "use crate::{domain::Wall, numbers::{Quantum, vectorised}};"),
        ("contact/forces.rs", "use super::lanes::evaluate; use crate::contact::Contact;"),
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
        ("engine/parallel/mpi_ranks.rs", "use mpi::Tag;"),
        ("results/output/series.rs", "use talcum_engine::parallel::Communicator;"),
        ("parallel/mpi_ranks/messages.rs", "use mpi::Tag;"),
        ("parallel/mod.rs", "mod mpi_ranks; pub use mpi_ranks::MpiRanks;"),
        (
            "command_line/mod.rs",
            "use crate::{case, simulation}; fn f() { talcum::parallel::agree() }",
        ),
    ] {
        assert_eq!(violations(file, text, &table), [""; 0], "{file}: {text}");
    }
}

#[test]
fn planted_circles_are_caught() {
    let files = |files: &[(&str, &str)]| -> Vec<(String, String)> {
        files.iter().map(|(file, code)| ((*file).to_owned(), code_of(code))).collect()
    };
    let parent =
        ("gas/mod.rs", "mod one; mod other; pub use one::{Big, Small}; pub use other::Far;");
    for text in [
        "use super::one::Big;",
        "use super::{Big, Medium};",
        "use crate::gas::Small;",
        "fn f() { super::one::make() }",
    ] {
        let one = ("gas/one.rs", "use super::other::Far; pub struct Big;");
        let closed = circles(&files(&[parent, one, ("gas/other.rs", text)]));
        let expected = vec![("gas".to_owned(), vec!["one".to_owned(), "other".to_owned()])];
        assert_eq!(closed, expected, "{text}");
        let (one, other) =
            (("gas/drag/one.rs", one.1), ("gas/drag/other.rs", "use crate::gas::Big;"));
        assert!(circles(&files(&[parent, one, other])).is_empty(), "another folder's names");
    }
    for text in
        ["use super::Medium;", "#[cfg(test)] mod tests { use super::one; }", "// super::one"]
    {
        let one = ("gas/one.rs", "use super::Far;");
        assert!(circles(&files(&[parent, one, ("gas/other.rs", text)])).is_empty(), "{text}");
    }
}

#[test]
fn the_table_is_read_as_it_is_shown() {
    let document = "# A\n\n## Layers\n\n| module | uses | not |\n| --- | --- | --- |\n\
                    | `one` | - | x |\n| `two` | one, three | |\n\n## Next\n\n| `four` | two | |\n";
    let table = table_in(document);
    assert_eq!(table.keys().collect::<Vec<_>>(), ["one", "two"]);
    assert!(table["one"].is_empty());
    assert_eq!(table["two"].iter().collect::<Vec<_>>(), ["one", "three"]);
}
