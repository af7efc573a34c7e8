//! Connected sets among the pairs that one rank holds: union-find with images.

use super::{minus, plus};
use crate::particle_sets::periodicity::Image;

/// A forest of numbered nodes in which each tree is a connected set (Tarjan 1975, doi:10.1145/321879.321884). Every
/// node stores its image in the frame of its parent, which is the sum along the tree of the nearest images of partners.
pub(super) struct LocalForest<'a> {
    /// Ids by node: when two roots are joined, the one with the lower id becomes the parent.
    ids: &'a [u64],
    nodes: Vec<Node>,
    /// Nodes at which a chain of links returned to its start in another image, with its windings by axis: 1 or 0.
    windings: Vec<(u32, Image)>,
}

#[derive(Clone, Copy)]
struct Node {
    /// A root is its own parent.
    parent: u32,
    /// Image relative to the parent; zero for a root.
    image: Image,
}

/// A node in its tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct InTree {
    pub(super) root: u32,
    /// Image in the frame of the root.
    pub(super) image: Image,
}

/// A link between numbered nodes: from the first to this image of the second.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodeLink {
    pub(crate) ends: [u32; 2],
    pub(crate) image: Image,
}

impl<'a> LocalForest<'a> {
    /// The sets that these links connect.
    pub(super) fn new(ids: &'a [u64], links: &[NodeLink]) -> Self {
        let nodes = (0..ids.len() as u32).map(|parent| Node { parent, image: [0; 3] }).collect();
        let mut forest = Self { ids, nodes, windings: Vec::new() };
        for link in links {
            forest.join(link);
        }
        forest
    }

    /// Root and image of a node.
    #[inline]
    pub(super) fn find(&mut self, node: u32) -> InTree {
        let mut root = node;
        let mut image = [0; 3];
        loop {
            let Node { parent, image: in_parent } = self.nodes[root as usize];
            if parent == root {
                return InTree { root, image };
            }
            let above = self.nodes[parent as usize];
            // Halves the path.
            let halved = Node { parent: above.parent, image: plus(in_parent, above.image) };
            self.nodes[root as usize] = halved;
            image = plus(image, halved.image);
            root = halved.parent;
        }
    }

    fn join(&mut self, link: &NodeLink) {
        let [a, b] = link.ends.map(|node| self.find(node));
        // Image of b's root in the frame of a's.
        let shift = minus(plus(a.image, link.image), b.image);
        if a.root == b.root {
            if shift != [0; 3] {
                self.windings.push((a.root, shift.map(|n| i32::from(n != 0))));
            }
        } else if self.ids[a.root as usize] < self.ids[b.root as usize] {
            self.nodes[b.root as usize] = Node { parent: a.root, image: shift };
        } else {
            self.nodes[a.root as usize] = Node { parent: b.root, image: minus([0; 3], shift) };
        }
    }

    /// Roots of trees that wind around the box, with their windings by axis: 1 or 0. Each root occurs once for each
    /// combination.
    pub(super) fn windings(&mut self) -> Vec<(u32, Image)> {
        // A tree may have been joined to another since it was found to wind.
        let mut windings = std::mem::take(&mut self.windings);
        windings.iter_mut().for_each(|(node, _)| *node = self.find(*node).root);
        windings.sort_unstable();
        windings.dedup();
        windings
    }
}
