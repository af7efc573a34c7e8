//! `[bisection]` in a study file.

use super::axes;
use crate::input::{Node, Section, advice};
use crate::study::bisection::{Bisection, Brackets, Direction, Threshold};
use crate::study::definition::{Axis, Study};
use crate::study::quantity::{NamedQuantity, Registry};

/// Reads the section.
pub(super) fn bisection(section: &Section<'_>, grid: &[Axis]) -> Option<Bisection> {
    let search = Bisection {
        key: section.text("key")?,
        brackets: brackets(section, grid)?,
        tolerance: section.number("tolerance")?,
        quantity: section.text("measure")?,
        threshold: threshold(section.right("threshold")?)?,
        direction: section.choice("direction", &Direction::ALL)?,
        logarithmic: section.word("scale")? == "logarithmic",
        line: section.node.line(),
    };
    for [lower, upper] in search.brackets.all() {
        if search.tolerance >= upper - lower {
            let width = upper - lower;
            section.fail("tolerance", format!("must be below {width}, the width of a bracket"));
        }
        if search.logarithmic && *lower <= 0.0 {
            section.fail("bracket", "must lie above 0 on a logarithmic scale");
        }
    }
    Some(search)
}

fn threshold(node: &Node) -> Option<Threshold> {
    let text = node.as_text().map(|text| Threshold::Text(text.to_owned()));
    text.or_else(|| node.as_number().map(Threshold::Number))
}

/// One bracket for all points, or one for each position of the axis that `bracket_along` names.
fn brackets(section: &Section<'_>, grid: &[Axis]) -> Option<Brackets> {
    let node = section.right("bracket")?;
    if !section.has("bracket_along") {
        return pair(section, node).map(Brackets::One);
    }
    let axis = axes::find(section, "bracket_along", grid)?;
    let brackets: Option<Vec<[f64; 2]>> =
        node.items().iter().map(|item| pair(section, item)).collect();
    let (brackets, positions) = (brackets?, grid.get(axis)?.values.len());
    if brackets.len() != positions {
        let message = format!("must hold {positions} brackets, one for each value of the axis");
        section.fail("bracket", message);
        return None;
    }
    Some(Brackets::Along { axis, brackets })
}

fn pair(section: &Section<'_>, node: &Node) -> Option<[f64; 2]> {
    match node.as_list(Node::as_number).as_deref() {
        Some(&[lower, upper]) if lower < upper => Some([lower, upper]),
        _ => {
            section.problems.add(node.error("must be two numbers, the smaller first"));
            None
        }
    }
}

/// The quantity of a search that names one by itself.
pub(super) fn own_quantity(search: &Bisection, registry: &Registry) -> Option<NamedQuantity> {
    let quantity = registry.named(&search.quantity).ok()?;
    Some(NamedQuantity { name: search.quantity.clone(), quantity, line: search.line })
}

/// Refuses a search for an unknown quantity or with a threshold of another kind, or one that is combined with a
/// continuation.
pub(super) fn check(study: &Study, root: &Section<'_>) {
    let Some((search, section)) = study.bisection.as_ref().zip(root.table("bisection")) else {
        return;
    };
    let names: Vec<&str> = study.quantities.iter().map(|known| known.name.as_str()).collect();
    let quantity = study.quantities.iter().find(|known| known.name == search.quantity);
    if !names.is_empty() && quantity.is_none() {
        let message = format!("no such quantity: {}", advice(&search.quantity, &names));
        section.fail("measure", message);
    }
    if let Some(message) = quantity.and_then(|quantity| wrong_threshold(search, quantity)) {
        section.fail("threshold", message);
    }
    if study.continuation.is_some() {
        let message = "cannot be combined with [continuation]: the order of a search is not known \
                       before it has ended";
        section.fail("key", message);
    }
}

/// Why the threshold cannot be one of the quantity.
fn wrong_threshold(search: &Bisection, quantity: &NamedQuantity) -> Option<String> {
    let name = &quantity.name;
    match (quantity.quantity.texts(), &search.threshold) {
        (None, Threshold::Text(_)) => Some(format!("must be a number, as {name} is")),
        (Some(texts), Threshold::Number(_)) => {
            Some(format!("must be a text that {name} may give: {}", texts.join(", ")))
        }
        (Some(texts), Threshold::Text(text)) if !texts.contains(&text.as_str()) => {
            Some(format!("is nothing that {name} gives: {}", advice(text, texts)))
        }
        _ => None,
    }
}
