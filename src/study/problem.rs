//! What is wrong with a study, and with the cases of its runs.

use crate::input::{InputError, InputErrors, Problems, SourcePlace};
use crate::study::setting::Setting;
use std::path::Path;

/// An error of a key, at a line of the study file; line 0 stands for the file as a whole.
pub(crate) fn error_at(line: usize, key: impl Into<String>, message: String) -> InputError {
    let place = if line == 0 { SourcePlace::File } else { SourcePlace::Line(line) };
    InputError { place, key: key.into(), value: None, message }
}

/// No more errors than these are kept: each run of a study may have its own.
const MOST_KEPT: usize = 20;

/// The value if nothing is wrong with a study, else the errors.
pub(crate) fn result<T>(
    problems: Problems,
    file: &Path,
    value: Option<T>,
) -> Result<T, InputErrors> {
    let result = problems.result(&file.display().to_string(), value);
    result.map_err(|errors| errors.first(MOST_KEPT))
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
    pub(crate) fn place(self, settings: &[Setting]) -> InputError {
        let Self { setting, message } = self;
        let argument = |given: &&Setting| Some(given.argument()) == setting;
        // What the study itself sets stands at line 0.
        let line = settings.iter().find(argument).map_or(0, |given| given.line);
        error_at(line, "", message)
    }
}

impl From<CaseProblem> for String {
    fn from(problem: CaseProblem) -> Self {
        problem.message
    }
}
