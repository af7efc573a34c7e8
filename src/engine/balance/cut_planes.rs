//! Cut planes that give every rank about the same work.

use crate::domain::{Bounds, Decomposition};
use crate::parallel::Communicator;
use nalgebra::Vector3;
use std::time::Duration;

/// Number of bins, along each axis, of the histogram from which cut planes are chosen.
const BINS: usize = 1024;

/// Weight of a particle of mean cost in the histogram.
const MEAN_WEIGHT: f64 = 1024.0;

/// Range of a particle's cost, its pairs included, relative to the mean. Particles in flight cost a tenth of those at
/// rest on others; a ratio outside this range is treated as an error of the measured time.
const COST_RANGE: [f64; 2] = [0.1, 10.0];

/// How the box is cut.
#[derive(Clone, Copy, Debug)]
pub struct Cuts<'a> {
    /// The box.
    pub bounds: &'a Bounds,
    /// Its parts.
    pub decomposition: &'a Decomposition,
    /// Least width of a part; length.
    pub least_width: f64,
}

/// Number of particles or pairs of a rank, and the time of a step that it spends on them, waiting excluded.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RankWork {
    /// Number of particles or pairs.
    pub count: usize,
    /// Time.
    pub time: Duration,
}

/// Distribution of the work over the ranks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RankLoad {
    /// Maximum over mean of the ranks' times, or of their particle counts if no time is known; 1 if there are no
    /// particles.
    pub imbalance: f64,
    /// Time of this rank per particle, without its pairs, relative to the time of all ranks per particle, with its
    /// pairs.
    cost_of_particle: f64,
    /// Time of this rank per pair, relative to the time of all ranks per particle, with its pairs.
    cost_of_pair: f64,
}

impl RankLoad {
    /// The load before any time is known: all particles cost the same.
    pub const UNKNOWN: Self = Self::of_counts(f64::INFINITY);

    const fn of_counts(imbalance: f64) -> Self {
        Self { imbalance, cost_of_particle: 1.0, cost_of_pair: 0.0 }
    }

    /// The load from the work of this rank on particles and on their pairs. This call is collective.
    pub fn measured(on_particles: RankWork, on_pairs: RankWork, ranks: &dyn Communicator) -> Self {
        let nanoseconds = [on_particles, on_pairs].map(|work| work.time.as_nanos() as i64);
        let own = [on_particles.count as i64, nanoseconds.iter().sum()];
        let (mut sums, mut largest) = (own, own.map(|own| own as f64));
        ranks.sum_integers(&mut sums);
        ranks.maximum(&mut largest);
        let [all_particles, all_time] = sums.map(|sum| sum as f64);
        let imbalance = |kind: usize| match sums[kind] {
            0 => 1.0,
            sum => largest[kind] * ranks.size() as f64 / sum as f64,
        };
        if all_time == 0.0 || on_particles.count == 0 {
            return Self::of_counts(imbalance(if all_time == 0.0 { 0 } else { 1 }));
        }
        let [particles, time] = own.map(|own| own as f64);
        let cost = (time / particles) / (all_time / all_particles);
        let per_time = cost.clamp(COST_RANGE[0], COST_RANGE[1]) * particles / time.max(1.0);
        let [of_particles, of_pairs] = match on_pairs.count {
            0 => [time, 0.0],
            _ => nanoseconds.map(|time| time as f64),
        };
        Self {
            imbalance: imbalance(1),
            cost_of_particle: of_particles * per_time / particles,
            cost_of_pair: of_pairs * per_time / on_pairs.count.max(1) as f64,
        }
    }

    /// The rank grid with cut planes at the quantiles of the cost over the particles' coordinates. `particles` are those owned, positions wrapped, and how many pairs are counted with each.
    /// This call is collective.
    ///
    /// The planes determine which rank does which work, but never change a result.
    pub fn balanced(
        &self,
        Cuts { bounds, decomposition, least_width }: Cuts<'_>,
        particles: impl Iterator<Item = (Vector3<f64>, u32)> + Clone,
        ranks: &dyn Communicator,
    ) -> Decomposition {
        let cut_planes = std::array::from_fn(|axis| {
            let n = decomposition.grid().0[axis];
            if n == 1 {
                return decomposition.cut_planes(axis).to_vec();
            }
            let length = bounds.lengths()[axis];
            let mut histogram = vec![0_i64; BINS];
            for (position, pairs) in particles.clone() {
                let bin = (position[axis] / length * BINS as f64) as usize; // a negative number becomes bin 0
                histogram[bin.min(BINS - 1)] += self.weight(pairs);
            }
            ranks.sum_integers(&mut histogram);
            quantiles(&histogram, n, length, least_width)
        });
        decomposition.with_cut_planes(cut_planes)
    }

