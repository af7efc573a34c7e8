//! Connected sets of particles, whatever ranks hold the particles and the pairs.
//!
//! 1. Each rank joins what its own pairs connect (`local_forest`).
//! 2. A particle that two ranks know says that their local sets are one: an edge between the roots of these sets.
//! 3. This much smaller graph is contracted in rounds over all ranks (`contraction`).
//!
//! The label of a set is its smallest id: it depends on the pairs alone. So does the image of a particle relative to
//! the particle with that id, as long as the set does not wind around a periodic box.

mod contraction;
mod local_forest;
#[cfg(test)]
mod tests;

use super::periodicity::Image;
use super::rendezvous::{distinct, send_to_rendezvous};
use crate::parallel::Communicator;
use bytemuck::{Pod, Zeroable};
use contraction::Nodes;
use local_forest::LocalForest;

/// Two particles that belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Pod, Zeroable)]
#[repr(C)]
pub struct Link {
    /// The ids of a and b.
    pub ends: [u64; 2],
    /// The image of b that is linked to a, of positions inside of the box.
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
    /// The particle's image in the frame of the particle with that id: where it lies in the unwrapped set. Along an
    /// axis along which the set winds around the box there is no such frame, and the image is 0.
    pub image: Image,
    /// Whether a chain of links leads from a particle to another image of itself, by axis.
    pub winds: [bool; 3],
}

/// The connected set of each of this rank's particles, in the order of `ids`. Each link is held by any rank, or by
/// several. Collective.
///
/// Every rank needs memory for its own ids and links and its share of the ids that several ranks name. The number of
/// rounds of messages grows with the logarithm of the number of sets that ranks share.
pub fn components(ids: &[u64], links: &[Link], ranks: &dyn Communicator) -> Vec<Membership> {
    components_in_rounds(ids, links, ranks).0
}

fn components_in_rounds(
    ids: &[u64],
    links: &[Link],
    ranks: &dyn Communicator,
) -> (Vec<Membership>, u32) {
    let mut forest = LocalForest::new(ids, links);
    let roots = forest.roots();
    let mut edges = edges_between_roots(&forest.ids, &roots, ranks);
    let windings = forest.windings.iter();
    edges.extend(windings.map(|&(root, axes)| Link::new([root; 2], axes)));
    let nodes = Nodes::contract(edges, ranks);
    let sets = nodes.sets_of(distinct(roots.iter().map(|&(root, _)| root)), ranks);
    let membership = |id: &u64| {
        let place = forest.ids.binary_search(id).unwrap_or(0);
        let (root, image) = roots[place];
        let set = sets.get(root);
        let (label, frame, winds) =
            set.map_or((root, [0; 3], [0; 3]), |set| (set.label, set.image, set.winds));
        let image = plus(image, frame);
        let image = std::array::from_fn(|axis| if winds[axis] == 0 { image[axis] } else { 0 });
        Membership { label, image, winds: winds.map(|winds| winds != 0) }
    };
    (ids.iter().map(membership).collect(), nodes.rounds)
}

/// A particle in a rank's local set.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Pod, Zeroable)]
#[repr(C)]
struct InLocalSet {
    id: u64,
    root: u64,
    /// In the frame of the root.
    image: Image,
    padding: u32,
}

/// Edges between the roots of ranks' local sets that share a particle, on the rendezvous rank of that particle.
/// Collective.
fn edges_between_roots(ids: &[u64], roots: &[(u64, Image)], ranks: &dyn Communicator) -> Vec<Link> {
    let records = ids.iter().zip(roots);
    let records = records.map(|(&id, &(root, image))| InLocalSet { id, root, image, padding: 0 });
    let mut records = send_to_rendezvous(records, |record| record.id, ranks);
    records.sort_unstable();
    let mut edges = Vec::new();
    for group in records.chunk_by(|a, b| a.id == b.id) {
        // Ascending roots.
        edges.extend(group[1..].iter().filter_map(|other| {
            let edge = Link::new([group[0].root, other.root], minus(group[0].image, other.image));
            (edge.ends[0] != edge.ends[1] || edge.image != [0; 3]).then_some(edge)
        }));
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
