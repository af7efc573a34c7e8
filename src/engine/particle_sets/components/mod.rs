//! Connected sets of particles, for any distribution of the particles and the pairs over ranks.
//!
//! 1. Each rank joins the particles that its own pairs connect (`local_forest`).
//! 2. A particle that another rank's pairs name connects the local sets of both ranks: this is an edge between their
//!    roots.
//! 3. This much smaller graph is contracted in rounds over all ranks (`contraction`).
//!
//! The label of a set is its smallest id, which depends only on the pairs. The same holds for the image of a particle
//! relative to the particle with this id, as long as the set does not wind around a periodic box.

mod contraction;
mod local_forest;
#[cfg(test)]
mod tests;

use super::ownership::{Foreign, Ownership};
use super::periodicity::Image;
use super::rendezvous::distinct;
use crate::parallel::Communicator;
use bytemuck::{Pod, Zeroable};
use contraction::Nodes;
pub(crate) use local_forest::NodeLink;
use local_forest::{InTree, LocalForest};

/// Two particles that belong to the same set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Pod, Zeroable)]
#[repr(C)]
pub struct Link {
    /// The ids of a and b.
    pub ends: [u64; 2],
    /// The image of b that is linked to a, for positions inside the box.
    pub image: Image,
    padding: u32,
}

impl Link {
    /// A link of particle `ends[0]` to this image of particle `ends[1]`.
    pub fn new(ends: [u64; 2], image: Image) -> Self {
        Self { ends, image, padding: 0 }
    }
}

/// The connected set of a particle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Membership {
    /// The smallest id of the set.
    pub label: u64,
    /// The particle's image in the frame of the particle with that id, which gives its position in the unwrapped set.
    /// Along an axis along which the set winds around the box there is no such frame, and the image is 0.
    pub image: Image,
    /// Whether a chain of links leads from a particle to another image of itself, by axis.
    pub winds: [bool; 3],
}

/// The connected set of each of this rank's particles, in the order of `ids`. Each link is on any rank, or on several;
/// each of its ends is among the ids of one rank. Collective.
///
/// Every rank needs memory for its own ids and links, and for those of other ranks that its links name. The number of
/// rounds of messages grows with the logarithm of the number of sets that ranks share.
pub fn components(ids: &[u64], links: &[Link], ranks: &dyn Communicator) -> Vec<Membership> {
    components_in_rounds(ids, links, ranks).0
}

fn components_in_rounds(
    ids: &[u64],
    links: &[Link],
    ranks: &dyn Communicator,
) -> (Vec<Membership>, u32) {
    let owned = Ownership::of(distinct(ids.iter().copied()));
    let ends = links.iter().flat_map(|link| link.ends);
    let foreign = ends.filter(|&id| owned.place_of(id).is_none()).collect();
    let foreign = Foreign::find(foreign, &owned, ranks);
    let nodes = NodeIds::of(&owned, &foreign);
    let links = links.iter().filter_map(|link| {
        let [a, b] = link.ends.map(|id| nodes.node_of(id));
        Some(NodeLink { ends: [a?, b?], image: link.image })
    });
    let sets = ConnectedSets::of(&nodes, &links.collect::<Vec<_>>(), ranks);
    let membership = |&id: &u64| sets.membership(owned.place_of(id).unwrap_or_default(), id);
    (ids.iter().map(membership).collect(), sets.rounds)
}

/// The particles that a rank knows, as numbered nodes: first its own, then those of other ranks.
pub(crate) struct NodeIds<'a> {
    pub(crate) owned: &'a Ownership,
    pub(crate) foreign: &'a Foreign,
    ids: Vec<u64>,
}

impl<'a> NodeIds<'a> {
    pub(crate) fn of(owned: &'a Ownership, foreign: &'a Foreign) -> Self {
        Self { owned, foreign, ids: [owned.ids(), foreign.ids()].concat() }
    }

    /// The node of a particle; `None` if this rank does not know it, or no rank owns it.
    #[inline]
    pub(crate) fn node_of(&self, id: u64) -> Option<u32> {
        if let Some(place) = self.owned.place_of(id) {
            return Some(place as u32);
        }
        let place = self.foreign.place_of(id)?;
        Some((self.owned.ids().len() + place) as u32)
    }
}

/// The connected sets of a rank's particles.
pub(crate) struct ConnectedSets {
    /// An entry for each particle, by its place; unset for particles without links.
    in_set: Vec<InSet>,
    /// The sets, several of which may have the same label: these are parts of a set that are connected on another rank.
    pub(crate) parts: Vec<Part>,
    rounds: u32,
}

/// A particle in a part of a set.
#[derive(Clone, Copy, Debug)]
struct InSet {
    /// Number of the part; unset for a particle without links.
    part: u32,
    /// Image in the frame of the part's root.
    image: Image,
}

const NO_PART: u32 = u32::MAX;

