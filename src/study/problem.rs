//! What is wrong with a study file, and with the cases of its runs: every error with its line, key, value and what is
//! allowed.

use crate::input::{InputError, InputErrors, SourcePlace};
use crate::study::setting::Setting;
use std::cell::RefCell;
use std::fmt;
use thiserror::Error;

/// One error of a study file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Problem {
    /// Line in the study file, from 1; `None` for the file as a whole.
    pub(crate) line: Option<usize>,
    /// Path of the key, for example `bisection.tolerance`; empty if the error belongs to no key.
    pub(crate) key: String,
    /// The value as it was written, if there is one.
    pub(crate) value: Option<String>,
    /// What is wrong, or what is allowed.
    pub(crate) message: String,
}

/// All errors of a study file, in the order of its lines; at least one.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub(crate) struct Refusal {
    /// Name of the file as the user gave it.
    pub(crate) file: String,
    /// The errors.
    pub(crate) problems: Vec<Problem>,
}

/// No more errors than these are printed.
const MOST_PRINTED: usize = 20;

impl fmt::Display for Refusal {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, problem) in self.problems.iter().take(MOST_PRINTED).enumerate() {
            if index > 0 {
                writeln!(formatter)?;
            }
            write!(formatter, "{}", self.file)?;
            if let Some(line) = problem.line {
                write!(formatter, ":{line}")?;
            }
            if !problem.key.is_empty() {
                write!(formatter, ": {}", problem.key)?;
                if let Some(value) = &problem.value {
                    write!(formatter, " = {value}")?;
                }
            }
            write!(formatter, ": {}", problem.message)?;
        }
        match self.problems.len().saturating_sub(MOST_PRINTED) {
            0 => Ok(()),
            more => write!(formatter, "\nand {more} more"),
        }
    }
}

/// Collects errors while a file is read.
#[derive(Debug, Default)]
pub(crate) struct Problems(RefCell<Vec<Problem>>);

impl Problems {
    /// Adds an error, once.
    pub(crate) fn add(&self, problem: Problem) {
        let mut problems = self.0.borrow_mut();
        if !problems.contains(&problem) {
            problems.push(problem);
        }
    }

    /// Adds an error of the file as a whole.
    pub(crate) fn add_whole(&self, message: impl Into<String>) {
        let message = message.into();
        self.add(Problem { line: None, key: String::new(), value: None, message });
    }

    /// The value if nothing is wrong, else the errors in the order of their lines.
    pub(crate) fn result<T>(self, file: &str, value: Option<T>) -> Result<T, Refusal> {
        let mut problems = self.0.into_inner();
        match value {
            Some(value) if problems.is_empty() => Ok(value),
            _ => {
                problems.sort_by_key(|problem| problem.line);
                Err(Refusal { file: file.to_owned(), problems })
            }
        }
    }
}

/// One error of the case of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct CaseProblem {
    /// The setting, as `key=value`, to which the error belongs; `None` if the case file itself is wrong.
    pub(crate) setting: Option<String>,
    /// Key, value and what is allowed; the file and its line come first if `setting` is `None`.
    pub(crate) message: String,
}

impl CaseProblem {
    /// An error of the case file itself.
    pub(crate) fn of_file(message: String) -> Self {
        Self { setting: None, message }
    }

    /// All errors of a case.
    pub(crate) fn all_of(InputErrors { file_name, errors }: InputErrors) -> Vec<Self> {
        let problem = |error: InputError| {
            let SourcePlace::Override(setting) = &error.place else {
                let whole = InputErrors { file_name: file_name.clone(), errors: vec![error] };
                return Self::of_file(whole.to_string());
            };
            let subject = match (&*error.key, &error.value) {
                ("", _) => setting.clone(),
                (key, Some(value)) => format!("{key} = {value}"),
                (key, None) => key.to_owned(),
            };
            let message = format!("{subject}: {}", error.message);
            Self { setting: Some(setting.clone()), message }
        };
        errors.into_iter().map(problem).collect()
    }

    /// The error with the line of the study file that made the setting.
    pub(crate) fn place(self, settings: &[Setting]) -> Problem {
        let Self { setting, message } = self;
        let argument = |given: &&Setting| Some(given.argument()) == setting;
        let line = settings.iter().find(argument).map(|given| given.line);
        // What the study itself sets stands at no line.
        let line = line.filter(|&line| line > 0);
        Problem { line, key: String::new(), value: None, message }
    }
}

impl From<CaseProblem> for String {
    fn from(problem: CaseProblem) -> Self {
        problem.message
    }
}
