//! The work of `talcum analyse`: it reads the results of a run, and evaluates them by the functions of
//! [`analysis`](talcum_results::analysis).
//!
//! A measure is a file in `measures/` and its line in the list there. It takes its data from [`Results`], whose errors
//! name the key of the case that would have given a missing file. Its numbers have names such as `waves.speed`, by
//! which studies request them. An existing file that cannot be read is an error.
//!
//! Measures need no ranks, and their findings do not depend on the ranks of the run.

mod analysis_file;
mod evenly_spaced;
mod findings;
mod measures;
mod report;
mod result_file;
mod results;

pub use analysis_file::write as write_analysis;
pub use findings::{Findings, Kind, Scalar, Unmeasured, Value};
pub use measures::MEASURES;
pub use report::{list, report};
pub use results::{Results, TimeWindow};

use std::fmt;
use talcum_results::analysis::NoValue;
use talcum_results::output::OutputError;
use talcum_runs::case::Case;

/// A measure in the list of all.
#[derive(Debug)]
pub struct Measure {
    /// Its name, and that of its group in the analysis file.
    pub name: &'static str,
    /// Its heading in the summary.
    pub title: &'static str,
    /// The numbers and texts that it may give; one with an empty name has the name of the measure itself.
    pub scalars: fn() -> Vec<Kind>,
    /// Whether a run of this case gives it, as far as the case shows.
    pub of_case: fn(&Case) -> Result<(), NoValue>,
    /// Evaluates the results.
    pub find: fn(&Results) -> Result<Findings, Unmeasured>,
}

impl Measure {
    /// The measure with this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        MEASURES.iter().copied().find(|measure| measure.name == name)
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

/// A number or text of a measure, by its full name: `waves.speed`, or `u_mf`.
#[derive(Clone, Debug)]
pub struct ScalarName {
    /// Its measure.
    pub measure: &'static Measure,
    /// Its kind.
    pub kind: Kind,
}

impl fmt::Display for ScalarName {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&full_name(self.measure, &self.kind))
    }
}

/// The name by which a number or text is requested.
fn full_name(measure: &Measure, kind: &Kind) -> String {
    match kind.name {
        "" => measure.name.to_owned(),
        name => format!("{}.{name}", measure.name),
    }
}

/// All names, measure by measure.
fn scalars() -> impl Iterator<Item = ScalarName> {
    let of_measure = |measure: &&'static Measure| {
        let measure = *measure;
        (measure.scalars)().into_iter().map(move |kind| ScalarName { measure, kind })
    };
    MEASURES.iter().flat_map(of_measure)
}

/// The number or text with a full name.
pub fn scalar_named(name: &str) -> Option<ScalarName> {
    scalars().find(|scalar| scalar.to_string() == name)
}

/// All full names.
pub fn scalar_names() -> Vec<String> {
    scalars().map(|scalar| scalar.to_string()).collect()
}
