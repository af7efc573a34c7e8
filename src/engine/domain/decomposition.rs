//! The decomposition of the box into subdomains, one for each rank: a grid of blocks between cut planes.

use super::Bounds;
use nalgebra::Vector3;
use std::fmt;

/// Number of ranks along x, y and z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RankGrid(pub [usize; 3]);

impl RankGrid {
    /// All ranks as slabs along one axis.
    pub fn slabs(axis: usize, ranks: usize) -> Self {
        let mut counts = [1; 3];
        counts[axis] = ranks;
        Self(counts)
    }

    /// Number of ranks; the largest representable number if it is larger than that.
    pub fn size(self) -> usize {
        self.0.iter().fold(1, |size: usize, &count| size.saturating_mul(count))
    }

    /// Position of a rank in the grid; x varies fastest.
    pub fn coordinates_of(self, rank: usize) -> [usize; 3] {
        let [nx, ny, _] = self.0;
        [rank % nx, (rank / nx) % ny, rank / (nx * ny)]
    }

    /// The rank at a position in the grid.
    pub fn rank_of(self, coordinates: [usize; 3]) -> usize {
        let [nx, ny, _] = self.0;
        coordinates[0] + nx * (coordinates[1] + ny * coordinates[2])
    }
}

impl fmt::Display for RankGrid {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [nx, ny, nz] = self.0;
        write!(formatter, "{nx},{ny},{nz}")
    }
}

/// A rectilinear decomposition: along each axis an increasing list of cut planes from 0 to the length of the box, with
/// one layer of subdomains between two of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Decomposition {
    grid: RankGrid,
    cut_planes: [Vec<f64>; 3],
}

impl Decomposition {
    /// Subdomains of equal size.
    pub fn even(grid: RankGrid, bounds: &Bounds) -> Self {
        let cut_planes = std::array::from_fn(|axis| {
            let (n, length) = (grid.0[axis], bounds.lengths()[axis]);
            let inner = (0..n).map(|plane| length * plane as f64 / n as f64);
            inner.chain([length]).collect() // the quotient may miss the face by a rounding
        });
        Self { grid, cut_planes }
    }

    /// This grid of ranks with other cut planes; each list increases from 0 to the length of the box.
    pub fn with_cut_planes(&self, cut_planes: [Vec<f64>; 3]) -> Self {
        debug_assert!(
            (0..3).all(|a| cut_planes[a].len() == self.grid.0[a] + 1 && cut_planes[a].is_sorted())
        );
        Self { grid: self.grid, cut_planes }
    }

    /// Number of ranks along each axis.
    pub fn grid(&self) -> RankGrid {
        self.grid
    }

    /// Cut planes along an axis, the box's faces included.
    pub fn cut_planes(&self, axis: usize) -> &[f64] {
        &self.cut_planes[axis]
    }

    /// The rank that owns a point of the box. Points beyond a face belong to the subdomain at that face.
    pub fn owner_of(&self, position: &Vector3<f64>) -> usize {
        let coordinates = std::array::from_fn(|axis| {
            let inner = &self.cut_planes[axis][1..self.grid.0[axis]];
            inner.partition_point(|&plane| plane <= position[axis])
        });
        self.grid.rank_of(coordinates)
    }

    /// Lower and upper corner of a rank's subdomain.
    pub fn subdomain_corners(&self, rank: usize) -> [Vector3<f64>; 2] {
        let coordinates = self.grid.coordinates_of(rank);
        [0, 1]
            .map(|side| Vector3::from_fn(|axis, _| self.cut_planes[axis][coordinates[axis] + side]))
    }

    /// The ranks below and above along an axis; at a periodic face, the one at the opposite face.
    pub fn neighbours(&self, rank: usize, axis: usize, bounds: &Bounds) -> [Option<usize>; 2] {
        let coordinates = self.grid.coordinates_of(rank);
        let n = self.grid.0[axis];
        let along = |index: usize| {
            let mut other = coordinates;
            other[axis] = index;
            Some(self.grid.rank_of(other))
        };
        let periodic = bounds.is_periodic(axis);
        let below = match coordinates[axis] {
            0 if !periodic => None,
            0 => along(n - 1),
            index => along(index - 1),
        };
        let above = match coordinates[axis] + 1 {
            next if next < n => along(next),
            _ if periodic => along(0),
            _ => None,
        };
        [below, above]
    }

    /// Width of the narrowest subdomain along an axis.
    pub fn narrowest(&self, axis: usize) -> f64 {
        self.widths(axis).fold(f64::INFINITY, f64::min)
    }

    /// Width of the widest subdomain along an axis.
    pub fn widest(&self, axis: usize) -> f64 {
        self.widths(axis).fold(0.0, f64::max)
    }

    fn widths(&self, axis: usize) -> impl Iterator<Item = f64> {
        self.cut_planes[axis].windows(2).map(|pair| pair[1] - pair[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::Face;
    use proptest::prelude::*;

    fn bounds() -> Bounds {
        let periodic = [Face::Periodic; 2];
        Bounds::new(Vector3::new(5.0, 6.0, 7.0), [periodic, periodic, [Face::Wall, Face::Open]])
    }

    #[test]
    fn the_last_plane_is_the_face_of_the_box() {
        let mut missed = 0;
        for (n, tenths) in (1..40).flat_map(|n| (50..400).map(move |tenths| (n, tenths))) {
            let lengths = Vector3::new(0.1 * f64::from(tenths), 5.0, 5.0);
            let bounds = Bounds::new(lengths, [[Face::Periodic; 2]; 3]);
            let length = bounds.lengths().x;
            let even = Decomposition::even(RankGrid([n, 1, 1]), &bounds);
            assert_eq!(even.cut_planes(0).last(), Some(&length));
            missed += u32::from(length * n as f64 / n as f64 != length);
        }
        assert!(missed > 0, "the control: a quotient misses some of them by a rounding");
    }

    proptest! {
        #[test]
        fn each_point_is_owned_by_the_rank_whose_subdomain_holds_it(
            x in 0.0..5.0f64, y in 0.0..6.0f64, z in 0.0..7.0f64,
            n in prop::array::uniform3(1usize..4),
        ) {
            let decomposition = Decomposition::even(RankGrid(n), &bounds());
            let point = Vector3::new(x, y, z);
            let holders: Vec<usize> = (0..decomposition.grid().size()).filter(|&rank| {
                let [lower, upper] = decomposition.subdomain_corners(rank);
                (0..3).all(|a| lower[a] <= point[a] && point[a] < upper[a])
            }).collect();
            prop_assert_eq!(holders, vec![decomposition.owner_of(&point)]);
        }

        #[test]
        fn a_neighbour_above_has_this_rank_below(n in prop::array::uniform3(1usize..4)) {
            let bounds = bounds();
            let decomposition = Decomposition::even(RankGrid(n), &bounds);
            for rank in 0..decomposition.grid().size() {
                for axis in 0..3 {
                    if let Some(above) = decomposition.neighbours(rank, axis, &bounds)[1] {
                        prop_assert_eq!(decomposition.neighbours(above, axis, &bounds)[0], Some(rank));
                    }
                }
            }
        }
    }

    #[test]
    fn points_beyond_a_face_belong_to_the_outermost_rank() {
        let decomposition = Decomposition::even(RankGrid([1, 1, 3]), &bounds());
        assert_eq!(decomposition.owner_of(&Vector3::new(0.0, 0.0, 99.0)), 2);
        assert_eq!(decomposition.owner_of(&Vector3::new(0.0, 0.0, -1.0)), 0);
    }
}
