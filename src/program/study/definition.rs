//! The definition of a study, from its file.

use crate::study::bisection::Bisection;
use crate::study::quantity::NamedQuantity;
use crate::study::setting::{Setting, Value};
use crate::study::start::Start;
use std::path::PathBuf;

/// A study as described by its file.
#[derive(Debug)]
pub(crate) struct Study {
    /// Path of the study file, as given by the user.
    pub(crate) file: PathBuf,
    /// Title given by the user.
    pub(crate) title: String,
    /// The case of all runs.
    pub(crate) case: PathBuf,
    /// Settings of all runs.
    pub(crate) common: Vec<Setting>,
    /// The axes of the grid; the last one varies fastest.
    pub(crate) axes: Vec<Axis>,
    /// The axis that is varied to measure scatter, usually the seed.
    pub(crate) replicates: Option<Axis>,
    /// The other study with whose ends the runs begin.
    pub(crate) start: Option<Start>,
    /// Set if runs start with the last state of the previous one.
    pub(crate) continuation: Option<Continuation>,
    /// The search for a critical value.
    pub(crate) bisection: Option<Bisection>,
    /// The quantities that are taken from every run.
    pub(crate) quantities: Vec<NamedQuantity>,
    /// Confidence level of the intervals, for example 0.95.
    pub(crate) confidence: f64,
    /// Ranks and programs.
    pub(crate) resources: Resources,
}

/// One axis of the grid: keys that move together, and the values that they take.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Axis {
    /// Its name in the study: the given name, or its first key.
    pub(crate) name: String,
    /// Keys of the case.
    pub(crate) keys: Vec<String>,
    /// One value for each key, for each position on the axis.
    pub(crate) values: Vec<Vec<Value>>,
    /// The line of the study file, from 1.
    pub(crate) line: usize,
}

impl Axis {
    /// The settings at a position on the axis.
    pub(crate) fn settings(&self, position: usize) -> Vec<Setting> {
        let values = self.values.get(position).map(Vec::as_slice).unwrap_or_default();
        let pairs = self.keys.iter().zip(values);
        let setting = |(key, value): (&String, &Value)| Setting {
            key: key.clone(),
            value: value.clone(),
            line: self.line,
        };
        pairs.map(setting).collect()
    }

    /// Whether two positions on the axis have the same values.
    pub(crate) fn repeats(&self) -> bool {
        let same = |one: &[Value], two: &[Value]| one.iter().zip(two).all(|(a, b)| a.same_as(b));
        let values = &self.values;
        (1..values.len()).any(|later| values[..later].iter().any(|old| same(old, &values[later])))
    }
}

/// A chain of runs along an axis, each of which starts with the last state of the previous one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Continuation {
    /// Position of the axis in [`Study::axes`].
    pub(crate) axis: usize,
    /// The stage with which continued runs begin; the stages before it are left out.
    pub(crate) from_stage: Option<String>,
    /// Values that only continued runs take.
    pub(crate) settings: Vec<Setting>,
}

/// Resources for starting runs.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Resources {
    /// Ranks of each run.
    pub(crate) ranks: u64,
    /// Number of runs that work at the same time.
    pub(crate) at_a_time: u64,
    /// Launcher of a run with several ranks.
    pub(crate) launcher: Launcher,
}

/// Launcher of a program on several ranks.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Launcher {
    /// None: the ranks are threads.
    Threads,
    /// The words of a command; `{ranks}` is replaced by the number of ranks.
    Command(Vec<String>),
}

impl Launcher {
    /// Reads a text from a study or the command line: the word `threads`, or a command.
    pub(crate) fn from_text(text: &str) -> Self {
        match text.trim() {
            "threads" => Self::Threads,
            command => Self::Command(command.split_whitespace().map(str::to_owned).collect()),
        }
    }
}

impl Default for Launcher {
    fn default() -> Self {
        Self::from_text(if cfg!(feature = "mpi") { "mpirun -n {ranks}" } else { "threads" })
    }
}

impl Study {
    /// All keys of the case that the study varies, in the order of its axes; seeds come last.
    pub(crate) fn varied_keys(&self) -> Vec<String> {
        let of_axes = self.axes.iter().flat_map(|axis| axis.keys.iter().cloned());
        let searched = self.bisection.iter().map(|bisection| bisection.key.clone());
        let replicated = self.replicates.iter().flat_map(|axis| axis.keys.iter().cloned());
        of_axes.chain(searched).chain(replicated).collect()
    }

    /// All settings in the study.
    pub(crate) fn all_settings(&self) -> Vec<Setting> {
        let of_axis = |axis: &Axis| {
            (0..axis.values.len()).flat_map(|position| axis.settings(position)).collect::<Vec<_>>()
        };
        let axes = self.axes.iter().chain(&self.replicates).flat_map(of_axis);
        let continued = self.continuation.iter().flat_map(|c| c.settings.iter().cloned());
        self.common.iter().cloned().chain(axes).chain(continued).collect()
    }

    /// Number of replicates of each point.
    pub(crate) fn replicate_count(&self) -> usize {
        self.replicates.as_ref().map_or(1, |axis| axis.values.len())
    }
}
