//! Load balancing: cut planes that give every rank about the same work.

use super::Communicator;
use crate::domain::{Bounds, Decomposition};
use nalgebra::Vector3;
use std::time::Duration;

/// Number of bins, along each axis, of the histogram from which cut planes are chosen.
const BINS: usize = 1024;

/// Weight in the histogram of a particle of mean cost.
const MEAN_WEIGHT: f64 = 1024.0;

/// Range of a particle's cost relative to the mean. Particles in flight cost a tenth of those at rest on others; a
/// ratio outside this range is taken for an error of the measured time.
const COST_RANGE: [f64; 2] = [0.1, 10.0];

/// How evenly the work is distributed over the ranks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RankLoad {
    /// Maximum over mean of the ranks' times, or of their particle counts if no time is known; 1 if there are no
    /// particles.
    pub imbalance: f64,
    /// Time per particle of this rank, relative to that of all ranks.
    cost: f64,
}

impl RankLoad {
    /// The load before any time is known: all particles cost the same.
    pub const UNKNOWN: Self = Self { imbalance: f64::INFINITY, cost: 1.0 };

    /// From the processor time that this rank has spent on its particles, waiting excluded, and their number. This call
    /// is collective.
    pub fn measured(particles: usize, time: Duration, ranks: &dyn Communicator) -> Self {
        let mut sums = [particles as i64, time.as_nanos() as i64];
        let mut largest = sums.map(|own| own as f64);
        ranks.sum_integers(&mut sums);
        ranks.maximum(&mut largest);
        let [all_particles, all_time] = sums.map(|sum| sum as f64);
        let imbalance = |kind: usize| match sums[kind] {
            0 => 1.0,
            sum => largest[kind] * ranks.size() as f64 / sum as f64,
        };
        if all_time == 0.0 || particles == 0 {
            let known = if all_time == 0.0 { 0 } else { 1 };
            return Self { imbalance: imbalance(known), cost: 1.0 };
        }
        let cost = (time.as_nanos() as f64 / particles as f64) / (all_time / all_particles);
        Self { imbalance: imbalance(1), cost: cost.clamp(COST_RANGE[0], COST_RANGE[1]) }
    }

    /// The same rank grid with cut planes at the quantiles of the cost over the particles' coordinates. Subdomains are
    /// at least `least_width` wide; `positions` are those of the owned particles, wrapped. This call is collective.
    ///
    /// The planes change which rank does which work, never a result.
    pub fn balanced(
        &self,
        decomposition: &Decomposition,
        positions: impl Iterator<Item = Vector3<f64>> + Clone,
        bounds: &Bounds,
        least_width: f64,
        ranks: &dyn Communicator,
    ) -> Decomposition {
        let weight = (self.cost * MEAN_WEIGHT).round() as i64;
        let cut_planes = std::array::from_fn(|axis| {
            let n = decomposition.grid().0[axis];
            if n == 1 {
                return decomposition.cut_planes(axis).to_vec();
            }
            let length = bounds.lengths()[axis];
            let mut histogram = vec![0_i64; BINS];
            for position in positions.clone() {
                let bin = (position[axis] / length * BINS as f64) as usize; // a negative number becomes bin 0
                histogram[bin.min(BINS - 1)] += weight;
            }
            ranks.sum_integers(&mut histogram);
            quantiles(&histogram, n, length, least_width)
        });
        decomposition.with_cut_planes(cut_planes)
    }
}

