//! Reading and checking of the cases of runs, before anything runs.

use crate::post_processing;
use crate::study::case_text::EffectiveCase;
use crate::study::problem::CaseProblem;
use crate::study::run_outline::RunOutline;
use crate::study::setting::Setting;
use std::path::{Path, PathBuf};
use talcum_runs::case::Case;

/// The case file of a run, and the settings to be made in it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CaseRequest {
    /// The case file.
    pub(crate) case: PathBuf,
    /// The settings.
    pub(crate) settings: Vec<Setting>,
}

/// Reads cases, and reports their errors.
pub(crate) trait CaseChecker {
    /// The case with its settings.
    ///
    /// # Errors
    /// If it cannot be read, or if the path of a setting does not exist.
    fn effective(&self, case: &Path, settings: &[Setting]) -> Result<EffectiveCase, CaseProblem> {
        let name = case.display().to_string();
        let of_file = |message: String| CaseProblem::of_file(format!("{name}: {message}"));
        let text = std::fs::read_to_string(case);
        let text = text.map_err(|error| of_file(format!("cannot be read: {error}")))?;
        let text = Case::text_with(&text, &name, &overrides(settings)).map_err(|errors| {
            let first = CaseProblem::all_of(errors).into_iter().next();
            first.unwrap_or_else(|| of_file("cannot be read".to_owned()))
        })?;
        EffectiveCase::parse(&text).map_err(of_file)
    }

    /// Validates a case completely, and describes the instruments of its run. The state with which the run starts need not
    /// exist yet.
    ///
    /// # Errors
    /// All its errors.
    fn check(&self, request: &CaseRequest) -> Result<RunOutline, Vec<CaseProblem>>;
}

/// Validates cases as `talcum run` does when it reads them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CaseReader;

impl CaseChecker for CaseReader {
    fn check(&self, request: &CaseRequest) -> Result<RunOutline, Vec<CaseProblem>> {
        let case = Case::read(&request.case, &overrides(&request.settings));
        let case = case.map_err(CaseProblem::all_of)?;
        let reason = |analysis: &&post_processing::Analysis| {
            Some((analysis.name, (analysis.of_case)(&case).err()?.reason().to_owned()))
        };
        Ok(RunOutline {
            end_time: case.end_time(),
            instruments: case.scalars_of_instruments(),
            impossible: post_processing::ANALYSES.iter().filter_map(reason).collect(),
        })
    }
}

fn overrides(settings: &[Setting]) -> Vec<String> {
    settings.iter().map(Setting::argument).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::setting::Value;

    fn checked(key: &str, value: f64) -> Result<RunOutline, Vec<CaseProblem>> {
        let case = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/program/study/bed.toml");
        let value = Value::from_number(value);
        let settings = vec![Setting { key: key.to_owned(), value, line: 7 }];
        CaseReader.check(&CaseRequest { case, settings })
    }

    #[test]
    fn errors_find_their_setting() {
        let outline = checked("contact.friction", 0.2).unwrap();
        assert_eq!((outline.end_time, outline.instruments.len()), (6.0, 0));
        let found = checked("contact.friction", -1.0).unwrap_err();
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].setting.as_deref(), Some("contact.friction=-1.0"));
        assert!(found[0].message.starts_with("contact.friction = -1.0: must be"), "{found:?}");
        let found = checked("stage.9.duration", 1.0).unwrap_err();
        assert!(found[0].message.starts_with("stage.9.duration=1.0: stage has no member"));
    }
}
