//! A block of particles in the column of gas, component by component.

use crate::grid::ColumnGrid;
use crate::numbers::{F64x4, four_mut};
use crate::particles::{Body, LANES};

pub(super) type Lanes = [f64; LANES];

/// Where the particles of a block are in the column, and what the gas needs of them. Lanes beyond the last particle
/// repeat it.
#[derive(Clone, Debug, Default)]
pub(super) struct ColumnBlock {
    /// Interval of the grid.
    pub(super) interval: [u32; LANES],
    /// Hat weight of its upper node.
    pub(super) of_upper: Lanes,
    pub(super) radius: Lanes,
    pub(super) velocity: [Lanes; 3],
}

impl ColumnBlock {
    /// Brings up to `LANES` particles, at least one, into lanes.
    #[inline(always)]
    pub(super) fn gather<Q: F64x4>(&mut self, bodies: &[Body], grid: &ColumnGrid) {
        let last = bodies.len() - 1;
        let mut height = [0.0; LANES];
        let zero = [Q::splat(0.0); 4];
        for from in (0..LANES).step_by(4) {
            let (mut places, mut motions) = (zero, zero);
            for row in 0..4 {
                let [place, motion, _spin] = bodies[last.min(from + row)].vectors();
                places[row] = Q::load(place);
                motions[row] = Q::load(motion);
            }
            let [_, _, z, radius] = Q::transposed(places);
            z.store(four_mut(&mut height, from));
            radius.store(four_mut(&mut self.radius, from));
            for (component, lanes) in Q::transposed(motions).into_iter().zip(&mut self.velocity) {
                component.store(four_mut(lanes, from));
            }
        }
        if grid.is_periodic() {
            for height in &mut height {
                *height = grid.wrap(*height);
            }
        }
        for (lane, &height) in height.iter().enumerate() {
            let place = grid.place(height);
            self.interval[lane] = place.interval;
            self.of_upper[lane] = place.of_upper;
        }
    }
}
