//! `talcum analyse`.

use super::complain;
use crate::post_processing::{
    ANALYSES, Analysis, Findings, Results, TimeWindow, list, report, write_analysis,
};
use anyhow::{Context, bail};
use clap::Args;
use std::path::PathBuf;
use std::process::ExitCode;
use talcum_results::output::{OutputError, print};

/// Options of `talcum analyse`.
#[derive(Clone, Debug, Args)]
pub(super) struct AnalyseOptions {
    /// The folder of results; the run may still be in progress.
    #[arg(required_unless_present = "list")]
    results: Option<PathBuf>,
    /// Do only this analysis; may be repeated.
    #[arg(long = "analysis", alias = "measure", value_name = "NAME")]
    analyses: Vec<String>,
    /// Ignore everything before this time.
    #[arg(long, value_name = "TIME")]
    from: Option<f64>,
    /// Ignore everything after this time.
    #[arg(long, value_name = "TIME")]
    to: Option<f64>,
    /// Write analysis.h5 to this folder, instead of to the folder of results.
    #[arg(long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Only list the analyses and the names of their numbers.
    #[arg(long)]
    list: bool,
}

/// Takes the analyses on the results of a run, prints the findings and writes them to `analysis.h5`. The exit code is 1
/// if an existing file could not be read.
pub(super) fn analyse(options: &AnalyseOptions) -> anyhow::Result<ExitCode> {
    let folder = match &options.results {
        Some(folder) if !options.list => folder,
        _ => {
            print(list().trim_end())?;
            return Ok(ExitCode::SUCCESS);
        }
    };
    let analyses = options.chosen()?;
    let results = Results::open(folder, options.window()?)?;
    let mut found: Vec<(&Analysis, Findings)> = Vec::new();
    let mut unreadable: Vec<OutputError> = Vec::new();
    for analysis in analyses {
        match analysis.take(&results) {
            Ok(findings) => {
                print(&report(analysis, &findings))?;
                found.push((analysis, findings));
            }
            Err(error) if unreadable.contains(&error) => {}
            Err(error) => unreadable.push(error),
        }
    }
    let output = options.output.as_ref().unwrap_or(folder);
    std::fs::create_dir_all(output).with_context(|| output.display().to_string())?;
    let path = output.join("analysis.h5");
    let digest = write_analysis(&path, &results, &found)?;
    print(&format!("wrote {}\ntables {digest}", path.display()))?;
    let is_whole = unreadable.is_empty();
    unreadable.into_iter().for_each(|error| complain(&error.into()));
    Ok(if is_whole { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

impl AnalyseOptions {
    fn window(&self) -> anyhow::Result<TimeWindow> {
        let from = self.from.unwrap_or(TimeWindow::WHOLE.from);
        let to = self.to.unwrap_or(TimeWindow::WHOLE.to);
        if from.is_nan() || to.is_nan() || from > to {
            bail!("--from {from} --to {to}: the first must not be after the last");
        }
        Ok(TimeWindow { from, to })
    }

    /// The requested analyses; all if none is named.
    fn chosen(&self) -> anyhow::Result<Vec<&'static Analysis>> {
        if self.analyses.is_empty() {
            return Ok(ANALYSES.to_vec());
        }
        let named = |name: &String| {
            Analysis::named(name).with_context(|| {
                let known: Vec<&str> = ANALYSES.iter().map(|analysis| analysis.name).collect();
                format!(
                    "--analysis {name}: there is no such analysis; there are {}",
                    known.join(", ")
                )
            })
        };
        self.analyses.iter().map(named).collect()
    }
}
