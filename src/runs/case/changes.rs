//! Differences between two texts of a case.

use super::renamed::use_present_names;
use std::collections::BTreeMap;
use std::fmt;
use toml::{Table, Value};

/// A key that differs between two cases.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Change {
    /// Its path; the stages are counted from 1: `stage.2.duration`.
    pub key: String,
    /// Its value before, as TOML writes it; `None` if the key was not there.
    pub before: Option<String>,
    /// Its value after.
    pub after: Option<String>,
}

impl fmt::Display for Change {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown =
            |value: &Option<String>| value.clone().unwrap_or_else(|| "not given".to_owned());
        write!(formatter, "{}: {} -> {}", self.key, shown(&self.before), shown(&self.after))
    }
}

/// The keys that differ, by their present names, in the order of their paths. A text that is not TOML has no keys.
pub fn changes(before: &str, after: &str) -> Vec<Change> {
    let [before, after] = [before, after].map(values_by_key);
    let mut keys: Vec<&String> = before.keys().chain(after.keys()).collect();
    keys.sort_unstable();
    keys.dedup();
    keys.into_iter()
        .filter(|&key| before.get(key) != after.get(key))
        .map(|key| Change {
            key: key.clone(),
            before: before.get(key).cloned(),
            after: after.get(key).cloned(),
        })
        .collect()
}

fn values_by_key(text: &str) -> BTreeMap<String, String> {
    let mut all = BTreeMap::new();
    let mut table: Table = text.parse().unwrap_or_default();
    use_present_names(&mut table);
    for_each_value(&table, &mut |key, value| {
        all.insert(key.to_owned(), value.to_string());
    });
    all
}

/// Passes every value of a table that is not itself a table to a function, with its path: `box.lengths`,
/// `stage.1.duration`.
pub fn for_each_value(table: &Table, show: &mut impl FnMut(&str, &Value)) {
    for (key, value) in table {
        visit(key, value, show);
    }
}

fn visit(path: &str, value: &Value, show: &mut impl FnMut(&str, &Value)) {
    match value {
        Value::Table(table) => {
            for (key, inner) in table {
                visit(&format!("{path}.{key}"), inner, show);
            }
        }
        Value::Array(members) if members.iter().any(Value::is_table) => {
            for (number, inner) in (1..).zip(members) {
                visit(&format!("{path}.{number}"), inner, show);
            }
        }
        plain => show(path, plain),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changed_added_and_removed_keys_are_named_and_equal_values_are_not() {
        let before = "a = 1.0e-3\n[gas]\ncells = [2, 3]\nold = 1\n[[stage]]\nname = \"x\"";
        let after =
            "# a comment\na = 0.001\n[gas]\ncells = [3, 2]\n[[stage]]\nname = \"x\"\nduration = 2";
        let found: Vec<String> = changes(before, after).iter().map(Change::to_string).collect();
        let expected = [
            "gas.cells: [2, 3] -> [3, 2]",
            "gas.old: 1 -> not given",
            "stage.1.duration: not given -> 2",
        ];
        assert_eq!(found, expected);
        assert!(changes(before, before).is_empty());
        let [former, present] =
            ["bond_number", "adhesion_over_weight"].map(|name| format!("contact.{name} = 20"));
        assert!(changes(&former, &present).is_empty(), "a key that was only renamed");
    }
}
