//! Sums on cells as integers: the same bits for any distribution of the addends over ranks, in little memory.
//!
//! All addends of one quantity are rounded to multiples of one quantum, which the largest of them fixes: 2^-51 of it
//! at most. A sum of n addends is wrong by less than n 2^-52 of the largest.

use super::rendezvous::send_to_rendezvous;
use crate::numbers::Quantum;
use crate::parallel::Communicator;
use bytemuck::{Pod, Zeroable};
use std::collections::BTreeMap;

/// Addends no larger than this count as zero: the spacing of their quantum would not be a normal number.
const SMALLEST: f64 = 1.0e-280;

/// Sums of N quantities on cells.
#[derive(Clone, Debug)]
pub(crate) struct FixedPointSums<const N: usize> {
    /// None if all addends of a quantity are zero.
    quanta: [Option<Quantum>; N],
    undefined: [bool; N],
    cells: BTreeMap<u64, [i128; N]>,
}

/// One sum of one cell.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Term {
    cell: u64,
    quantity: u64,
    low: u64,
    high: i64,
}

impl<const N: usize> FixedPointSums<N> {
    /// Empty sums of addends whose magnitudes on this rank are up to `largest`. Collective.
    pub(crate) fn new(mut largest: [f64; N], ranks: &dyn Communicator) -> Self {
        ranks.maximum(&mut largest);
        let undefined = largest.map(|largest| !largest.is_finite());
        let usable = |largest: f64| largest.is_finite() && largest > SMALLEST;
        let quanta = largest.map(|x| usable(x).then(|| Quantum::spanning(x)));
        Self { quanta, undefined, cells: BTreeMap::new() }
    }

    /// The integers that stand for these numbers.
    pub(crate) fn counts_of(&self, values: &[f64; N]) -> [i64; N] {
        std::array::from_fn(|k| {
            self.quanta[k].map_or(0, |quantum| quantum.count(quantum.round(values[k])))
        })
    }

    /// Adds to the sums of a cell.
    pub(crate) fn add(&mut self, cell: u64, counts: &[i64; N]) {
        let sums = self.cells.entry(cell).or_insert([0; N]);
        sums.iter_mut().zip(counts).for_each(|(sum, &count)| *sum += i128::from(count));
    }

    /// The sums over all ranks, each cell on its rendezvous rank. Collective.
    pub(crate) fn totals(self, ranks: &dyn Communicator) -> BTreeMap<u64, [f64; N]> {
        let mut terms = Vec::new();
        for (&cell, sums) in &self.cells {
            for (quantity, &sum) in sums.iter().enumerate() {
                let (low, high) = (sum as u64, (sum >> 64) as i64);
                // A cell without a number but with addends is known by its first quantity.
                if sum != 0 || quantity == 0 {
                    terms.push(Term { cell, quantity: quantity as u64, low, high });
                }
            }
        }
        let mut sums: BTreeMap<u64, [i128; N]> = BTreeMap::new();
        for Term { cell, quantity, low, high } in send_to_rendezvous(terms, |term| term.cell, ranks)
        {
            let sum = (i128::from(high) << 64) + i128::from(low);
            let of_cell = sums.entry(cell).or_insert([0; N]);
            if let Some(total) = of_cell.get_mut(quantity as usize) {
                *total += sum;
            }
        }
        sums.into_iter().map(|(cell, sums)| (cell, self.values_of(&sums))).collect()
    }

    fn values_of(&self, sums: &[i128; N]) -> [f64; N] {
        std::array::from_fn(|k| match self.quanta[k] {
            _ if self.undefined[k] => f64::NAN,
            Some(quantum) => sums[k] as f64 * quantum.spacing(),
            None => 0.0,
        })
    }
}

/// The largest magnitude of each quantity; infinite if a number is undefined.
pub(crate) fn largest<const N: usize>(values: impl IntoIterator<Item = [f64; N]>) -> [f64; N] {
    let mut largest = [0.0_f64; N];
    for value in values {
        for (largest, x) in largest.iter_mut().zip(value) {
            *largest = largest.max(if x.is_finite() { x.abs() } else { f64::INFINITY });
        }
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::run_on_threads;

    #[test]
    fn sums_of_both_signs_meet_with_the_same_bits() {
        let values = |k: u64| [((k * 37 % 101) as f64 - 50.3) * 1e-7, 0.0, k as f64];
        let on = |n: usize| {
            let made = run_on_threads(n, |ranks| {
                let here = || (0..1000_u64).filter(|k| (k * k % 7) as usize % n == ranks.rank());
                let mut sums = FixedPointSums::new(largest(here().map(values)), ranks);
                for k in here() {
                    let counts = sums.counts_of(&values(k));
                    sums.add(k % 13, &counts);
                }
                sums.totals(ranks)
            });
            made.into_iter().flatten().collect::<BTreeMap<_, _>>()
        };
        let expected = on(1);
        for (&cell, sums) in &expected {
            let plain: f64 = (0..1000).filter(|k| k % 13 == cell).map(|k| values(k)[0]).sum();
            assert!((sums[0] - plain).abs() < 77.0 * 5e-6 * 2.0_f64.powi(-51));
            assert_eq!(sums[1], 0.0);
            let whole: u64 = (0..1000).filter(|k| k % 13 == cell).sum();
            assert!((sums[2] - whole as f64).abs() < 1e-9);
        }
        (2..=4).for_each(|n| assert_eq!(on(n), expected));
    }

    #[test]
    fn undefined_addends_make_the_quantity_undefined() {
        run_on_threads(2, |ranks| {
            let value = [[f64::NAN, 1.0], [2.0, 1.0]][ranks.rank()];
            let mut sums = FixedPointSums::new(largest([value]), ranks);
            let counts = sums.counts_of(&value);
            sums.add(3, &counts);
            for sums in sums.totals(ranks).values() {
                assert!(sums[0].is_nan());
                assert_eq!(sums[1], 2.0);
            }
        });
    }
}
