//! `talcum keys`: what may stand in a case file, or in a study file.

use super::run::say;
use crate::input::FileKeys;
use crate::parallel::Communicator;
use crate::{case, study};
use clap::{Args, Subcommand};

#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, disable_help_subcommand = true)]
pub(super) struct KeysOptions {
    #[command(subcommand)]
    file: Option<OtherFile>,
    /// A section, for example contact or particles.start; one of its keys, or what belongs to a word, as gas.substeps
    /// or measure.stress; all if none is given.
    section: Option<String>,
    #[command(flatten)]
    form: Form,
}

/// A file that is no case.
#[derive(Debug, Subcommand)]
enum OtherFile {
    /// Print the keys of the study file instead.
    Study {
        /// A section, for example axis; one of its keys, or what belongs to a word, as bisection.bracket or
        /// measure.analysis; all if none is given.
        section: Option<String>,
        #[command(flatten)]
        form: Form,
    },
}

/// What is made of the keys, if not a list for the terminal.
#[derive(Debug, Args)]
struct Form {
    /// Print a JSON schema for editors instead.
    #[arg(long, conflicts_with = "section")]
    json_schema: bool,
    /// Print the manual, a page of the book, instead.
    #[arg(long, hide = true, conflicts_with_all = ["section", "json_schema"])]
    markdown: bool,
}

/// Prints keys with unit, range, default and meaning.
pub(super) fn keys(options: &KeysOptions, ranks: &dyn Communicator) -> anyhow::Result<()> {
    let text = match &options.file {
        None => options.form.text(&case::FILE_KEYS, options.section.as_deref())?,
        Some(OtherFile::Study { section, form }) => {
            form.text(&study::FILE_KEYS, section.as_deref())?
        }
    };
    say(ranks, text.trim_end())
}

impl Form {
    fn text(&self, file: &FileKeys, section: Option<&str>) -> anyhow::Result<String> {
        match self {
            Self { json_schema: true, .. } => Ok(file.json_schema()),
            Self { markdown: true, .. } => Ok(file.manual()),
            _ => Ok(file.terminal(section)?),
        }
    }
}