/// A part of a connected set: particles that are connected on this rank.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    /// The smallest id of the set.
    pub(crate) label: u64,
    /// Image of the part's root in the frame of the particle with that id.
    frame: Image,
    /// Whether the set winds around the box, by axis.
    pub(crate) winds: [bool; 3],
}

/// Data of a particle, sent to its owner.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Pod, Zeroable)]
#[repr(C)]
struct InLocalSet {
    id: u64,
    root: u64,
    /// Image in the frame of the root.
    image: Image,
    padding: u32,
}

impl ConnectedSets {
    /// The sets formed by the links of all ranks. Collective.
    pub(crate) fn of(nodes: &NodeIds<'_>, links: &[NodeLink], ranks: &dyn Communicator) -> Self {
        let mut forest = LocalForest::new(&nodes.ids, links);
        let mut is_linked = vec![false; nodes.ids.len()];
        links
            .iter()
            .for_each(|link| link.ends.iter().for_each(|&end| is_linked[end as usize] = true));
        let mut edges = shared_edges(nodes, &mut forest, &mut is_linked, ranks);
        let windings = forest.windings().into_iter();
        edges.extend(windings.map(|(root, axes)| Link::new([nodes.ids[root as usize]; 2], axes)));
        let contracted = Nodes::contract(edges, ranks);

        let mut part_of_root = vec![NO_PART; nodes.ids.len()];
        let mut roots = Vec::new();
        let in_set = (0..nodes.owned.ids().len()).map(|place| {
            if !is_linked[place] {
                return InSet { part: NO_PART, image: [0; 3] };
            }
            let InTree { root, image } = forest.find(place as u32);
            let part = &mut part_of_root[root as usize];
            if *part == NO_PART {
                *part = roots.len() as u32;
                roots.push(nodes.ids[root as usize]);
            }
            InSet { part: *part, image }
        });
        let in_set = in_set.collect();
        let sets = contracted.sets_of(distinct(roots.iter().copied()), ranks);
        let part = |&root: &u64| {
            let set = sets.get(root).unwrap_or_else(|| contraction::alone(root));
            Part { label: set.label, frame: set.image, winds: set.winds.map(|winds| winds != 0) }
        };
        Self { in_set, parts: roots.iter().map(part).collect(), rounds: contracted.rounds }
    }

    /// The part of the particle at a place; `None` for a particle without links.
    #[inline]
    pub(crate) fn part_of(&self, place: usize) -> Option<usize> {
        let part = self.in_set[place].part;
        (part != NO_PART).then_some(part as usize)
    }

    /// The image of the particle at a place in the unwrapped set.
    #[inline]
    pub(crate) fn image_of(&self, place: usize) -> Image {
        let InSet { part, image } = self.in_set[place];
        if part == NO_PART {
            return [0; 3];
        }
        let Part { frame, winds, .. } = self.parts[part as usize];
        let image = plus(image, frame);
        std::array::from_fn(|axis| if winds[axis] { 0 } else { image[axis] })
    }

    /// The set of the particle at a place, which has this id.
    fn membership(&self, place: usize, id: u64) -> Membership {
        match self.part_of(place).map(|part| self.parts[part]) {
            Some(Part { label, winds, .. }) => {
                Membership { label, image: self.image_of(place), winds }
            }
            None => Membership { label: id, image: [0; 3], winds: [false; 3] },
        }
    }
}

/// Edges between the roots of local sets that share a particle, on the rank that owns it. The particles that other
/// ranks know are marked as linked. Collective.
fn shared_edges(
    nodes: &NodeIds<'_>,
    forest: &mut LocalForest<'_>,
    is_linked: &mut [bool],
    ranks: &dyn Communicator,
) -> Vec<Link> {
    let first = nodes.owned.ids().len();
    let known: Vec<InTree> =
        (first..nodes.ids.len()).map(|node| forest.find(node as u32)).collect();
    let record = |place: usize| {
        let InTree { root, image } = known[place];
        let (id, root) = (nodes.foreign.ids()[place], nodes.ids[root as usize]);
        InLocalSet { id, root, image, padding: 0 }
    };
    let mut edges = Vec::new();
    for InLocalSet { id, root: other, image: in_other, .. } in nodes.foreign.notify(record, ranks) {
        let Some(place) = nodes.owned.place_of(id) else { continue };
        is_linked[place] = true;
        let InTree { root, image } = forest.find(place as u32);
        let edge = Link::new([nodes.ids[root as usize], other], minus(image, in_other));
        if edge.ends[0] != edge.ends[1] || edge.image != [0; 3] {
            edges.push(edge);
        }
    }
    edges.sort_unstable();
    edges.dedup();
    edges
}

/// Sums wrap around: no chain of links winds two thousand million times around a box.
fn plus(a: Image, b: Image) -> Image {
    std::array::from_fn(|axis| a[axis].wrapping_add(b[axis]))
}

fn minus(a: Image, b: Image) -> Image {
    std::array::from_fn(|axis| a[axis].wrapping_sub(b[axis]))
}
