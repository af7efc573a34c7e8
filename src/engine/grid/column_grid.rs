//! The vertical grid of the one-dimensional gas.

use crate::domain::Bounds;
use crate::numbers::whole;

/// Nodes at heights k dz from the bottom of the box, where node 0 lies on the plate, to its top. In a periodic box node
/// `nodes` is node 0 again.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnGrid {
    spacing: f64,
    nodes: usize,
    periodic: bool,
    cross_section: f64,
    height: f64,
    base_volume: f64,
}

/// The two nodes around a height, and their weights in linear interpolation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeWeights {
    /// The interval between the two nodes, which is the index of the lower one.
    pub interval: u32,
    /// Weight h = 1 - |z - z_node| / dz of the upper node; that of the lower one is 1 - h.
    pub of_upper: f64,
}

impl ColumnGrid {
    /// A grid over the box. `base_part` is the fraction of a full cell over which node 0 averages (1 or 1/2).
    pub fn new(bounds: &Bounds, spacing: f64, base_part: f64) -> Self {
        let height = bounds.lengths().z;
        let periodic = bounds.is_periodic(2);
        let nodes = if periodic {
            (height / spacing).round() as usize
        } else {
            (height / spacing).ceil() as usize + 1
        };
        let cross_section = bounds.cross_section();
        let base_part = if periodic { 1.0 } else { base_part };
        let base_volume = base_part * cross_section * spacing;
        Self { spacing, nodes, periodic, cross_section, height, base_volume }
    }

    /// This grid in a column of this horizontal cross-section within the box.
    pub fn within(self, cross_section: f64) -> Self {
        let base_volume = self.base_volume * (cross_section / self.cross_section);
        Self { cross_section, base_volume, ..self }
    }

    /// Horizontal cross-section S.
    pub fn cross_section(&self) -> f64 {
        self.cross_section
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.nodes
    }

    /// Distance dz between two nodes.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// Whether node 0 is above the last one.
    pub fn is_periodic(&self) -> bool {
        self.periodic
    }

    /// Height of a node.
    pub fn height_of(&self, node: usize) -> f64 {
        node as f64 * self.spacing
    }

    /// Volume over which a node averages: S dz, or for node 0 the fraction of it given to [`ColumnGrid::new`].
    pub fn volume_of(&self, node: usize) -> f64 {
        if node == 0 { self.base_volume } else { self.cross_section * self.spacing }
    }

    /// Volume of a full cell, S dz.
    pub fn cell_volume(&self) -> f64 {
        self.cross_section * self.spacing
    }

    /// Number of intervals between nodes.
    pub fn intervals(&self) -> usize {
        if self.periodic { self.nodes } else { self.nodes - 1 }
    }

    /// The nodes at the lower and upper end of an interval.
    pub fn ends(&self, interval: usize) -> [usize; 2] {
        [interval, if interval + 1 == self.nodes { 0 } else { interval + 1 }]
    }

    /// The height wrapped into the box if that is periodic, otherwise the height itself.
    #[inline(always)]
    pub fn wrap(&self, z: f64) -> f64 {
        if self.periodic { z - self.height * (z / self.height).floor() } else { z }
    }

    /// The nodes around a wrapped height and their weights. Below the lowest node and above the highest, this node has
    /// all the weight. There are no branches, so that loops over it are vectorised.
    #[inline(always)]
    pub fn weights(&self, z: f64) -> NodeWeights {
        let cells = z / self.spacing;
        let highest = (self.intervals() - 1) as f64;
        let within = if cells > 0.0 { cells } else { 0.0 };
        let lower = if within < highest { within.floor() } else { highest };
        NodeWeights { interval: whole(lower), of_upper: (cells - lower).clamp(0.0, 1.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::Face;
    use nalgebra::Vector3;

    fn bounds(z: [Face; 2]) -> Bounds {
        let periodic = [Face::Periodic; 2];
        Bounds::new(Vector3::new(2.0, 3.0, 9.0), [periodic, periodic, z])
    }

    #[test]
    fn an_open_column_has_nodes_on_the_plate_and_at_the_top() {
        let grid = ColumnGrid::new(&bounds([Face::Wall, Face::Open]), 1.5, 0.5);
        assert_eq!(grid.nodes(), 7);
        assert_eq!((grid.volume_of(0), grid.volume_of(1)), (4.5, 9.0));
        assert_eq!((grid.intervals(), grid.ends(5)), (6, [5, 6]));
        assert_eq!(grid.weights(2.25), NodeWeights { interval: 1, of_upper: 0.5 });
        assert_eq!(grid.weights(-0.1), NodeWeights { interval: 0, of_upper: 0.0 });
        assert_eq!(grid.weights(9.5), NodeWeights { interval: 5, of_upper: 1.0 });
    }

    #[test]
    fn in_a_periodic_column_the_last_interval_ends_at_node_0() {
        let grid = ColumnGrid::new(&bounds([Face::Periodic; 2]), 1.5, 0.5);
        assert_eq!(grid.nodes(), 6);
        assert_eq!(grid.volume_of(0), 9.0);
        assert_eq!((grid.intervals(), grid.ends(5)), (6, [5, 0]));
        assert_eq!(grid.weights(8.25), NodeWeights { interval: 5, of_upper: 0.5 });
        assert_eq!(grid.weights(grid.wrap(8.25 - 9.0)), grid.weights(8.25));
    }
}
