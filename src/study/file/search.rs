//! `[bisection]` in a study file.

use super::axes;
use crate::study::bisection::{Bisection, Brackets, Direction, Threshold};
use crate::study::definition::{Axis, Study};
use crate::study::measure::{NamedMeasure, Registry};
use crate::study::problem::Problem;
use crate::study::section::{Entry, Section, advice};
use toml::de::DeValue;

/// Reads the section.
pub(super) fn bisection(entry: &Entry<'_>, grid: &[Axis]) -> Option<Bisection> {
    let section = entry.section()?;
    let key = section.required("key", "the key of the case whose critical value is sought");
    let brackets = brackets(&section, grid);
    let tolerance = section.required("tolerance", "a number above 0");
    let measure = section.required("measure", "the name of a measure of this study");
    let threshold = section.required("threshold", "a number, or a text that the measure may give");
    let direction = direction(&section);
    let logarithmic = axes::scale(&section);
    section.finish();
    let (brackets, tolerance) = (brackets?, tolerance?);
    let search = Bisection {
        key: key?.text()?,
        brackets,
        tolerance: tolerance.number()?,
        measure: measure?.text()?,
        threshold: read_threshold(&threshold?)?,
        direction: direction?,
        logarithmic: logarithmic?,
        line: section.line,
    };
    for [lower, upper] in search.brackets.all() {
        if search.tolerance <= 0.0 || search.tolerance >= upper - lower {
            let width = upper - lower;
            tolerance.fail(format!("must be above 0 and below {width}, the width of a bracket"));
        }
        if search.logarithmic && *lower <= 0.0 {
            section.fail("bracket", "must lie above 0 on a logarithmic scale");
        }
    }
    Some(search)
}

fn read_threshold(entry: &Entry<'_>) -> Option<Threshold> {
    match entry.value {
        DeValue::String(_) => entry.text().map(Threshold::Text),
        _ => entry.number().map(Threshold::Number),
    }
}

fn direction(section: &Section<'_>) -> Option<Direction> {
    let allowed = "\"rises\" or \"falls\": what the measure does as the key grows";
    let entry = section.required("direction", allowed)?;
    match entry.text()?.as_str() {
        "rises" => Some(Direction::Rises),
        "falls" => Some(Direction::Falls),
        _ => {
            entry.fail(format!("must be {allowed}"));
            None
        }
    }
}

/// One bracket for all points, or one for each position of the axis that `bracket_along` names.
fn brackets(section: &Section<'_>, grid: &[Axis]) -> Option<Brackets> {
    let entry = section.required("bracket", "two numbers, the smaller first");
    let along = section.optional("bracket_along");
    let entry = entry?;
    let Some(along) = along else { return pair(&entry).map(Brackets::One) };
    let axis = axes::find(&along, grid)?;
    let brackets: Option<Vec<[f64; 2]>> = entry.list()?.iter().map(pair).collect();
    let (brackets, positions) = (brackets?, grid.get(axis)?.values.len());
    if brackets.len() != positions {
        entry.fail(format!("must hold {positions} brackets, one for each value of the axis"));
        return None;
    }
    Some(Brackets::Along { axis, brackets })
}

fn pair(entry: &Entry<'_>) -> Option<[f64; 2]> {
    let numbers: Option<Vec<f64>> = entry.list()?.iter().map(Entry::number).collect();
    match numbers?.as_slice() {
        &[lower, upper] if lower < upper => Some([lower, upper]),
        _ => {
            entry.fail("must be two numbers, the smaller first");
            None
        }
    }
}

/// The measure of a search that defines it by itself.
pub(super) fn own_measure(
    search: Option<&Option<Bisection>>,
    registry: &Registry,
) -> Option<NamedMeasure> {
    let search = search?.as_ref()?;
    let measure = registry.named(&search.measure).ok()?;
    Some(NamedMeasure { name: search.measure.clone(), measure, line: search.line })
}

/// Rejects a search for an unknown measure, one with a threshold of another kind, and one that is combined with a
/// continuation.
pub(super) fn check(study: &Study, root: &Section<'_>) {
    let Some(search) = &study.bisection else { return };
    let fail = |key: &str, value: Option<String>, message: String| {
        let (line, key) = (Some(search.line), format!("bisection.{key}"));
        root.source.problems.add(Problem { line, key, value, message });
    };
    let names: Vec<&str> = study.measures.iter().map(|measure| measure.name.as_str()).collect();
    let measure = study.measures.iter().find(|measure| measure.name == search.measure);
    if !names.is_empty() && measure.is_none() {
        let message = format!("no such measure: {}", advice(&search.measure, &names));
        fail("measure", Some(format!("{:?}", search.measure)), message);
    }
    let wrong = measure.and_then(|measure| wrong_threshold(search, measure));
    if let Some(message) = wrong {
        fail("threshold", None, message);
    }
    if study.continuation.is_some() {
        let message = "cannot be combined with [continuation]: the order of a search is not known \
                       before it has ended";
        fail("key", None, message.to_owned());
    }
}

/// The reason why the threshold cannot be a value of the measure.
fn wrong_threshold(search: &Bisection, measure: &NamedMeasure) -> Option<String> {
    let name = &measure.name;
    match (measure.measure.texts(), &search.threshold) {
        (None, Threshold::Text(_)) => Some(format!("must be a number, as {name} is")),
        (Some(texts), Threshold::Number(_)) => {
            Some(format!("must be a text that {name} may give: {}", texts.join(", ")))
        }
        (Some(texts), Threshold::Text(text)) if !texts.contains(&text.as_str()) => {
            Some(format!("{text:?} is nothing that {name} gives: {}", advice(text, texts)))
        }
        _ => None,
    }
}
