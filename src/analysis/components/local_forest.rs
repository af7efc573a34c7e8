//! Connected sets among the pairs that one rank holds: union-find with images.

use super::{Link, minus, plus};
use crate::analysis::periodicity::Image;
use crate::analysis::rendezvous::distinct;

/// A forest of particles, each of whose trees is a connected set (Tarjan 1975, doi:10.1145/321879.321884). Every
/// particle knows its image in the frame of its parent: that of the nearest image of a partner, summed along the
/// tree.
pub(super) struct LocalForest {
    /// Ascending.
    pub(super) ids: Vec<u64>,
    /// By index; a root is its own parent. The lower id is the parent.
    parent: Vec<u32>,
    /// Image relative to the parent.
    image: Vec<Image>,
    /// Roots at which a chain of links came back to its start in another image, and along which axes: 1 or 0.
    pub(super) windings: Vec<(u64, Image)>,
}

impl LocalForest {
    /// The sets that these links connect, of all particles named. Particles may be named again.
    pub(super) fn new(ids: &[u64], links: &[Link]) -> Self {
        let ends = links.iter().flat_map(|link| link.ends);
        let ids = distinct(ids.iter().copied().chain(ends));
        let parent = (0..ids.len() as u32).collect();
        let image = vec![[0; 3]; ids.len()];
        let mut forest = Self { ids, parent, image, windings: Vec::new() };
        for link in links {
            forest.join(link);
        }
        forest
    }

    /// Index and image of the root of each particle, in the order of `ids`.
    pub(super) fn roots(&mut self) -> Vec<(u64, Image)> {
        let indices = 0..self.ids.len();
        indices
            .map(|index| {
                let (root, image) = self.find(index);
                (self.ids[root], image)
            })
            .collect()
    }

    fn find(&mut self, mut index: usize) -> (usize, Image) {
        let mut image = [0; 3];
        loop {
            let parent = self.parent[index] as usize;
            if parent == index {
                return (index, image);
            }
            // Halves the path; a root's image is zero.
            self.image[index] = plus(self.image[index], self.image[parent]);
            self.parent[index] = self.parent[parent];
            image = plus(image, self.image[index]);
            index = self.parent[index] as usize;
        }
    }

    fn join(&mut self, link: &Link) {
        let place = |id| self.ids.binary_search(&id);
        let (Ok(a), Ok(b)) = (place(link.ends[0]), place(link.ends[1])) else { return };
        let ((root_a, image_a), (root_b, image_b)) = (self.find(a), self.find(b));
        // Image of b's root in the frame of a's.
        let shift = minus(plus(image_a, link.image), image_b);
        if root_a == root_b {
            if shift != [0; 3] {
                self.windings.push((self.ids[root_a], shift.map(|n| i32::from(n != 0))));
            }
        } else if root_a < root_b {
            self.parent[root_b] = root_a as u32;
            self.image[root_b] = shift;
        } else {
            self.parent[root_a] = root_b as u32;
            self.image[root_a] = minus([0; 3], shift);
        }
    }
}
