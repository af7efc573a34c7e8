//! The study file, read strictly: unknown keys are errors, and all errors are reported together.

mod axes;
mod search;

use crate::study::definition::{Axis, Continuation, Launcher, Resources, Study};
use crate::study::folder::StudyFolder;
use crate::study::measure::{NamedMeasure, Registry};
use crate::study::problem::{Problem, Problems, Refusal};
use crate::study::section::{Entry, Section, Source};
use crate::study::setting::Setting;
use crate::study::start::Start;
use std::path::{Path, PathBuf};
use toml::de::{DeTable, DeValue};

/// Reads a study file.
///
/// # Errors
/// All errors of the file, not only the first.
pub(crate) fn read(path: &Path, measures: &Registry) -> Result<Study, Refusal> {
    let problems = Problems::default();
    let text = std::fs::read_to_string(path);
    let text = text.map_err(|error| problems.add_whole(format!("cannot be read: {error}"))).ok();
    let study = text.and_then(|text| from_text(&text, path, measures, &problems));
    problems.result(&path.display().to_string(), study)
}

fn from_text(text: &str, path: &Path, measures: &Registry, problems: &Problems) -> Option<Study> {
    let (root, errors) = DeTable::parse_recoverable(text);
    for error in &errors {
        let line = error
            .span()
            .map(|span| text.bytes().take(span.start).filter(|&byte| byte == b'\n').count() + 1);
        let message = format!("not valid TOML: {}", error.message());
        problems.add(Problem { line, key: String::new(), value: None, message });
    }
    if !errors.is_empty() {
        return None;
    }
    let section = Section::root(root.get_ref(), Source { text, problems });
    let study = study(&section, path, measures);
    section.finish();
    study
}

fn study(root: &Section<'_>, path: &Path, registry: &Registry) -> Option<Study> {
    let title = root.required("title", "a text: the name of the study");
    let case = root.required("case", "the path of a case file, relative to the study file");
    let common = root.optional("set").map(|entry| settings(&entry)).unwrap_or_default();
    let axes = axes::axes(root);
    let replicates = axes::replicates(root, &axes);
    let grid: Vec<Axis> = axes.into_iter().filter(|axis| !axis.replicate).map(|a| a.axis).collect();
    let start = root.optional("start").map(|entry| start(&entry, path));
    let bisection = root.optional("bisection").map(|entry| search::bisection(&entry, &grid));
    let own = search::own_measure(bisection.as_ref(), registry);
    let measures = measures(root, registry, own);
    let continuation = root.optional("continuation").map(|entry| continuation(&entry, &grid));
    let confidence = confidence(root);
    let resources = resources(root);
    let study = Study {
        file: path.to_owned(),
        title: title?.text()?,
        case: path.parent().unwrap_or(Path::new("")).join(case?.text()?),
        common,
        axes: grid,
        replicates,
        start: unless_wrong(start)?,
        continuation: unless_wrong(continuation)?,
        bisection: unless_wrong(bisection)?,
        measures,
        confidence,
        resources: resources?,
    };
    search::check(&study, root);
    axes::check_keys(&study, root);
    Some(study)
}

/// A key that is left out is not an error; a key that was given and could not be read is one.
fn unless_wrong<T>(given: Option<Option<T>>) -> Option<Option<T>> {
    match given {
        Some(None) => None,
        Some(value) => Some(value),
        None => Some(None),
    }
}

/// Keys of the case and their values. Sections and dotted keys are paths, inline tables are values.
fn settings(entry: &Entry<'_>) -> Vec<Setting> {
    let Some(section) = entry.section() else { return Vec::new() };
    let mut all = Vec::new();
    for (name, entry) in section.entries() {
        collect_settings(&name, &entry, &mut all);
    }
    all
}

fn collect_settings(path: &str, entry: &Entry<'_>, all: &mut Vec<Setting>) {
    // The text of an inline table begins with its brace; the text of a section is elsewhere.
    let is_section = matches!(entry.value, DeValue::Table(_)) && !entry.written.starts_with('{');
    match entry.section_if(is_section) {
        Some(section) => {
            for (name, inner) in section.entries() {
                collect_settings(&format!("{path}.{name}"), &inner, all);
            }
        }
        None => {
            let (key, value, line) = (path.to_owned(), axes::value(entry), entry.line);
            all.push(Setting { key, value, line });
        }
    }
}

/// Columns of every table of runs or points, whatever is varied and measured.
const COLUMNS: [&str; 7] =
    ["run", "point", "runs", "state", "digest", "begins_with", "identity_blake3"];

