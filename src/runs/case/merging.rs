//! Merging of a section with changes by a later stage, or by a wall; its table determines which keys replace which.

use super::schema::{STAGE, section_keys};
use crate::input::{Node, Problems, Section, Value};
use talcum_engine::schema::{ActiveKeys, Key, Kind, displaced_by};

/// Replaces entries of the same key or of a partner. If the new entries choose another word, keys that only the
/// previous word has are dropped. Subsections are merged likewise.
pub(super) fn merge(
    kept: &mut Vec<(String, Node)>,
    changes: Vec<(String, Node)>,
    keys: &'static [Key],
) {
    let mut changed: Vec<String> = Vec::new();
    let mut new_words: Vec<&str> = Vec::new();
    for (name, node) in changes {
        let declared = keys.iter().find(|key| key.name == name);
        let inner = kept.iter_mut().find(|(other, _)| *other == name).map(|(_, node)| node);
        if let (Some(Kind::Merged(merged)), Some(inner)) = (declared.map(|key| key.kind), &inner)
            && let (Value::Table(_), Value::Table(changes)) = (&inner.value, &node.value)
        {
            let changes = changes.clone();
            if let Some(Node { value: Value::Table(inner), .. }) = inner_of(kept, &name) {
                merge(inner, changes, merged.keys);
            }
            continue;
        }
        let is_new = inner.is_none_or(|inner| inner.as_text() != node.as_text());
        if let Some(key) = declared.filter(|key| is_new && !key.kind.words().is_empty()) {
            new_words.push(key.name);
        }
        let displaced = displaced_by(keys, &name);
        kept.retain(|(other, _)| *other != name && !displaced.contains(&other.as_str()));
        changed.push(name.clone());
        kept.push((name, node));
    }
    let word_of = |key: &str| kept.iter().find(|(name, _)| name == key)?.1.as_text();
    let useless = useless_keys(keys, &word_of, &new_words);
    kept.retain(|(name, _)| changed.contains(name) || !useless.contains(&name.as_str()));
}

fn inner_of<'a>(entries: &'a mut [(String, Node)], name: &str) -> Option<&'a mut Node> {
    entries.iter_mut().find(|(other, _)| other == name).map(|(_, node)| node)
}

/// Keys that are not used by the words that these keys presently choose.
pub(super) fn useless_keys<'a>(
    keys: &'static [Key],
    word_of: &impl Fn(&'static str) -> Option<&'a str>,
    choosing: &[&str],
) -> Vec<&'static str> {
    let inactive = ActiveKeys::of(keys, word_of).inactive.into_iter();
    let by_choice =
        inactive.filter(|(_, chosen)| chosen.is_some_and(|chosen| choosing.contains(&chosen.key)));
    by_choice.map(|(key, _)| key.name).collect()
}

/// A section that stages may change: its present contents, and whether it is switched on.
#[derive(Clone)]
pub(super) struct StageSection {
    name: &'static str,
    node: Option<Node>,
    is_on: bool,
    was_on: bool,
}

impl StageSection {
    /// All such sections, initially empty.
    pub(super) fn all() -> Vec<Self> {
        let may_change = STAGE.iter().filter(|key| matches!(key.kind, Kind::Merged(_)));
        may_change
            .map(|key| Self { name: key.name, node: None, is_on: false, was_on: false })
            .collect()
    }

    /// Merges the contents of this section in the base of the file, or in a stage.
    pub(super) fn change(&mut self, section: &Section<'_>, stage: usize) {
        let Some(node) = section.node.get(self.name) else { return };
        match (&node.value, node.as_text()) {
            (Value::Table(_), _) => {
                self.merge(node, stage);
                self.is_on = true;
            }
            (_, Some("off")) => self.is_on = false,
            (_, Some("on")) if self.node.is_some() => self.is_on = true,
            (_, Some("on")) => {
                let message = "there is nothing to switch on: no keys are given before";
                section.problems.add(node.error(message));
            }
            // Anything else here has been reported.
            _ => {}
        }
    }

    fn merge(&mut self, change: &Node, stage: usize) {
        let mut change = change.clone();
        change.for_each(&mut |node| node.stage = stage);
        let Some(Node { value: Value::Table(kept), .. }) = &mut self.node else {
            self.node = Some(change);
            return;
        };
        if let Value::Table(changes) = change.value {
            merge(kept, changes, section_keys(self.name));
        }
    }

    /// The section with a name, if it is switched on.
    pub(super) fn open<'a>(
        all: &'a [Self],
        name: &'static str,
        problems: &'a Problems,
    ) -> Option<Section<'a>> {
        let section = all.iter().find(|section| section.name == name && section.is_on)?;
        Section::open(section.node.as_ref()?, section_keys(name), problems)
    }

    /// Records which sections are on in a stage.
    pub(super) fn mark(all: &mut [Self]) {
        all.iter_mut().for_each(|section| section.was_on |= section.is_on);
    }

    /// Switches on the sections that no stage had switched on; returns whether there are any.
    pub(super) fn switch_on_unused(all: &mut [Self]) -> bool {
        let is_unused = |section: &Self| !section.was_on && section.node.is_some();
        let any = all.iter().any(is_unused);
        all.iter_mut().for_each(|section| section.is_on |= !section.was_on);
        any
    }
}
