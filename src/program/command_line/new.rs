//! `talcum new`: a commented case to begin with, from the gallery (docs/gallery.md).

use anyhow::anyhow;
use clap::Args;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use talcum_results::output::{print, write_whole};

/// The cases of the gallery: the name of each, and its file.
pub type Gallery = [(&'static str, &'static str)];

#[derive(Debug, Args)]
pub(super) struct NewOptions {
    /// Name of the case; without it, all cases are listed.
    #[arg(value_name = "NAME")]
    kind: Option<String>,
    /// Write to this file, which must not exist (default: NAME.toml in the current folder).
    #[arg(long, value_name = "FILE", requires = "kind")]
    output: Option<PathBuf>,
}

/// Writes a case, or lists the available ones.
pub(super) fn new(options: &NewOptions, gallery: &Gallery) -> anyhow::Result<ExitCode> {
    let Some(kind) = &options.kind else {
        print(&list(gallery))?;
        return Ok(ExitCode::SUCCESS);
    };
    let (_, case) = gallery
        .iter()
        .find(|(name, _)| name == kind)
        .ok_or_else(|| anyhow!("{kind:?}: there is no such case; there are:\n{}", list(gallery)))?;
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
fn list(gallery: &Gallery) -> String {
    let line = |(name, case): &(&str, &str)| {
        let what = case.lines().next().unwrap_or_default().trim_start_matches("# ");
        format!("{name:<18}{what}")
    };
    gallery.iter().map(line).collect::<Vec<_>>().join("\n")
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
