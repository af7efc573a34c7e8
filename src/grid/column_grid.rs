//! The vertical grid of the one-dimensional gas.

use crate::domain::Bounds;
use crate::numbers::whole;

/// Nodes at heights k dz, node 0 on the plate, from the bottom of the box to its top; in a periodic box
/// node `nodes` is node 0 again.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnGrid {
    spacing: f64,
    nodes: usize,
    periodic: bool,
    cross_section: f64,
    height: f64,
    base_volume: f64,
}

/// Where a height lies between two nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Interval between two nodes, by the number of the lower.
    pub interval: u32,
    /// Hat weight h = 1 - |z - z_node| / dz of the upper node; that of the lower is the rest to 1.
    pub of_upper: f64,
}

impl ColumnGrid {
    /// A grid over the box; `base_part` is the part of a full cell that node 0 averages over (1 or 1/2).
    pub fn new(bounds: &Bounds, spacing: f64, base_part: f64) -> Self {
        let height = bounds.lengths().z;
        let periodic = bounds.is_periodic(2);
        let nodes = match periodic {
            true => (height / spacing).round() as usize,
            false => (height / spacing).ceil() as usize + 1,
        };
        let cross_section = bounds.cross_section();
        let base_part = if periodic { 1.0 } else { base_part };
        let base_volume = base_part * cross_section * spacing;
        Self { spacing, nodes, periodic, cross_section, height, base_volume }
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.nodes
    }

    /// Distance dz of nodes.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// Whether node 0 follows the last one.
    pub fn is_periodic(&self) -> bool {
        self.periodic
    }

    /// Height of a node.
    pub fn height_of(&self, node: usize) -> f64 {
        node as f64 * self.spacing
    }

    /// Volume that a node averages over: S dz, for node 0 what the base node is said to have.
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

    /// The height within the box where that is periodic, and the height itself where not.
    #[inline(always)]
    pub fn wrap(&self, z: f64) -> f64 {
        if self.periodic { z - self.height * (z / self.height).floor() } else { z }
    }

    /// The place of a wrapped height; below the lowest node and above the highest that of the node. Without branches:
    /// loops over it run in vector instructions.
    #[inline(always)]
    pub fn place(&self, z: f64) -> Place {
        let cells = z / self.spacing;
        let highest = (self.intervals() - 1) as f64;
        let within = if cells > 0.0 { cells } else { 0.0 };
        let lower = if within < highest { within.floor() } else { highest };
        Place { interval: whole(lower), of_upper: (cells - lower).clamp(0.0, 1.0) }
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
    fn an_open_column_has_nodes_on_plate_and_top() {
        let grid = ColumnGrid::new(&bounds([Face::Wall, Face::Open]), 1.5, 0.5);
        assert_eq!(grid.nodes(), 7);
        assert_eq!((grid.volume_of(0), grid.volume_of(1)), (4.5, 9.0));
        assert_eq!((grid.intervals(), grid.ends(5)), (6, [5, 6]));
        assert_eq!(grid.place(2.25), Place { interval: 1, of_upper: 0.5 });
        assert_eq!(grid.place(-0.1), Place { interval: 0, of_upper: 0.0 });
        assert_eq!(grid.place(9.5), Place { interval: 5, of_upper: 1.0 });
    }

    #[test]
    fn a_periodic_column_closes_on_itself() {
        let grid = ColumnGrid::new(&bounds([Face::Periodic; 2]), 1.5, 0.5);
        assert_eq!(grid.nodes(), 6);
        assert_eq!(grid.volume_of(0), 9.0);
        assert_eq!((grid.intervals(), grid.ends(5)), (6, [5, 0]));
        assert_eq!(grid.place(8.25), Place { interval: 5, of_upper: 0.5 });
        assert_eq!(grid.place(grid.wrap(8.25 - 9.0)), grid.place(8.25));
    }
}
