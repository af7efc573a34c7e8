//! The work of `talcum analyse`: it reads the results of a run, and evaluates them by the functions of
//! [`analysis`](talcum_results::analysis).
//!
//! An analysis is a file in `analyses/` and its line in the list there. It takes its data from [`Results`], whose errors
//! name the key of the case that would have given a missing file. Its numbers have names such as `waves.speed`, by
//! which studies request them. An existing file that cannot be read is an error.
//!
//! Analyses need no ranks, and their findings do not depend on the ranks of the run.

mod analyses;
mod analysis_file;
mod evenly_spaced;
mod findings;
mod report;
mod result_file;
mod results;

pub use analyses::ANALYSES;
pub use analysis_file::write as write_analysis;
pub use findings::{Findings, Kind, Scalar, Unmeasured, Value};
pub use report::{list, report};
pub use results::{Results, TimeWindow};

use std::fmt;
use talcum_results::analysis::NoValue;
use talcum_results::output::OutputError;
use talcum_runs::case::Case;

/// An analysis in the list of all.
#[derive(Debug)]
pub struct Analysis {
    /// Its name, and that of its group in the analysis file.
    pub name: &'static str,
    /// Its heading in the summary.
    pub title: &'static str,
    /// The numbers and texts that it may give; one with an empty name has the name of the analysis itself.
    pub scalars: fn() -> Vec<Kind>,
    /// Whether a run of this case gives it, as far as the case shows.
    pub of_case: fn(&Case) -> Result<(), NoValue>,
    /// Evaluates the results.
    pub find: fn(&Results) -> Result<Findings, Unmeasured>,
}

impl Analysis {
    /// The analysis with this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        ANALYSES.iter().copied().find(|analysis| analysis.name == name)
    }

    /// Its findings; only the reason if the results do not allow it.
    ///
    /// # Errors
    /// If an existing file cannot be read.
    pub fn take(&self, results: &Results) -> Result<Findings, OutputError> {
        match (self.find)(results) {
            Ok(found) => Ok(found),
            Err(Unmeasured::Nothing(reason)) => {
                Ok(Findings::nothing((self.scalars)(), results.units(), &reason))
            }
            Err(Unmeasured::Unreadable(error)) => Err(error),
        }
    }
}

/// A number or text of an analysis, by its full name: `waves.speed`, or `u_mf`.
#[derive(Clone, Debug)]
pub struct ScalarName {
    /// Its analysis.
    pub analysis: &'static Analysis,
    /// Its kind.
    pub kind: Kind,
}

impl fmt::Display for ScalarName {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&full_name(self.analysis, &self.kind))
    }
}

/// The name by which a number or text is requested.
fn full_name(analysis: &Analysis, kind: &Kind) -> String {
    match kind.name {
        "" => analysis.name.to_owned(),
        name => format!("{}.{name}", analysis.name),
    }
}

/// All names, analysis by analysis.
fn scalars() -> impl Iterator<Item = ScalarName> {
    let of_analysis = |analysis: &&'static Analysis| {
        let analysis = *analysis;
        (analysis.scalars)().into_iter().map(move |kind| ScalarName { analysis, kind })
    };
    ANALYSES.iter().flat_map(of_analysis)
}

/// The number or text with a full name.
pub fn scalar_named(name: &str) -> Option<ScalarName> {
    scalars().find(|scalar| scalar.to_string() == name)
}

/// All full names.
pub fn scalar_names() -> Vec<String> {
    scalars().map(|scalar| scalar.to_string()).collect()
}