    /// Weight in the histogram of a particle with this number of pairs.
    fn weight(&self, pairs: u32) -> i64 {
        let cost = self.cost_of_particle + self.cost_of_pair * f64::from(pairs);
        (cost * MEAN_WEIGHT).round() as i64
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

    /// The imbalance of times on four slabs after some rounds of balancing, in a box of height 16 with 1600 particles,
    /// of which those in the lowest third have three pairs each.
    fn imbalance_of_a_bed_with_a_dense_bottom(known: Known, rounds: usize) -> f64 {
        let bounds = Bounds::new(Vector3::new(4.0, 4.0, 16.0), [[Face::Wall; 2]; 3]);
        let heights: Vec<f64> = (0..1600).map(|i| (f64::from(i) + 0.5) / 100.0).collect();
        let pairs_of = |z: f64| if z < 16.0 / 3.0 { 3 } else { 0 };
        let found = run_on_threads(4, |ranks| {
            let mut decomposition = Decomposition::even(RankGrid([1, 1, 4]), &bounds);
            let mut load = RankLoad::UNKNOWN;
            for _ in 0..=rounds {
                let here =
                    |z: &f64| decomposition.owner_of(&Vector3::new(2.0, 2.0, *z)) == ranks.rank();
                let own: Vec<f64> = heights.iter().copied().filter(here).collect();
                let pairs: usize = own.iter().map(|&z| pairs_of(z) as usize).sum();
                let work = [(own.len(), 1), (pairs, 2)].map(|(count, cost)| RankWork {
                    count,
                    time: Duration::from_micros(cost * count as u64),
                });
                let [on_particles, on_pairs] = work;
                let all = RankWork { time: on_particles.time + on_pairs.time, ..on_particles };
                load = match known {
                    Known::TimeOfPairs => RankLoad::measured(on_particles, on_pairs, ranks),
                    _ => RankLoad::measured(all, RankWork::default(), ranks),
                };
                let positions = own.iter().map(|&z| (Vector3::new(2.0, 2.0, z), pairs_of(z)));
                let used = if known == Known::Counts { RankLoad::UNKNOWN } else { load };
                let (bounds, decomposition_now) = (&bounds, &decomposition);
                let cuts = Cuts { bounds, decomposition: decomposition_now, least_width: 0.5 };
                decomposition = used.balanced(cuts, positions, ranks);
            }
            load.imbalance
        });
        found[0]
    }

    /// Data on the work.
    #[derive(Clone, Copy, PartialEq)]
    enum Known {
        Counts,
        Time,
        TimeOfPairs,
    }

    #[test]
    fn expensive_particles_are_shared_among_more_ranks() {
        // If pairs are known, the planes are right at once, to a bin in a thousand.
        let found = imbalance_of_a_bed_with_a_dense_bottom(Known::TimeOfPairs, 1);
        assert!(found < 1.02, "{found}");
        // If they are not, all particles of a slab count the same: the planes approach that place in several rounds.
        let found = [1, 5].map(|n| imbalance_of_a_bed_with_a_dense_bottom(Known::Time, n));
        assert!(found[0] > 1.1 && found[1] < 1.05, "{found:?}");
        // Negative control: equal counts are not equal work.
        assert!(imbalance_of_a_bed_with_a_dense_bottom(Known::Counts, 5) > 1.4);
    }

    #[test]
    fn without_measured_times_the_imbalance_is_that_of_particle_counts() {
        let of = |counts: [usize; 2], times: [u64; 2]| {
            run_on_threads(2, |ranks| {
                let time = Duration::from_micros(times[ranks.rank()]);
                let work = RankWork { count: counts[ranks.rank()], time };
                RankLoad::measured(work, RankWork::default(), ranks)
            })
        };
        let is_of_counts = |load: &RankLoad| load.imbalance == 1.5 && load.weight(7) == 1024;
        assert!(of([300, 100], [0, 0]).iter().all(is_of_counts));
        assert!(of([0, 0], [0, 0]).iter().all(|load| load.imbalance == 1.0));
        // Costs outside the range are limited.
        let uneven = of([100, 100], [100, 9_900]);
        let costs: Vec<f64> = uneven.iter().map(|load| load.cost_of_particle).collect();
        assert!((costs[0] - 0.1).abs() < 1e-12 && (costs[1] - 1.98).abs() < 1e-12, "{costs:?}");
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
