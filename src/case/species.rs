//! The species of a bed, and what the file says about their contacts and attraction.

use super::merging::merge;
use super::mixing::{mixed, with_changes};
use crate::contact::{ByPair, BySpecies};
use crate::input::{Node, Section, Value, nearest};
use crate::schema::Key;

/// A species as the case names it.
#[derive(Clone, Debug, PartialEq)]
pub struct Species {
    /// Its name.
    pub name: String,
    /// Its solid density, if it is not that of the case.
    pub density: Option<f64>,
}

/// The species, with the nodes that say what differs.
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
    /// What holds for all.
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

    /// Number of the species of a name.
    pub(super) fn number_of(&self, name: &str) -> Option<usize> {
        self.species.iter().position(|species| species.name == name)
    }

    /// The message that a name is that of no species.
    pub(super) fn unknown(&self, name: &str) -> String {
        let names: Vec<&str> = self.species.iter().map(|species| species.name.as_str()).collect();
        match nearest(name, &names) {
            _ if names.is_empty() => format!("{name:?}: there are no [[species]]"),
            Some(near) => format!("{name:?} is no species: did you mean {near:?}?"),
            None => format!("{name:?} is no species: there are {}", names.join(", ")),
        }
    }

    /// A section as it is for each species; as it is if there are none.
    pub(super) fn section_of_each(&self, shared: SharedSection<'_>) -> Vec<Node> {
        let SharedSection { name, keys, base } = shared;
        match self.nodes.is_empty() {
            true => vec![base.clone()],
            false => {
                let changes = self.nodes.iter().map(|node| node.get(name));
                changes.map(|change| with_changes(base, change, keys)).collect()
            }
        }
    }

    /// What is said of each species at walls.
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
            let node = match one == other {
                true => nodes[one].clone(),
                false => self.section_of_pair(root, shared, [one, other], &nodes)?,
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
        // All of them are evaluated, for the sake of all errors.
        let values: Vec<Option<T>> = (0..self.species.len().max(1)).map(value).collect();
        BySpecies::of_species(values.into_iter().collect::<Option<_>>()?)
    }
}

/// What is said of the attraction has no meaning in a file without it.
fn require_cohesion(root: &Section<'_>, node: &Node, name: &str) {
    let of_stages = root.node.get("stage").map(Node::items).unwrap_or_default();
    let is_there =
        std::iter::once(root.node).chain(of_stages).any(|at| at.get("cohesion").is_some());
    if let (false, Some(given)) = (is_there, node.get("cohesion")) {
        let message = format!("belongs to a [cohesion], which is missing: a {name} changes it");
        root.problems.add(given.error(message));
    }
}
