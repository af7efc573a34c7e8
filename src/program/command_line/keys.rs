//! `talcum keys`: the keys of case files and study files.

use super::run::say;
use crate::study;
use clap::{Args, Subcommand};
use talcum_engine::parallel::Communicator;
use talcum_runs::case;
use talcum_runs::input::FileKeys;

#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, disable_help_subcommand = true)]
pub(super) struct KeysOptions {
    #[command(subcommand)]
    file: Option<OtherFile>,
    /// A section (contact, particles.start), a key (gas.substeps), or a word that brings keys (measure.stress); without it,
    /// all sections are printed.
    section: Option<String>,
    #[command(flatten)]
    form: Form,
}

/// A file that is no case.
#[derive(Debug, Subcommand)]
enum OtherFile {
    /// Print the keys of the study file instead.
    Study {
        /// A section (axis), a key (bisection.bracket), or a word that brings keys (measure.analysis); without it, all
        /// sections are printed.
        section: Option<String>,
        #[command(flatten)]
        form: Form,
    },
}

/// The form in which the keys are printed, if not as text for the terminal.
#[derive(Debug, Args)]
struct Form {
    /// Print a JSON schema for editors, instead of text.
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
