//! The study file: what its keys, which `schema` declares, mean for a study.

mod axes;
mod search;

use crate::study::definition::{Axis, Continuation, Launcher, Resources, Study};
use crate::study::folder::StudyFolder;
use crate::study::problem::result;
use crate::study::quantity::{NamedQuantity, Registry};
use crate::study::schema::ROOT;
use crate::study::setting::{self, Setting};
use crate::study::start::Start;
use std::path::{Path, PathBuf};
use talcum_runs::input::{InputErrors, Node, Problems, Section, Value, read_text};

/// Reads a study file.
///
/// # Errors
/// All that is wrong with the file, not only the first error.
pub(crate) fn read(path: &Path) -> Result<Study, InputErrors> {
    let text = read_text(path)?;
    let problems = Problems::default();
    let tree = Node::parse(&text, &problems);
    let root = tree.as_ref().and_then(|tree| Section::open(tree, ROOT, &problems));
    let study = root.and_then(|root| study(&root, &text, path));
    result(problems, path, study)
}

/// The study of a file's text; values of keys of the case are taken from it as they are written.
fn study(root: &Section<'_>, text: &str, path: &Path) -> Option<Study> {
    let registry = Registry::default();
    let common = settings(root, text);
    let axes = axes::axes(root, text);
    let replicates = axes::replicates(root, &axes);
    let grid: Vec<Axis> = axes.into_iter().filter(|axis| !axis.replicate).map(|a| a.axis).collect();
    let start = root.table("start").map(|section| start(&section, path));
    let bisection = root.table("bisection").map(|section| search::bisection(&section, &grid));
    let own =
        bisection.as_ref().and_then(|search| search::own_quantity(search.as_ref()?, &registry));
    let quantities = quantities(root, &registry, own);
    let continuation =
        root.table("continuation").map(|section| continuation(&section, text, &grid));
    let study = Study {
        file: path.to_owned(),
        title: root.text("title")?,
        case: path.parent().unwrap_or(Path::new("")).join(root.text("case")?),
        common,
        axes: grid,
        replicates,
        start: unless_wrong(start)?,
        continuation: unless_wrong(continuation)?,
        bisection: unless_wrong(bisection)?,
        quantities,
        confidence: root.number("confidence")?,
        resources: resources(&root.table_or_defaults("run")?)?,
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

/// The key `set` of a section: keys of the case and their values. Sections and dotted keys are paths, inline tables are
/// values.
fn settings(section: &Section<'_>, text: &str) -> Vec<Setting> {
    let mut all = Vec::new();
    for (name, node) in section.right("set").map(Node::entries).unwrap_or_default() {
        collect_settings(name, node, text, &mut all);
    }
    all
}

fn collect_settings(path: &str, node: &Node, text: &str, all: &mut Vec<Setting>) {
    match &node.value {
        // The text of an inline table begins with its brace; that of a section is elsewhere.
        Value::Table(entries) if !node.written(text).starts_with('{') => {
            for (name, inner) in entries {
                collect_settings(&format!("{path}.{name}"), inner, text, all);
            }
        }
        _ => {
            let (key, value, line) = (path.to_owned(), value(node, text), node.line());
            all.push(Setting { key, value, line });
        }
    }
}

/// Any value that a key of the case may take.
fn value(node: &Node, text: &str) -> setting::Value {
    setting::Value::new(node.written(text), node.as_number())
}

/// Columns of every table of runs or points, whatever is varied and measured.
const COLUMNS: [&str; 7] =
    ["run", "point", "runs", "state", "digest", "begins_with", "identity_blake3"];

/// The list `measures`, then the sections `[measure.NAME]`, then that of a search by itself if it is none of them: at least one.
fn quantities(
    root: &Section<'_>,
    registry: &Registry,
    of_search: Option<NamedQuantity>,
) -> Vec<NamedQuantity> {
    if !root.has("measures") && of_search.is_none() {
        root.require("measure");
    }
    let mut quantities: Vec<NamedQuantity> = Vec::new();
    for node in root.right("measures").map(Node::items).unwrap_or_default() {
        add_listed(node, registry, &mut quantities).unwrap_or_else(|message| {
            root.problems.add(node.error(message));
        });
    }
    if root.right("measure").is_some_and(|node| node.entries().is_empty()) {
        root.fail("measure", "must hold at least one quantity, [measure.NAME]");
    }
    for (name, section) in root.named("measure") {
        if let Some(message) = wrong_name(name, &quantities) {
            root.problems.add(section.node.error(message));
        }
        if let Some(quantity) = registry.read(&section) {
            let (name, line) = (name.to_owned(), section.node.line());
            quantities.push(NamedQuantity { name, quantity, line });
        }
    }
    let is_new = |own: &NamedQuantity| quantities.iter().all(|known| known.name != own.name);
    let of_search = of_search.filter(is_new);
    quantities.extend(of_search);
    quantities
}

/// Adds what a member of the list `measures` names.
fn add_listed(
    node: &Node,
    registry: &Registry,
    all: &mut Vec<NamedQuantity>,
) -> Result<(), String> {
    let name = node.as_text().unwrap_or_default().to_owned();
    if all.iter().any(|known| known.name == name) {
        return Err("is listed twice".to_owned());
    }
    let quantity = registry.named(&name)?;
    all.push(NamedQuantity { name, quantity, line: node.line() });
    Ok(())
}

/// Why a section `[measure.NAME]` cannot have its name.
fn wrong_name(name: &str, known: &[NamedQuantity]) -> Option<&'static str> {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if known.iter().any(|known| known.name == name) {
        Some("is in the list measures already")
    } else if COLUMNS.contains(&name) {
        Some("is the name of another column of the tables: call the quantity something else")
    } else if !name.chars().all(plain) {
        Some("a quantity is named with characters, digits, _ and -")
    } else {
        None
    }
}

/// `[start]`; paths are relative to the study file at `path`.
fn start(section: &Section<'_>, path: &Path) -> Option<Start> {
    let study = path.parent().unwrap_or(Path::new("")).join(section.text("study")?);
    let results = if section.has("results") {
        PathBuf::from(section.text("results")?)
    } else {
        StudyFolder::default_of(&study)
    };
    Some(Start { study, results, line: section.node.line() })
}

fn continuation(section: &Section<'_>, text: &str, grid: &[Axis]) -> Option<Continuation> {
    let axis = axes::find(section, "axis", grid)?;
    let from_stage = section.text("from_stage");
    Some(Continuation { axis, from_stage, settings: settings(section, text) })
}

fn resources(section: &Section<'_>) -> Option<Resources> {
    let launcher = section.text("launcher").map(|text| Launcher::from_text(&text));
    Some(Resources {
        ranks: section.count("ranks")?,
        at_a_time: section.count("at_a_time")?,
        launcher: launcher.unwrap_or_default(),
    })
}
