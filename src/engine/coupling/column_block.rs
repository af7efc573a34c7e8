//! A block of particles in a vertical grid, component by component.

use crate::grid::ColumnGrid;
use crate::numbers::{F64x4, four, four_mut};
use crate::particles::{Body, LANES, Lanes};

/// Positions of the particles of a block in the column, and the quantities that the gas needs of them. Lanes beyond the
/// last particle repeat it.
#[derive(Clone, Debug, Default)]
#[repr(align(64))] // see `Lanes`
pub(crate) struct ColumnBlock {
    /// Interval of the grid.
    pub(crate) interval: [u32; LANES],
    /// Hat weight of its upper node.
    pub(crate) of_upper: Lanes,
    pub(crate) radius: Lanes,
    pub(crate) velocity: [Lanes; 3],
}

impl ColumnBlock {
    /// Loads up to `LANES` particles, at least one, into lanes.
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
            let nodes = grid.weights(height);
            self.interval[lane] = nodes.interval;
            self.of_upper[lane] = nodes.of_upper;
        }
    }

    /// Linear interpolation of two fields to the particles, with the weights of deposition.
    #[inline(always)]
    pub(crate) fn interpolate<Q: F64x4>(
        &self,
        in_intervals: &[[f64; 4]],
        [first, second]: [&mut Lanes; 2],
    ) {
        for from in (0..LANES).step_by(4) {
            let mut rows = [Q::splat(0.0); 4];
            for row in 0..4 {
                rows[row] = Q::load(&in_intervals[self.interval[from + row] as usize]);
            }
            let weight = Q::load(four(&self.of_upper, from));
            let [lower, change, second_lower, second_change] = Q::transposed(rows);
            lower.plus(weight.times(change)).store(four_mut(first, from));
            second_lower.plus(weight.times(second_change)).store(four_mut(second, from));
        }
    }
}

/// Coefficients of two fields at the nodes of a grid, for each interval: the first field's value at the lower end and
/// its change to the upper end, then the same for the second field.
pub(crate) fn interval_fields(
    grid: &ColumnGrid,
    [first, second]: [&[f64]; 2],
    in_intervals: &mut Vec<[f64; 4]>,
) {
    in_intervals.clear();
    in_intervals.extend((0..grid.intervals()).map(|interval| {
        let [lower, upper] = grid.ends(interval);
        [first[lower], first[upper] - first[lower], second[lower], second[upper] - second[lower]]
    }));
}
