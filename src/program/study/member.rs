//! One run of a study: its settings, its start, and its name.

use crate::study::case_text::belongs_to_a_new_bed;
use crate::study::checker::{CaseChecker, CaseRequest};
use crate::study::definition::Study;
use crate::study::problem::CaseProblem;
use crate::study::setting::{Setting, Value};
use crate::study::start::{StartState, relative};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// One run.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Member {
    /// Number of its point, from 0.
    pub(crate) point: usize,
    /// Number of the replicate of the point, from 0.
    pub(crate) replicate: usize,
    /// Values of the keys that the study varies, seeds included.
    pub(crate) settings: Vec<Setting>,
    /// The run whose last state it begins with.
    pub(crate) predecessor: Option<Arc<Member>>,
    /// The end of a run of another study with which it begins.
    pub(crate) start: Option<Arc<StartState>>,
    /// Hash of all settings that determine its results.
    pub(crate) identity: String,
    /// Name of its folder: the differences from the other runs, and the first digits of the identity.
    pub(crate) name: String,
    /// Time at which it ends, if the case gives it.
    pub(crate) end_time: Option<f64>,
}

impl Member {
    /// The end of its name, by which a folder is found again when other keys are varied.
    pub(crate) fn mark(&self) -> &str {
        mark_of(&self.identity)
    }

    /// Identity of the state with which it begins, if this is the end of another run.
    pub(crate) fn origin_identity(&self) -> Option<&str> {
        let before = self.predecessor.as_deref().map(|before| before.identity.as_str());
        before.or(self.start.as_deref().map(|start| start.identity.as_str()))
    }

    /// The value given to a key by the study in this run.
    pub(crate) fn setting(&self, key: &str) -> Option<&Setting> {
        self.settings.iter().find(|setting| setting.key == key)
    }
}

/// Number of digits of the identity in a name: 48 bits, so that a million runs are almost certainly distinct.
const MARK_LENGTH: usize = 12;
/// Largest length of a name before the mark; file systems allow names of 255 bytes.
const LONGEST_NAME: usize = 180;
/// Largest length of a value in a name.
const LONGEST_VALUE: usize = 40;

fn mark_of(identity: &str) -> &str {
    identity.get(..MARK_LENGTH).unwrap_or(identity)
}

/// Makes the members of a study.
pub(crate) struct MemberFactory<'a> {
    study: &'a Study,
    checker: &'a dyn CaseChecker,
    /// The case of continued runs.
    continued_case: PathBuf,
    /// Ends of runs of another study with which runs begin.
    starts: Vec<Arc<StartState>>,
    /// Keys that differ between runs, with their short names.
    labels: Vec<(String, String)>,
}

impl<'a> MemberFactory<'a> {
    /// A factory; `continued_case` is the path of the case of continued runs, `starts` are the ends of runs of another
    /// study with which runs begin.
    pub(crate) fn new(
        study: &'a Study,
        checker: &'a dyn CaseChecker,
        continued_case: PathBuf,
        starts: Vec<StartState>,
    ) -> Self {
        let starts = starts.into_iter().map(Arc::new).collect();
        let varied = study.axes.iter().chain(&study.replicates);
        let differing = varied.filter(|axis| axis.values.len() > 1);
        let mut keys: Vec<String> = differing.flat_map(|axis| axis.keys.iter().cloned()).collect();
        keys.extend(study.bisection.iter().map(|search| search.key.clone()));
        // Seeds come last in a name, after the key of a search.
        let replicated =
            |key: &String| study.replicates.as_ref().is_some_and(|axis| axis.keys.contains(key));
        keys.sort_by_key(replicated);
        let labels = keys.iter().map(|key| (key.clone(), short_name(key, &keys))).collect();
        Self { study, checker, continued_case, starts, labels }
    }

    /// A run.
    ///
    /// # Errors
    /// If the case cannot be read.
    pub(crate) fn member(
        &self,
        point: usize,
        replicate: usize,
        settings: Vec<Setting>,
        predecessor: Option<Arc<Member>>,
    ) -> Result<Member, CaseProblem> {
        let request = self.request(&settings, predecessor.as_deref(), None);
        let case = self.checker.effective(&request.case, &request.settings)?;
        let belongs = |start: &&Arc<StartState>| start.belongs_to(&settings);
        let start = self.starts.iter().find(belongs).filter(|_| predecessor.is_none()).cloned();
        let (identity, name, end_time) = (String::new(), String::new(), case.end_time());
        let mut member =
            Member { point, replicate, settings, predecessor, start, identity, name, end_time };
        member.identity = case.identity(member.origin_identity());
        member.name = self.name(&member.settings, &member.identity);
        Ok(member)
    }

