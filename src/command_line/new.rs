//! `talcum new`: a commented case to begin with, from the gallery (docs/gallery.md).

use crate::output::{print, write_whole};
use anyhow::anyhow;
use clap::Args;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// The cases by name: whole files of the repository.
const CASES: [(&str, &str); 12] = [
    ("travelling-waves", include_str!("../../cases/gallery/travelling-waves.toml")),
    ("cohesive-plug", include_str!("../../cases/gallery/cohesive-plug.toml")),
    ("vibrated-bed", include_str!("../../cases/gallery/vibrated-bed.toml")),
    ("bubbling-bed", include_str!("../../cases/gallery/bubbling-bed.toml")),
    ("spout", include_str!("../../cases/gallery/spout.toml")),
    ("round-column", include_str!("../../cases/gallery/round-column.toml")),
    ("pulsed-bed", include_str!("../../cases/gallery/pulsed-bed.toml")),
    ("segregation", include_str!("../../cases/gallery/segregation.toml")),
    ("moving-wall", include_str!("../../cases/gallery/moving-wall.toml")),
    ("agglomerates", include_str!("../../cases/gallery/agglomerates.toml")),
    ("two-species", include_str!("../../cases/gallery/two-species.toml")),
    ("heap", include_str!("../../cases/gallery/heap.toml")),
];

#[derive(Debug, Args)]
pub(super) struct NewOptions {
    /// Name of the case; without it, all are listed.
    kind: Option<String>,
    /// The file, which must not exist (default: KIND.toml in this folder).
    #[arg(long, value_name = "FILE", requires = "kind")]
    output: Option<PathBuf>,
}

/// Writes a case, or lists the available ones.
pub(super) fn new(options: &NewOptions) -> anyhow::Result<ExitCode> {
    let Some(kind) = &options.kind else {
        print(&list())?;
        return Ok(ExitCode::SUCCESS);
    };
    let (_, case) = CASES
        .into_iter()
        .find(|(name, _)| name == kind)
        .ok_or_else(|| anyhow!("{kind:?}: there is no such case; there are:\n{}", list()))?;
    let file = options.output.clone().unwrap_or_else(|| PathBuf::from(format!("{kind}.toml")));
    write(&file, case)
        .map_err(|error| anyhow!("{}: cannot be written: {error}", file.display()))?;
    let results = Path::new("results").join(file.file_stem().unwrap_or_default());
    print(&format!(
        "talcum check {file}\ntalcum run {file}        # results go to {results}; --threads N for N threads\n{look}",
        file = file.display(),
        results = results.display(),
        look = second_line(case),
    ))?;
    Ok(ExitCode::SUCCESS)
}

/// Each case with its description, which is its first line.
fn list() -> String {
    let line = |(name, case): (&str, &str)| {
        let what = case.lines().next().unwrap_or_default().trim_start_matches("# ");
        format!("{name:<18}{what}")
    };
    CASES.map(line).join("\n")
}

/// The second line of a case, which names the results of interest.
fn second_line(case: &str) -> &str {
    case.lines().nth(1).unwrap_or_default()
}

/// Writes a file, unless it exists already.
fn write(path: &Path, text: &str) -> Result<(), String> {
    if path.symlink_metadata().is_ok() {
        return Err("it is there already".to_owned());
    }
    write_whole(path, text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_case_says_what_it_is_and_what_to_look_at() {
        for (name, case) in CASES {
            let lines: Vec<&str> = case.lines().take(2).collect();
            assert!(lines[0].starts_with("# ") && lines[0].ends_with('.'), "{name}");
            assert!(lines[1].starts_with("# Look at: "), "{name}");
        }
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/gallery");
        let files = std::fs::read_dir(folder).unwrap().flatten();
        let cases = files.filter(|file| file.path().extension().is_some_and(|e| e == "toml"));
        assert_eq!(cases.count(), CASES.len(), "every case of the gallery can be written");
    }
}
