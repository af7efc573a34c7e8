//! `talcum completions` and `talcum manual`: files for shells and `man`. Both are made from the commands themselves, so
//! packages make them when they are built.

use anyhow::Context;
use clap::{Args, Command};
use clap_complete::Shell;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use talcum_results::output::print;

#[derive(Debug, Args)]
pub(super) struct CompletionsOptions {
    /// The shell.
    shell: Shell,
}

#[derive(Debug, Args)]
pub(super) struct ManualOptions {
    /// Write the pages to this folder, for example share/man/man1; it is created if it does not exist.
    folder: PathBuf,
}

/// Prints the completions of a shell.
pub(super) fn completions(
    options: &CompletionsOptions,
    mut command: Command,
) -> anyhow::Result<ExitCode> {
    // The text is first written to memory, since the generator panics if standard output is closed.
    let mut text = Vec::new();
    clap_complete::generate(options.shell, &mut command, "talcum", &mut text);
    print(String::from_utf8_lossy(&text).trim_end())?;
    Ok(ExitCode::SUCCESS)
}

/// Writes the manual pages.
pub(super) fn manual(options: &ManualOptions, command: Command) -> anyhow::Result<ExitCode> {
    write_pages(&options.folder, command).with_context(|| {
        format!("{}: the manual pages cannot be written", options.folder.display())
    })?;
    Ok(ExitCode::SUCCESS)
}

fn write_pages(folder: &Path, command: Command) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    clap_mangen::generate_to(command.disable_help_subcommand(true), folder)
}
