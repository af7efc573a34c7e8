//! `talcum keys`: what may stand in a case file.

use super::run::say;
use crate::case::FILE_KEYS;
use crate::parallel::Communicator;
use clap::Args;

#[derive(Debug, Args)]
pub(super) struct KeysOptions {
    /// A section, for example contact or particles.start; one of its keys, or what belongs to a word, as gas.substeps
    /// or measure.stress; all if none is given.
    section: Option<String>,
    /// Print a JSON schema for editors instead.
    #[arg(long, conflicts_with = "section")]
    json_schema: bool,
    /// Print the manual docs/input.md instead.
    #[arg(long, hide = true, conflicts_with_all = ["section", "json_schema"])]
    markdown: bool,
}

/// Prints keys with unit, range, default and meaning.
pub(super) fn keys(options: &KeysOptions, ranks: &dyn Communicator) -> anyhow::Result<()> {
    let text = match options {
        KeysOptions { json_schema: true, .. } => FILE_KEYS.json_schema(),
        KeysOptions { markdown: true, .. } => FILE_KEYS.manual(),
        KeysOptions { section, .. } => FILE_KEYS.terminal(section.as_deref())?,
    };
    say(ranks, text.trim_end())
}
