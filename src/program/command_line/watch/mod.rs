//! `talcum watch`: a run in progress, in the terminal or in a browser.
//!
//! `run/` reads the folder of results and changes nothing in it; `terminal/`, `serve/` and `plain.rs` display the data.

mod columns;
mod plain;
mod run;
mod serve;
mod terminal;
mod thinning;

use self::columns::check_columns;
use self::run::WatchedRun;
use self::serve::Address;
use clap::Args;
use std::io::{IsTerminal, stdout};
use std::path::PathBuf;
use std::process::ExitCode;
use talcum_results::output::print;

/// Options of `talcum watch`.
#[derive(Clone, Debug, Args)]
pub(super) struct WatchOptions {
    /// The folder of results; the run may be in progress, finished, or about to start.
    results: PathBuf,
    /// Draw these columns of series.csv (default: a few of those that vary).
    #[arg(long, value_name = "NAME,NAME,...", value_delimiter = ',')]
    columns: Vec<String>,
    /// Print one report and exit, as is done without a terminal.
    #[arg(long, conflicts_with = "serve")]
    once: bool,
    /// Serve a page for the browser instead, at a port of this machine, or at an address with a port.
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, default_missing_value = serve::DEFAULT)]
    serve: Option<Address>,
}

/// Shows a run until the user leaves; without a terminal, once.
pub(super) fn watch(options: &WatchOptions) -> anyhow::Result<ExitCode> {
    let mut run = WatchedRun::open(&options.results)?;
    check_columns(&options.columns, run.series())?;
    match options.serve {
        Some(address) => serve::serve(run, options.columns.clone(), address)?,
        None if options.once || !stdout().is_terminal() => {
            print(plain::report(&run, &options.columns).trim_end())?;
        }
        None => terminal::show(&mut run, &options.columns)?,
    }
    Ok(ExitCode::SUCCESS)
}
