//! Circles of imports inside a folder: files of one folder, or its subfolders, that import each other.

use super::source::{leaves, module_of, paths_into_the_crate, tokens};
use std::collections::{BTreeMap, BTreeSet};

/// Who knows whom inside a folder: files and folders directly in it, by name.
type Edges = BTreeMap<String, BTreeSet<String>>;

/// Names that the `mod.rs` of a folder takes from its modules, and from which.
fn re_exports(tokens: &[&str], modules: &BTreeSet<String>) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    for (at, _) in tokens.iter().enumerate().filter(|(_, token)| **token == "use") {
        let rest = &tokens[at + 1..];
        let rest = if rest.first() == Some(&"self") { &rest[2..] } else { rest };
        for leaf in leaves(rest) {
            if let ([first, .., last], true) = (&leaf[..], modules.contains(leaf[0])) {
                found.insert((*last).to_owned(), (*first).to_owned());
            }
        }
    }
    found
}

/// The edges between the modules of one folder, given all files as (path, code). Names that a parent re-exports count as
/// knowing the module that they come from.
fn edges_in(folder: &[&str], files: &[(String, String)]) -> Edges {
    let inside = |file: &str| {
        let path = module_of(file);
        let below = path.strip_prefix(folder)?;
        below.first().map(|first| (*first).to_owned())
    };
    let modules: BTreeSet<String> = files.iter().filter_map(|(file, _)| inside(file)).collect();
    let root = files.iter().find(|(file, _)| module_of(file) == folder);
    let exported = root.map(|(_, code)| re_exports(&tokens(code), &modules)).unwrap_or_default();
    let mut edges = Edges::new();
    for (file, code) in files {
        let Some(own) = inside(file) else { continue };
        for path in paths_into_the_crate(file, &tokens(code)) {
            let Some([next, ..]) = path.strip_prefix(folder) else { continue };
            let known = modules.get(*next).or_else(|| exported.get(*next));
            if let Some(known) = known.filter(|known| **known != own) {
                edges.entry(own.clone()).or_default().insert(known.clone());
            }
        }
    }
    edges
}

/// All that a module knows, directly or through others.
fn known_by(module: &str, edges: &Edges) -> BTreeSet<String> {
    let mut known = BTreeSet::new();
    let mut open = vec![module.to_owned()];
    while let Some(next) = open.pop() {
        for other in edges.get(&next).into_iter().flatten() {
            if known.insert(other.clone()) {
                open.push(other.clone());
            }
        }
    }
    known
}

/// The modules of each folder that know themselves through others: (folder, modules).
pub(crate) fn circles(files: &[(String, String)]) -> Vec<(String, Vec<String>)> {
    let folders: BTreeSet<Vec<&str>> = files
        .iter()
        .map(|(file, _)| module_of(file))
        .flat_map(|path| (1..path.len()).map(move |length| path[..length].to_vec()))
        .collect();
    let mut found = Vec::new();
    for folder in folders {
        let edges = edges_in(&folder, files);
        let closed = edges.keys().filter(|module| known_by(module, &edges).contains(*module));
        let closed: Vec<String> = closed.cloned().collect();
        if !closed.is_empty() {
            found.push((folder.join("/"), closed));
        }
    }
    found
}
