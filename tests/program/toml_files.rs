//! The case files and the study files of a folder of the repository.

use std::path::{Path, PathBuf};

/// All TOML files in a folder of the repository and in the folders in it, by ascending path; those in folders `studies` are
/// no cases.
pub(crate) fn toml_files(folder: &str) -> Vec<PathBuf> {
    files_below(folder).into_iter().filter(|path| !is_of_study(path)).collect()
}

/// All TOML files in folders `studies` of a folder of the repository, by ascending path.
pub(crate) fn study_files(folder: &str) -> Vec<PathBuf> {
    files_below(folder).into_iter().filter(|path| is_of_study(path)).collect()
}

fn is_of_study(path: &Path) -> bool {
    path.parent().is_some_and(|folder| folder.ends_with("studies"))
}

fn files_below(folder: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("folders of the repository are readable") {
            let path = entry.expect("folders of the repository are readable").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "toml") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}
