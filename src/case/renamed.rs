//! Keys and sections that had another name before.

use super::errors::Problems;
use super::schema::ROOT;
use super::tree::{Node, Value};
use crate::schema::{Key, Kind, every_key, renamed};

/// A case in which every key has its present name; former names are reported.
pub(super) fn by_present_names(mut root: Node, problems: &Problems) -> Node {
    rename_former(&mut root, ROOT, problems);
    root
}

/// Reports each entry below a table that has a former name, and gives it the present one: what else is wrong is then found as
/// well, and nothing is missed that is only misnamed.
fn rename_former(table: &mut Node, keys: &'static [Key], problems: &Problems) {
    let Value::Table(entries) = &mut table.value else { return };
    let declared = every_key(keys);
    for (name, node) in entries {
        if let Some(key) = renamed(keys, name) {
            let section = node.path.strip_suffix(name.as_str()).unwrap_or_default();
            problems.add(node.error(format!("is now {section}{}", key.name)));
            key.name.clone_into(name);
        }
        let has_keys = |key: &&&Key| key.name == *name && !key.kind.keys().is_empty();
        if let Some(key) = declared.iter().find(has_keys) {
            rename_below(node, key, problems);
        }
    }
}

/// The same in the section of a key, or in each of its sections.
fn rename_below(node: &mut Node, key: &Key, problems: &Problems) {
    let keys = key.kind.keys();
    match (&mut node.value, key.kind) {
        (Value::List(sections), _) => {
            sections.iter_mut().for_each(|section| rename_former(section, keys, problems));
        }
        (Value::Table(sections), Kind::Named(_)) => {
            sections.iter_mut().for_each(|(_, section)| rename_former(section, keys, problems));
        }
        _ => rename_former(node, keys, problems),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::{Allowed, Merged, Word};

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
        // A name that means something else now.
        number("taken").formerly(&["list"]),
    ];

    /// What is reported of a text.
    fn errors_of(text: &str) -> String {
        let problems = Problems::default();
        let mut tree = Node::parse(text, &problems).unwrap();
        rename_former(&mut tree, TABLE, &problems);
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
        rename_former(&mut tree, TABLE, &problems);
        let new = tree.get("section").unwrap().get("new").unwrap();
        assert_eq!(new.as_count(), Some(1));
    }

    #[test]
    fn present_and_unknown_names_are_left_alone() {
        // The control.
        let problems = Problems::default();
        let text = "named.old.new = 1\nlist = 1\nodd = 1\nmerged = \"off\"\nsection = 1";
        let mut tree = Node::parse(text, &problems).unwrap();
        rename_former(&mut tree, TABLE, &problems);
        assert!(problems.is_empty());
    }
}
