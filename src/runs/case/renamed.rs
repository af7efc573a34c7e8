//! Former names of keys and sections.

use super::schema::ROOT;
use crate::input::{Node, Problems, SourcePlace, Value};
use talcum_engine::schema::{Key, Kind, declaration_of};
use toml::Table;

/// Treatment of a former name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FormerNames {
    /// It is an error, which names the present name.
    Reported,
    /// It is read, unless it comes from an override: the text is from an earlier run and cannot be edited.
    Read,
}

/// A case in which every key has its present name.
pub(super) fn by_present_names(mut root: Node, former: FormerNames, problems: &Problems) -> Node {
    rename_former(&mut root, ROOT, &|node, message| {
        if former == FormerNames::Reported || matches!(node.place, SourcePlace::Override(_)) {
            problems.add(node.error(message));
        }
    });
    root
}

/// Report on an entry with a former name.
type Report<'a> = &'a dyn Fn(&Node, String);

/// Reports each entry below a table that has a former name, and renames it to the present one, so that other errors are
/// found as well and nothing that is only misnamed is reported as missing.
fn rename_former(table: &mut Node, keys: &'static [Key], report: Report<'_>) {
    let Value::Table(entries) = &mut table.value else { return };
    for (name, node) in entries {
        let Some(key) = declaration_of(keys, name) else { continue };
        if key.name != name {
            let section = node.path.strip_suffix(name.as_str()).unwrap_or_default();
            report(node, format!("is now {section}{}", key.name));
            key.name.clone_into(name);
        }
        rename_below(node, key, report);
    }
}

/// Renames keys in the section of a key, or in each of its sections.
fn rename_below(node: &mut Node, key: &Key, report: Report<'_>) {
    let keys = key.kind.keys();
    match (&mut node.value, key.kind) {
        (Value::List(sections), _) => {
            sections.iter_mut().for_each(|section| rename_former(section, keys, report));
        }
        (Value::Table(sections), Kind::Named(_)) => {
            sections.iter_mut().for_each(|(_, section)| rename_former(section, keys, report));
        }
        _ => rename_former(node, keys, report),
    }
}

/// Gives each key below a table its present name.
pub(super) fn use_present_names(table: &mut Table) {
    rename(table, ROOT, |key| key.name);
}

/// Renames each key below a table to its first name. The identity of a run is based on these names, so that results
/// remain known when a key is renamed.
pub fn use_first_names(table: &mut Table) {
    rename(table, ROOT, |key| key.former.last().copied().unwrap_or(key.name));
}

fn rename(table: &mut Table, keys: &'static [Key], name_of: fn(&Key) -> &'static str) {
    for (name, mut value) in std::mem::take(table) {
        let key = declaration_of(keys, &name);
        let below = key.map_or(&[][..], |key| key.kind.keys());
        let is_named = key.is_some_and(|key| matches!(key.kind, Kind::Named(_)));
        match &mut value {
            toml::Value::Array(sections) => {
                let tables = sections.iter_mut().filter_map(toml::Value::as_table_mut);
                tables.for_each(|section| rename(section, below, name_of));
            }
            toml::Value::Table(sections) if is_named => {
                let tables = sections.iter_mut().filter_map(|(_, section)| section.as_table_mut());
                tables.for_each(|section| rename(section, below, name_of));
            }
            toml::Value::Table(section) => rename(section, below, name_of),
            _ => {}
        }
        table.insert(key.map_or(name, |key| name_of(key).to_owned()), value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use talcum_engine::schema::{Allowed, Merged, Word};

    const fn number(name: &'static str) -> Key {
        Key::number(name, Allowed::POSITIVE, "").optional()
    }

    const INNER: &[Key] = &[
        number("new").formerly(&["old", "older"]),
        Key::word("law", &[Word::with("one", "", &[number("of_one").formerly(&["for_one"])])], ""),
    ];
    const MERGED: Merged = Merged { section: "merged", keys: INNER, switched: true };
    const TABLE: &[Key] = &[
        Key::new("section", Kind::Table(INNER), "").formerly(&["part"]),
        Key::new("list", Kind::Tables(INNER), ""),
        Key::new("named", Kind::Named(INNER), ""),
        Key::new("merged", Kind::Merged(MERGED), ""),
        // A name that now has another meaning.
        number("taken").formerly(&["list"]),
    ];

    /// The errors reported for a text.
    fn errors_of(text: &str) -> String {
        let problems = Problems::default();
        let mut tree = Node::parse(text, &problems).unwrap();
        rename_former(&mut tree, TABLE, &|node, message| problems.add(node.error(message)));
        problems.into_errors("f.toml").to_string()
    }

    #[test]
    fn former_names_are_found_in_every_kind_of_table() {
        for (text, expected) in [
            ("[section]\nold = 1", "f.toml:2: section.old = 1: is now section.new"),
            ("section.older = 1", "f.toml:1: section.older = 1: is now section.new"),
            ("[part]\nnew = 1", "f.toml:1: part: is now section"),
            ("[[list]]\n[[list]]\nold = 1", "f.toml:3: list.2.old = 1: is now list.2.new"),
            ("[named.a]\nold = 1", "f.toml:2: named.a.old = 1: is now named.a.new"),
            ("merged = { old = 1 }", "f.toml:1: merged.old = 1: is now merged.new"),
            ("section.for_one = 2", "f.toml:1: section.for_one = 2: is now section.of_one"),
        ] {
            assert_eq!(errors_of(text), expected);
        }
    }

    #[test]
    fn a_misnamed_entry_is_read_by_its_present_name() {
        let problems = Problems::default();
        let mut tree = Node::parse("[part]\nold = 1", &problems).unwrap();
        rename_former(&mut tree, TABLE, &|node, message| problems.add(node.error(message)));
        let new = tree.get("section").unwrap().get("new").unwrap();
        assert_eq!(new.as_count(), Some(1));
    }

    #[test]
    fn present_and_unknown_names_are_left_alone() {
        // Control.
        let problems = Problems::default();
        let text = "named.old.new = 1\nlist = 1\nodd = 1\nmerged = \"off\"\nsection = 1";
        let mut tree = Node::parse(text, &problems).unwrap();
        rename_former(&mut tree, TABLE, &|node, message| problems.add(node.error(message)));
        assert!(problems.is_empty());
    }

    #[test]
    fn tables_are_renamed_in_both_directions() {
        let present = "merged = \"off\"\nnamed.a.new = 1\n[[list]]\nof_one = 2\n[section]\nnew = 3";
        let first = "merged = \"off\"\nnamed.a.older = 1\n[[list]]\nfor_one = 2\n[part]\nolder = 3";
        let between = "merged = \"off\"\nnamed.a.old = 1\n[[list]]\nfor_one = 2\n[part]\nold = 3";
        let parsed = |text: &str| text.parse::<Table>().unwrap();
        for text in [present, between, first] {
            let (mut by_first, mut by_present) = (parsed(text), parsed(text));
            rename(&mut by_first, TABLE, |key| key.former.last().copied().unwrap_or(key.name));
            rename(&mut by_present, TABLE, |key| key.name);
            assert_eq!((by_first, by_present), (parsed(first), parsed(present)));
        }
    }
}