    /// The case of a run and all settings in it; `start` is the checkpoint with which it begins, if this is the end of
    /// another run.
    pub(crate) fn request(
        &self,
        settings: &[Setting],
        predecessor: Option<&Member>,
        start: Option<&Path>,
    ) -> CaseRequest {
        let all = self.study.common.iter().chain(settings).cloned();
        let Some(predecessor) = predecessor else {
            let case = self.study.case.clone();
            let start = start.map(|checkpoint| self.start_path(checkpoint));
            return CaseRequest { case, settings: all.chain(start).collect() };
        };
        let of_continued = self.study.continuation.iter().flat_map(|c| c.settings.iter().cloned());
        let mut settings: Vec<Setting> = all.chain(of_continued).collect();
        settings.retain(|setting| !belongs_to_a_new_bed(&setting.key));
        // The path is relative to the case of continued runs, so that a study folder may be moved.
        let pending = Path::new("runs").join(&predecessor.name).join("checkpoint");
        settings.push(start_setting(start.unwrap_or(&pending)));
        CaseRequest { case: self.continued_case.clone(), settings }
    }

    /// The setting for the start of a run that begins with a checkpoint of another study.
    fn start_path(&self, checkpoint: &Path) -> Setting {
        let folder = self.study.case.parent().unwrap_or(Path::new(""));
        start_setting(&relative(checkpoint, folder))
    }

    /// A title that gives the differences from the case, and the start of the run.
    pub(crate) fn title(&self, member: &Member, origin: Option<String>) -> Option<Setting> {
        let case = self.checker.effective(&self.study.case, &[]).ok()?;
        let differs = self.labels.iter().filter_map(|(key, label)| {
            Some(format!("{label} = {}", member.setting(key)?.value.plain()))
        });
        let parts: Vec<String> = differs.chain(origin).collect();
        if parts.is_empty() {
            return None;
        }
        let title = format!("{}: {}", case.title().unwrap_or("run"), parts.join(", "));
        Some(Setting { key: "title".to_owned(), value: Value::from_text(title), line: 0 })
    }

    /// The name of a search: the settings common to all its runs.
    pub(crate) fn search_name(&self, settings: &[Setting]) -> String {
        let identity: Vec<String> =
            self.study.common.iter().chain(settings).map(Setting::argument).collect();
        let hash = blake3::hash(identity.join("\n").as_bytes()).to_hex();
        self.name(settings, &hash)
    }

    fn name(&self, settings: &[Setting], identity: &str) -> String {
        let part = |(key, label): &(String, String)| {
            let setting = settings.iter().find(|setting| setting.key == *key)?;
            Some(format!("{label}={}", as_file_name(&setting.value.plain())))
        };
        let mut name = self.labels.iter().filter_map(part).collect::<Vec<_>>().join("__");
        name.truncate(LONGEST_NAME); // as_file_name leaves ASCII only
        if name.is_empty() {
            name = "run".to_owned();
        }
        format!("{name}__{}", mark_of(identity))
    }
}

fn start_setting(path: &Path) -> Setting {
    let value = Value::from_text(path.display().to_string());
    Setting { key: "particles.start.path".to_owned(), value, line: 0 }
}

/// The shortest end of a path of a key that no other key shares.
pub(crate) fn short_name(key: &str, keys: &[String]) -> String {
    let parts: Vec<&str> = key.split('.').collect();
    let end = |count: usize| parts[parts.len() - count..].join(".");
    let is_unique = |end: &String| {
        let dotted = format!(".{end}");
        !keys.iter().any(|other| other != key && (other == end || other.ends_with(&dotted)))
    };
    let name = (1..=parts.len()).map(end).find(is_unique).unwrap_or_else(|| key.to_owned());
    as_file_name(&name)
}

/// A text with characters that every shell and file system accepts.
fn as_file_name(text: &str) -> String {
    let mut name = String::new();
    for c in text.chars() {
        let plain = c.is_ascii_alphanumeric() || "._+-".contains(c);
        if plain {
            name.push(c);
        } else if !name.is_empty() && !name.ends_with('-') {
            name.push('-');
        }
    }
    name.truncate(LONGEST_VALUE);
    name.trim_end_matches('-').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_shortened_while_they_stay_apart() {
        let keys =
            ["cohesion.wall.law", "contact.wall.law", "gas.spacing", "spacing"].map(str::to_owned);
        assert_eq!(short_name(&keys[0], &keys), "cohesion.wall.law");
        assert_eq!(short_name(&keys[2], &keys), "gas.spacing");
        assert_eq!(short_name("stage.2.gas.viscosity", &keys), "viscosity");
    }

    #[test]
    fn path_of_a_start_is_a_text_of_toml_whatever_its_characters() {
        // TOML escapes some characters differently from Rust, and others not at all.
        for name in
            ["e\u{301}", "a\u{a0}b", "\u{1b}[1m", "\u{7f}", "it's", "\"q\"", "a\\b", "'\"\\\u{1b}"]
        {
            let path = format!("../{name}/checkpoint.h5");
            let setting = start_setting(Path::new(&path));
            let document: toml::Table = setting.argument().parse().expect("an entry of TOML");
            assert_eq!(document["particles"]["start"]["path"].as_str(), Some(&path[..]));
        }
    }

    #[test]
    fn any_value_becomes_a_file_name() {
        assert_eq!(as_file_name("{ from = 0.0, to = 8.0 }"), "from-0.0-to-8.0");
        assert_eq!(as_file_name("../a b/ü"), "..-a-b");
        assert_eq!(as_file_name("1e-5"), "1e-5");
    }
}
