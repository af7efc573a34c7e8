//! Connected sets of a graph whose edges are spread over ranks, by repeated contraction.
//!
//! In each round every node draws a rank among its neighbours' by hashing its id, and hooks itself onto the neighbour
//! with the lowest draw if this is below its own; trees are flattened by pointer jumping, and edges are moved to the
//! roots (Shiloach & Vishkin 1982, doi:10.1016/0196-6774(82)90008-6, with random instead of fixed priorities). At most
//! half of the nodes are expected to be lowest among their neighbours, so the number of rounds grows with the logarithm
//! of the number of nodes, whatever the graph.

use super::{Link, minus, plus};
use crate::parallel::Communicator;
use crate::particle_sets::periodicity::Image;
use crate::particle_sets::rendezvous::{Answers, ask, mixed, send_to_rendezvous};
use bytemuck::{Pod, Zeroable};

/// A node on its rendezvous rank.
#[derive(Clone, Copy, Debug)]
struct Node {
    id: u64,
    /// A root is its own parent.
    parent: u64,
    /// Image in the frame of the parent.
    image: Image,
    /// Whether a chain of links winds around the box, by axis: 1 or 0.
    winds: Image,
}

/// The connected set of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct SetOfNode {
    /// The smallest id of the set.
    pub(super) label: u64,
    /// Image of the node in the frame of the node with that id.
    pub(super) image: Image,
    /// Whether the set winds around the box, by axis: 1 or 0.
    pub(super) winds: Image,
}

/// A parent, as sent to its child.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Parent {
    id: u64,
    image: Image,
    padding: u32,
}

/// A request of a node to be hooked onto another.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Pod, Zeroable)]
#[repr(C)]
struct Proposal {
    child: u64,
    /// The parent's draw of this round.
    draw: u64,
    parent: u64,
    /// Image of the child in the frame of the parent.
    image: Image,
    padding: u32,
}

/// Data of a whole set, or of a part of it.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Summary {
    root: u64,
    set: SetOfNode,
}

/// The nodes whose rendezvous is this rank, by ascending id.
pub(super) struct Nodes {
    nodes: Vec<Node>,
    /// For each root: the smallest id, its image in the frame of the root, and windings.
    sets: Vec<Summary>,
    /// Number of rounds that were needed.
    pub(super) rounds: u32,
}

impl Nodes {
    /// The connected sets of the nodes that these edges join, on any ranks; an edge from a node to itself gives the
    /// axes along which its set winds around the box. Collective.
    pub(super) fn contract(edges: Vec<Link>, ranks: &dyn Communicator) -> Self {
        let mut ids = send_to_rendezvous(edges.iter().flat_map(|edge| edge.ends), |&id| id, ranks);
        ids.sort_unstable();
        ids.dedup();
        let new = |id| Node { id, parent: id, image: [0; 3], winds: [0; 3] };
        let nodes = ids.into_iter().map(new).collect();
        let mut nodes = Self { nodes, sets: Vec::new(), rounds: 0 };
        let (mut windings, mut edges): (Vec<Link>, Vec<Link>) =
            edges.into_iter().partition(|edge| edge.ends[0] == edge.ends[1]);
        while ranks.any(!edges.is_empty()) {
            let hooked = nodes.hook(&edges, ranks);
            nodes.flatten(hooked, ranks);
            edges = nodes.at_roots(edges, &mut windings, ranks);
            nodes.rounds += 1;
        }
        nodes.flatten((0..nodes.nodes.len()).collect(), ranks);
        nodes.note_windings(windings, ranks);
        nodes.summarise(ranks);
        nodes
    }

    fn find(&self, id: u64) -> Option<&Node> {
        let place = self.nodes.binary_search_by_key(&id, |node| node.id).ok()?;
        self.nodes.get(place)
    }

    /// The parent of a node whose rendezvous is this rank.
    fn parent_of(&self, id: u64) -> Parent {
        let known = self.find(id).map(|node| (node.parent, node.image));
        let (id, image) = known.unwrap_or((id, [0; 3]));
        Parent { id, image, padding: 0 }
    }

    /// Hooks nodes onto the neighbour with the lowest draw; returns the indices of those that were hooked. Collective.
    fn hook(&mut self, edges: &[Link], ranks: &dyn Communicator) -> Vec<usize> {
        let draw = |id: u64| mixed(id ^ mixed(u64::from(self.rounds)));
        let proposals = edges.iter().map(|edge| {
            let [a, b] = edge.ends;
            if draw(a) < draw(b) {
                Proposal { child: b, draw: draw(a), parent: a, image: edge.image, padding: 0 }
            } else {
                let image = minus([0; 3], edge.image);
                Proposal { child: a, draw: draw(b), parent: b, image, padding: 0 }
            }
        });
        let proposals =
            send_to_rendezvous(lowest(proposals.collect()), |proposal| proposal.child, ranks);
        let mut hooked = Vec::new();
        for proposal in lowest(proposals) {
            if let Ok(place) = self.nodes.binary_search_by_key(&proposal.child, |node| node.id) {
                self.nodes[place].parent = proposal.parent;
                self.nodes[place].image = proposal.image;
                hooked.push(place);
            }
        }
        hooked
    }

