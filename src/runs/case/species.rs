//! The species of a bed, and the keys for their contacts and attraction.

use super::merging::merge;
use super::mixing::{mixed, with_changes};
use crate::beds::Species;
use crate::input::{Node, Section, Value, nearest};
use talcum_engine::contact::{ByPair, BySpecies};
use talcum_engine::schema::Key;

/// The species, with the nodes that contain their differences.
pub(super) struct SpeciesSections<'a> {
    pub(super) species: Vec<Species>,
    nodes: Vec<&'a Node>,
    pairs: Vec<([usize; 2], &'a Node)>,
}

/// A section of the file that holds for all species, and may be changed for some.
#[derive(Clone, Copy)]
pub(super) struct SharedSection<'a> {
    pub(super) name: &'static str,
    pub(super) keys: &'static [Key],
    /// The values for all species.
    pub(super) base: &'a Node,
}

impl<'a> SpeciesSections<'a> {
    /// `[[species]]` and `[[pair]]`.
    pub(super) fn read(root: &Section<'a>) -> Self {
        let mut read = Self { species: Vec::new(), nodes: Vec::new(), pairs: Vec::new() };
        for section in root.tables("species") {
            let Some(name) = section.text("name") else { continue };
            if read.number_of(&name).is_some() {
                section.fail("name", "there is another species of this name");
            }
            let density = section.has("density").then(|| section.number("density")).flatten();
            read.species.push(Species { name, density });
            read.nodes.push(section.node);
        }
        for section in root.tables("pair") {
            read.add_pair(&section);
        }
        for node in &read.nodes {
            require_cohesion(root, node, "species");
        }
        for (_, node) in &read.pairs {
            require_cohesion(root, node, "pair");
        }
        read
    }

    fn add_pair(&mut self, section: &Section<'a>) {
        let Some(names) = section.texts("species") else { return };
        let numbers: Vec<Option<usize>> = names.iter().map(|name| self.number_of(name)).collect();
        if let Some(unknown) = (0..names.len()).find(|&place| numbers[place].is_none()) {
            section.fail("species", self.unknown(&names[unknown]));
            return;
        }
        let [Some(one), Some(other)] = numbers[..] else {
            section.fail("species", "must be the names of two species");
            return;
        };
        let pair = [one.min(other), one.max(other)];
        if one == other {
            let message =
                "must be two different species: two of the same one are described in [[species]]";
            section.fail("species", message);
        } else if self.pairs.iter().any(|(known, _)| *known == pair) {
            section.fail("species", "there is another [[pair]] of these");
        } else {
            self.pairs.push((pair, section.node));
        }
    }

    /// Number of the species with a name.
    pub(super) fn number_of(&self, name: &str) -> Option<usize> {
        self.species.iter().position(|species| species.name == name)
    }

    /// The message that a name is not that of a species.
    pub(super) fn unknown(&self, name: &str) -> String {
        let names: Vec<&str> = self.species.iter().map(|species| species.name.as_str()).collect();
        match nearest(name, &names) {
            _ if names.is_empty() => format!("{name:?}: there are no [[species]]"),
            Some(near) => format!("{name:?} is no species: did you mean {near:?}?"),
            None => format!("{name:?} is no species: there are {}", names.join(", ")),
        }
    }

    /// A section for each species; the section itself if there are no species.
    pub(super) fn section_of_each(&self, shared: SharedSection<'_>) -> Vec<Node> {
        let SharedSection { name, keys, base } = shared;
        if self.nodes.is_empty() {
            vec![base.clone()]
        } else {
            let changes = self.nodes.iter().map(|node| node.get(name));
            changes.map(|change| with_changes(base, change, keys)).collect()
        }
    }

    /// The keys of a species for walls.
    pub(super) fn at_walls(&self, species: usize) -> Option<&'a Node> {
        self.nodes.get(species)?.get("wall")
    }

    /// Reads a section for each pair of species; the closure is given their numbers, the lower first.
    pub(super) fn read_pairs<T>(
        &self,
        root: &Section<'_>,
        shared: SharedSection<'_>,
        mut read: impl FnMut(&Section<'_>, [usize; 2]) -> Option<T>,
    ) -> Option<ByPair<T>> {
        let nodes = self.section_of_each(shared);
        ByPair::of_species_if(nodes.len(), |one, other| {
            let node = if one == other {
                nodes[one].clone()
            } else {
                self.section_of_pair(root, shared, [one, other], &nodes)?
            };
            read(&Section::open(&node, shared.keys, root.problems)?, [one, other])
        })
    }

    fn section_of_pair(
        &self,
        root: &Section<'_>,
        SharedSection { name, keys, .. }: SharedSection<'_>,
        pair: [usize; 2],
        nodes: &[Node],
    ) -> Option<Node> {
        let own = self.pairs.iter().find(|(known, _)| *known == pair);
        let own = own.and_then(|(_, node)| node.get(name));
        let names = pair.map(|species| self.species[species].name.as_str());
        let mut node = mixed(pair.map(|species| &nodes[species]), own, keys, names)
            .map_err(|errors| errors.into_iter().for_each(|error| root.problems.add(error)))
            .ok()?;
        if let (Value::Table(entries), Some(own)) = (&mut node.value, own) {
            merge(entries, own.entries().to_vec(), keys);
        }
        Some(node)
    }

    /// A value for each species.
    pub(super) fn for_each<T>(
        &self,
        value: impl FnMut(usize) -> Option<T>,
    ) -> Option<BySpecies<T>> {
        // All of them are evaluated, so that all errors are reported.
        let values: Vec<Option<T>> = (0..self.species.len().max(1)).map(value).collect();
        BySpecies::of_species(values.into_iter().collect::<Option<_>>()?)
    }
}

/// Rejects keys on the attraction in a file without attraction.
fn require_cohesion(root: &Section<'_>, node: &Node, name: &str) {
    let of_stages = root.node.get("stage").map(Node::items).unwrap_or_default();
    let is_there =
        std::iter::once(root.node).chain(of_stages).any(|at| at.get("cohesion").is_some());
    if let (false, Some(given)) = (is_there, node.get("cohesion")) {
        let message = format!("belongs to a [cohesion], which is missing: a {name} changes it");
        root.problems.add(given.error(message));
    }
}