/// The list `measures`, then the sections `[measure.NAME]`, then the measure of a search if it is not among them: at
/// least one.
fn measures(
    root: &Section<'_>,
    registry: &Registry,
    of_search: Option<NamedMeasure>,
) -> Vec<NamedMeasure> {
    let listed = root.optional("measures");
    let allowed =
        "one section [measure.NAME] or more, or a list measures: what is measured on every run";
    let sections = match listed.is_some() || of_search.is_some() {
        true => root.optional("measure"),
        false => root.required("measure", allowed),
    };
    let names = listed.and_then(|entry| entry.list()).unwrap_or_default();
    let mut measures: Vec<NamedMeasure> = Vec::new();
    for (entry, measure) in names.iter().filter_map(|e| Some((e, listed_measure(e, registry)?))) {
        if measures.iter().any(|known| known.name == measure.name) {
            entry.fail("is listed twice");
        }
        measures.push(measure);
    }
    for (name, entry) in sections.iter().flat_map(|entry| measure_sections(entry)) {
        if measures.iter().any(|known| known.name == name) {
            entry.fail("is in the list measures already");
        }
        if COLUMNS.contains(&name.as_str()) {
            entry.fail(
                "is the name of another column of the tables: call the measure something else",
            );
        }
        if let Some(measure) = entry.section().and_then(|keys| registry.prepare(&keys)) {
            measures.push(NamedMeasure { name, measure, line: entry.line });
        }
    }
    let is_new = |own: &NamedMeasure| measures.iter().all(|measure| measure.name != own.name);
    let of_search = of_search.filter(is_new);
    measures.extend(of_search);
    measures
}

fn listed_measure(entry: &Entry<'_>, registry: &Registry) -> Option<NamedMeasure> {
    let name = entry.text()?;
    match registry.named(&name) {
        Ok(measure) => Some(NamedMeasure { name, measure, line: entry.line }),
        Err(message) => {
            entry.fail(message);
            None
        }
    }
}

/// The sections `[measure.NAME]`, by their names.
fn measure_sections<'a>(entry: &Entry<'a>) -> Vec<(String, Entry<'a>)> {
    let Some(section) = entry.section() else { return Vec::new() };
    let sections = section.entries();
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    for (_, entry) in sections.iter().filter(|(name, _)| !name.chars().all(plain)) {
        entry.fail("a measure is named with characters, digits, _ and -");
    }
    if sections.is_empty() {
        entry.fail("must hold at least one measure, [measure.NAME]");
    }
    sections
}

/// `[start]`; paths are relative to the study file at `path`.
fn start(entry: &Entry<'_>, path: &Path) -> Option<Start> {
    let section = entry.section()?;
    let study = section.required("study", "the path of a study file, relative to this one");
    let results = section.optional("results").map(|entry| entry.text());
    section.finish();
    let study = path.parent().unwrap_or(Path::new("")).join(study?.text()?);
    let results = match results {
        Some(given) => PathBuf::from(given?),
        None => StudyFolder::default_of(&study),
    };
    Some(Start { study, results, line: entry.line })
}

fn continuation(entry: &Entry<'_>, axes: &[Axis]) -> Option<Continuation> {
    let section = entry.section()?;
    let axis = section.required("axis", "the name of an axis, or its first key");
    let from_stage = section.optional("from_stage").map(|entry| entry.text());
    let settings = section.optional("set").map(|entry| settings(&entry)).unwrap_or_default();
    section.finish();
    let axis = axes::find(&axis?, axes)?;
    Some(Continuation { axis, from_stage: unless_wrong(from_stage)?, settings })
}

/// The default confidence level.
const CONFIDENCE: f64 = 0.95;

fn confidence(root: &Section<'_>) -> f64 {
    let Some(entry) = root.optional("confidence") else { return CONFIDENCE };
    let Some(level) = entry.number() else { return CONFIDENCE };
    if !(0.5..=0.999).contains(&level) {
        entry.fail("must be from 0.5 to 0.999");
    }
    level
}

/// Largest number of ranks or runs: a larger one is a typing error.
const MOST: u64 = 65_536;

fn resources(root: &Section<'_>) -> Option<Resources> {
    let mut resources = Resources::default();
    let Some(entry) = root.optional("run") else { return Some(resources) };
    let section = entry.section()?;
    if let Some(entry) = section.optional("ranks") {
        resources.ranks = entry.count(1, MOST)?;
    }
    if let Some(entry) = section.optional("at_a_time") {
        resources.at_a_time = entry.count(1, MOST)?;
    }
    if let Some(entry) = section.optional("launcher") {
        resources.launcher = Launcher::from_text(&entry.text()?);
    }
    section.finish();
    Some(resources)
}