    /// Lets each of these nodes point to its root (pointer jumping). Collective.
    fn flatten(&mut self, mut unresolved: Vec<usize>, ranks: &dyn Communicator) {
        while ranks.any(!unresolved.is_empty()) {
            let parents = unresolved.iter().map(|&place| self.nodes[place].parent);
            let grandparents = ask(parents, |id| self.parent_of(id), ranks);
            unresolved.retain(|&place| {
                let node = &mut self.nodes[place];
                let next = grandparents.get(node.parent).filter(|next| next.id != node.parent);
                if let Some(next) = next {
                    node.parent = next.id;
                    node.image = plus(node.image, next.image);
                }
                next.is_some()
            });
        }
    }

    /// The edges between roots that result from these edges; edges inside a tree are dropped, and used to record
    /// whether the tree winds around the box. Collective.
    fn at_roots(
        &self,
        edges: Vec<Link>,
        windings: &mut Vec<Link>,
        ranks: &dyn Communicator,
    ) -> Vec<Link> {
        let ends = edges.iter().flat_map(|edge| edge.ends);
        let parents = ask(ends, |id| self.parent_of(id), ranks);
        let moved = edges.iter().filter_map(|edge| moved_to_roots(edge, &parents));
        let (inside, mut between): (Vec<Link>, Vec<Link>) =
            moved.partition(|edge| edge.ends[0] == edge.ends[1]);
        windings.extend(inside.into_iter().filter(|edge| edge.image != [0; 3]));
        between.sort_unstable();
        between.dedup();
        between
    }

    /// Records the axes along which sets wind around the box. Collective.
    fn note_windings(&mut self, windings: Vec<Link>, ranks: &dyn Communicator) {
        for winding in send_to_rendezvous(windings, |winding| winding.ends[0], ranks) {
            let place = self.nodes.binary_search_by_key(&winding.ends[0], |node| node.id);
            if let Some(node) = place.ok().and_then(|place| self.nodes.get_mut(place)) {
                node.winds = either(node.winds, winding.image);
            }
        }
    }

    /// Finds the smallest id of each set, on the rendezvous rank of its root. Collective.
    fn summarise(&mut self, ranks: &dyn Communicator) {
        let of_nodes = self.nodes.iter().map(|node| {
            let set = SetOfNode { label: node.id, image: node.image, winds: node.winds };
            Summary { root: node.parent, set }
        });
        let of_nodes = merged(of_nodes.collect());
        self.sets = merged(send_to_rendezvous(of_nodes, |summary| summary.root, ranks));
    }

    /// The sets of some nodes, whatever their rendezvous ranks; a node without edges is a set of its own. Collective.
    pub(super) fn sets_of(&self, ids: Vec<u64>, ranks: &dyn Communicator) -> Answers<SetOfNode> {
        let roots = self.nodes.iter().map(|node| node.parent);
        let of_root = |root: u64| {
            let place = self.sets.binary_search_by_key(&root, |summary| summary.root);
            place.map_or(alone(root), |place| self.sets[place].set)
        };
        let of_roots = ask(roots, of_root, ranks);
        let of_node = |id: u64| {
            let node = self.find(id)?;
            let set = of_roots.get(node.parent)?;
            Some(SetOfNode { image: minus(node.image, set.image), ..set })
        };
        ask(ids, |id| of_node(id).unwrap_or_else(|| alone(id)), ranks)
    }
}

/// The set of a node without edges.
pub(super) fn alone(id: u64) -> SetOfNode {
    SetOfNode { label: id, image: [0; 3], winds: [0; 3] }
}

/// The first proposal of each child.
fn lowest(mut proposals: Vec<Proposal>) -> Vec<Proposal> {
    proposals.sort_unstable();
    proposals.dedup_by_key(|proposal| proposal.child);
    proposals
}

fn moved_to_roots(edge: &Link, parents: &Answers<Parent>) -> Option<Link> {
    let [a, b] = edge.ends;
    let (a, b) = (parents.get(a)?, parents.get(b)?);
    let shift = minus(plus(a.image, edge.image), b.image);
    Some(if a.id <= b.id {
        Link::new([a.id, b.id], shift)
    } else {
        Link::new([b.id, a.id], minus([0; 3], shift))
    })
}

/// One summary for each root.
fn merged(mut summaries: Vec<Summary>) -> Vec<Summary> {
    summaries.sort_unstable_by_key(|summary| (summary.root, summary.set.label));
    let of_one_root = summaries.chunk_by(|a, b| a.root == b.root);
    of_one_root
        .map(|group| {
            let winds = group.iter().fold([0; 3], |winds, part| either(winds, part.set.winds));
            Summary { root: group[0].root, set: SetOfNode { winds, ..group[0].set } }
        })
        .collect()
}

fn either(a: Image, b: Image) -> Image {
    std::array::from_fn(|axis| i32::from(a[axis] != 0 || b[axis] != 0))
}
