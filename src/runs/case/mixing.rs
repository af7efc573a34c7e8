//! A section for a pair of species, made from those of each species by the rules of its keys.

use super::merging::merge;
use crate::input::{InputError, Node, Value};
use talcum_engine::schema::{ActiveKeys, Key, Mixing, displaced_by};

/// A section with its own keys replaced by those of a change.
pub(super) fn with_changes(base: &Node, change: Option<&Node>, keys: &'static [Key]) -> Node {
    let mut node = base.clone();
    if let (Value::Table(entries), Some(change)) = (&mut node.value, change) {
        merge(entries, change.entries().to_vec(), keys);
    }
    node
}

/// The section for two species with these names, from the sections of each. For keys that are replaced in `own`, the
/// value of the first species is kept.
///
/// # Errors
/// If values differ for which there is no mixing rule, or `own` contains keys that belong to a single species.
pub(super) fn mixed(
    [one, other]: [&Node; 2],
    own: Option<&Node>,
    keys: &'static [Key],
    names: [&str; 2],
) -> Result<Node, Vec<InputError>> {
    let known = ActiveKeys::of(keys, &|key| one.get(key).and_then(Node::as_text));
    let rule = |name: &str| known.find(name).map_or(Mixing::None, |key| key.mixing);
    let own = own.map(Node::entries).unwrap_or_default();
    let of_body = own.iter().filter(|(name, _)| rule(name) == Mixing::OfBody);
    let mut errors: Vec<InputError> = of_body
        .map(|(_, node)| {
            node.error("belongs to each species, not to a pair: give it in [[species]]")
        })
        .collect();
    let is_replaced = |name: &str| {
        own.iter().any(|(given, _)| given == name || displaced_by(keys, given).contains(&name))
    };
    let mut entries = Vec::new();
    for (name, node) in one.entries() {
        let mut node = node.clone();
        if let Some(value) = other.get(name).filter(|_| !is_replaced(name)) {
            match mixed_value(rule(name), &node, value) {
                Some(value) => node.value = value,
                None => errors.push(no_rule(&node, value, names)),
            }
        } else if !is_replaced(name) {
            errors.push(only_in(&node, names));
        }
        entries.push((name.clone(), node));
    }
    let missing = other.entries().iter().filter(|(name, _)| one.get(name).is_none());
    let missing = missing.filter(|(name, _)| !is_replaced(name));
    errors.extend(missing.map(|(_, node)| only_in(node, [names[1], names[0]])));
    if errors.is_empty() {
        Ok(Node { value: Value::Table(entries), ..one.clone() })
    } else {
        Err(errors)
    }
}

/// The value for two values; `None` if they differ and have no rule.
fn mixed_value(rule: Mixing, one: &Node, other: &Node) -> Option<Value> {
    if rule == Mixing::OfBody || one.to_string() == other.to_string() {
        return Some(one.value.clone());
    }
    rule.mixed(one.as_number()?, other.as_number()?).map(Value::Number)
}

fn no_rule(one: &Node, other: &Node, names: [&str; 2]) -> InputError {
    other.error(format!(
        "is {one} for species {:?}, and these have no rule of mixing: give the value of the two in a [[pair]] of {:?} and {:?}",
        names[0], names[0], names[1]
    ))
}

fn only_in(node: &Node, [one, other]: [&str; 2]) -> InputError {
    node.error(format!(
        "species {one:?} has it, {other:?} has not: give both the same keys, or the values of the two in a [[pair]] of them"
    ))
}
