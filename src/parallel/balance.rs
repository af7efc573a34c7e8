//! Cut planes that give every rank about the same number of particles.

use super::Communicator;
use crate::domain::{Bounds, Decomposition};
use nalgebra::Vector3;

/// Bins of the histogram that cut planes are chosen from, per axis.
const BINS: usize = 1024;

/// Largest over mean number of particles per rank; 1 without particles. Collective.
pub fn imbalance(owned: usize, ranks: &dyn Communicator) -> f64 {
    let mut largest = [owned as f64];
    ranks.maximum(&mut largest);
    let total = ranks.total(owned);
    if total == 0 { 1.0 } else { largest[0] * ranks.size() as f64 / total as f64 }
}

/// The same rank grid with cut planes through the quantiles of the particles' coordinates, blocks being at
/// least `least_width` wide. Collective; positions are those of owned particles, wrapped.
///
/// The planes change who works on what, never a result.
pub fn balanced(
    cut: &Decomposition,
    positions: impl Iterator<Item = Vector3<f64>> + Clone,
    bounds: &Bounds,
    least_width: f64,
    ranks: &dyn Communicator,
) -> Decomposition {
    let cuts = std::array::from_fn(|axis| {
        let n = cut.grid().0[axis];
        if n == 1 {
            return cut.cuts(axis).to_vec();
        }
        let length = bounds.lengths()[axis];
        let mut histogram = vec![0_i64; BINS];
        for position in positions.clone() {
            let bin = (position[axis] / length * BINS as f64) as usize; // negative: bin 0
            histogram[bin.min(BINS - 1)] += 1;
        }
        ranks.sum_integers(&mut histogram);
        quantiles(&histogram, n, length, least_width)
    });
    cut.with_cuts(cuts)
}

/// n + 1 planes from 0 to `length` that divide the histogram evenly, at least `least_width` apart.
fn quantiles(histogram: &[i64], n: usize, length: f64, least_width: f64) -> Vec<f64> {
    let total: i64 = histogram.iter().sum();
    let bin_width = length / histogram.len() as f64;
    let mut planes = vec![0.0];
    let mut bin = 0;
    let mut below = 0; // particles in the bins before `bin`
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

    #[test]
    fn planes_divide_the_particles_evenly() {
        let mut histogram = vec![0; 100];
        histogram[..40].fill(10); // all in the lowest 40 % of a box of length 10
        let planes = quantiles(&histogram, 4, 10.0, 0.5);
        let expected = [0.0, 1.0, 2.0, 3.0, 10.0];
        for (plane, expected) in planes.iter().zip(expected) {
            assert!((plane - expected).abs() < 1e-12, "{planes:?}");
        }
    }

    #[test]
    fn blocks_stay_wide_enough_whatever_the_particles_do() {
        for histogram in [vec![0; 10], vec![100, 0, 0, 0], vec![0, 0, 0, 100]] {
            let planes = quantiles(&histogram, 3, 9.0, 2.5);
            let widths: Vec<f64> = planes.windows(2).map(|pair| pair[1] - pair[0]).collect();
            assert!(widths.iter().all(|&width| width >= 2.5 - 1e-12), "{planes:?}");
        }
    }
}