/// n + 1 planes from 0 to `length` that divide the histogram into equal parts, at least `least_width` apart.
fn quantiles(histogram: &[i64], n: usize, length: f64, least_width: f64) -> Vec<f64> {
    let total: i64 = histogram.iter().sum();
    let bin_width = length / histogram.len() as f64;
    let mut planes = vec![0.0];
    let mut bin = 0;
    let mut below = 0; // sum of the bins below `bin`
    for plane in 1..n {
        let target = total as f64 * plane as f64 / n as f64;
        while bin < histogram.len() && ((below + histogram[bin]) as f64) < target {
            below += histogram[bin];
            bin += 1;
        }
        let inside = histogram.get(bin).map_or(0.0, |&count| {
            if count > 0 { (target - below as f64) / count as f64 } else { 0.0 }
        });
        let wanted = (bin as f64 + inside) * bin_width;
        let lowest = planes[plane - 1] + least_width;
        let highest = length - least_width * (n - plane) as f64;
        planes.push(wanted.clamp(lowest.min(highest), highest));
    }
    planes.push(length);
    planes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::{Face, RankGrid};
    use crate::parallel::run_on_threads;

    /// The imbalance of times on four slabs after some rounds of balancing, in a box of height 16 with 1600 particles
    /// of which those below a third cost three times as much.
    fn imbalance_of_a_bed_with_a_dense_bottom(by_time: bool) -> f64 {
        let bounds = Bounds::new(Vector3::new(4.0, 4.0, 16.0), [[Face::Wall; 2]; 3]);
        let heights: Vec<f64> = (0..1600).map(|i| (f64::from(i) + 0.5) / 100.0).collect();
        let found = run_on_threads(4, |ranks| {
            let mut decomposition = Decomposition::even(RankGrid([1, 1, 4]), &bounds);
            let mut load = RankLoad::UNKNOWN;
            for _ in 0..6 {
                let here =
                    |z: &f64| decomposition.owner_of(&Vector3::new(2.0, 2.0, *z)) == ranks.rank();
                let own: Vec<f64> = heights.iter().copied().filter(here).collect();
                let cost: u64 = own.iter().map(|z| if *z < 16.0 / 3.0 { 30 } else { 10 }).sum();
                load = RankLoad::measured(own.len(), Duration::from_micros(cost), ranks);
                let positions = own.iter().map(|&z| Vector3::new(2.0, 2.0, z));
                let used = if by_time { load } else { RankLoad::UNKNOWN };
                decomposition = used.balanced(&decomposition, positions, &bounds, 0.5, ranks);
            }
            load.imbalance
        });
        found[0]
    }

    #[test]
    fn expensive_particles_are_shared_among_more_ranks() {
        // Within a slab all particles count the same: the planes approach the height of a third in several rounds.
        let found = imbalance_of_a_bed_with_a_dense_bottom(true);
        assert!(found < 1.03, "{found}");
        // Negative control: equal counts are not equal work.
        assert!(imbalance_of_a_bed_with_a_dense_bottom(false) > 1.4);
    }

    #[test]
    fn without_measured_times_the_imbalance_is_that_of_particle_counts() {
        let of = |counts: [usize; 2], times: [u64; 2]| {
            run_on_threads(2, |ranks| {
                let time = Duration::from_micros(times[ranks.rank()]);
                RankLoad::measured(counts[ranks.rank()], time, ranks)
            })
        };
        assert!(
            of([300, 100], [0, 0]).iter().all(|load| load.imbalance == 1.5 && load.cost == 1.0)
        );
        assert!(of([0, 0], [0, 0]).iter().all(|load| load.imbalance == 1.0));
        // Costs outside the range are limited.
        let uneven = of([100, 100], [100, 9_900]);
        assert_eq!(uneven.iter().map(|load| load.cost).collect::<Vec<_>>(), [0.1, 1.98]);
        assert_eq!(uneven[0].imbalance, 1.98);
    }

    #[test]
    fn cut_planes_divide_the_particles_evenly() {
        let mut histogram = vec![0; 100];
        histogram[..40].fill(10); // all in the lowest 40 % of a box of length 10
        let planes = quantiles(&histogram, 4, 10.0, 0.5);
        let expected = [0.0, 1.0, 2.0, 3.0, 10.0];
        for (plane, expected) in planes.iter().zip(expected) {
            assert!((plane - expected).abs() < 1e-12, "{planes:?}");
        }
    }

    #[test]
    fn subdomains_are_never_narrower_than_the_least_width() {
        for histogram in [vec![0; 10], vec![100, 0, 0, 0], vec![0, 0, 0, 100]] {
            let planes = quantiles(&histogram, 3, 9.0, 2.5);
            let widths: Vec<f64> = planes.windows(2).map(|pair| pair[1] - pair[0]).collect();
            assert!(widths.iter().all(|&width| width >= 2.5 - 1e-12), "{planes:?}");
        }
    }
}
