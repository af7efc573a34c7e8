//! Sums by key as integers: the same bits for any distribution of the addends over ranks, in little memory.
//!
//! All addends of one quantity are rounded to multiples of one quantum, which the largest of them determines: it is at
//! most 2^-51 of the largest. The error of a sum of n addends is less than n 2^-52 of the largest. Addends are counted
//! in 64 bits, and carried into 128 bits before these could overflow: there is room for 2^76 addends.

use super::exact_sums::Keyed;
use super::rendezvous::send_keyed;
use crate::numbers::{Quantum, sorted_by_key};
use crate::parallel::Communicator;

/// Addends up to this magnitude count as zero: the spacing of their quantum would not be a normal number.
const SMALLEST: f64 = 1.0e-280;

/// The quanta of N quantities.
#[derive(Clone, Copy, Debug)]
pub struct Quanta<const N: usize> {
    /// Spacing; 0 if all addends of a quantity are zero.
    spacing: [f64; N],
    /// 1.5 * 2^52 quanta: when this is added to a number, the bits of the sum count quanta.
    shift: [f64; N],
    undefined: [bool; N],
}

impl<const N: usize> Quanta<N> {
    /// Quanta for addends whose magnitudes on this rank are up to `largest`. Collective.
    pub fn new(mut largest: [f64; N], ranks: &dyn Communicator) -> Self {
        ranks.maximum(&mut largest);
        Self::spanning(largest)
    }

    /// Quanta for addends whose magnitudes on all ranks are up to `largest`.
    pub fn spanning(largest: [f64; N]) -> Self {
        let quantum = largest.map(|largest| {
            let is_usable = largest.is_finite() && largest > SMALLEST;
            is_usable.then(|| Quantum::spanning(largest))
        });
        let of_one = Quantum::spanning(1.0).shift();
        Self {
            spacing: quantum.map(|quantum| quantum.map_or(0.0, Quantum::spacing)),
            shift: quantum.map(|quantum| quantum.map_or(of_one, Quantum::shift)),
            undefined: largest.map(|largest| !largest.is_finite()),
        }
    }

    /// The integers that represent these numbers: x + 1.5 * 2^52 quanta is rounded to quanta, and lies between 2^52 and
    /// 2^53 of them, where the last bit of a double is one quantum.
    #[inline(always)]
    pub fn counts_of(&self, values: &[f64; N]) -> [i64; N] {
        std::array::from_fn(|k| {
            let counted = (values[k] + self.shift[k]).to_bits();
            counted.wrapping_sub(self.shift[k].to_bits()) as i64
        })
    }

    pub(crate) fn values_of(&self, sums: &[i128; N]) -> [f64; N] {
        std::array::from_fn(|k| {
            if self.undefined[k] { f64::NAN } else { sums[k] as f64 * self.spacing[k] }
        })
    }
}

/// Sums of N quantities at many places, in quanta.
#[derive(Clone, Debug)]
pub struct FixedPointSums<const N: usize> {
    recent: Vec<[i64; N]>,
    /// Number of addends at each place since its last carry.
    additions: Vec<u32>,
    carried: Vec<[i128; N]>,
}

/// Counts are at most 2^51, so this number of them fits into 64 bits.
const ADDITIONS_BETWEEN_CARRIES: u32 = 1 << 11;

impl<const N: usize> FixedPointSums<N> {
    /// Sums of zero at this number of places.
    pub fn zero(places: usize) -> Self {
        Self {
            recent: vec![[0; N]; places],
            additions: vec![0; places],
            carried: vec![[0; N]; places],
        }
    }

    /// Number of places.
    #[inline(always)]
    pub fn places(&self) -> usize {
        self.recent.len()
    }

    /// Adds a place with sums of zero.
    pub fn grow(&mut self) {
        self.recent.push([0; N]);
        self.additions.push(0);
        self.carried.push([0; N]);
    }

    /// Adds counts to the sums of a place.
    #[inline(always)]
    pub fn add(&mut self, place: usize, counts: &[i64; N]) {
        // The counts of an undefined number have no meaning, and may be of any size.
        let recent = &mut self.recent[place];
        recent.iter_mut().zip(counts).for_each(|(sum, &count)| *sum = sum.wrapping_add(count));
        self.additions[place] += 1;
        if self.additions[place] == ADDITIONS_BETWEEN_CARRIES {
            self.carry(place);
        }
    }

    #[cold]
    fn carry(&mut self, place: usize) {
        self.carried[place] = self.total(place);
        self.recent[place] = [0; N];
        self.additions[place] = 0;
    }

    fn total(&self, place: usize) -> [i128; N] {
        let (carried, recent) = (&self.carried[place], &self.recent[place]);
        std::array::from_fn(|k| carried[k] + i128::from(recent[k]))
    }
}

/// The keys that have occurred, each with a place of its own: keys below a given number, such as cells.
#[derive(Clone, Debug)]
pub struct Slots {
    keys: Vec<u64>,
    /// For each key, 1 + its place, or 0 if it has none. Memory of keys far from all that have
    /// occurred is never touched.
    of_key: Vec<u32>,
}

impl Slots {
    /// Room for the keys from 0 up to, but not including, `keys`.
    pub fn new(keys: usize) -> Self {
        Self { keys: Vec::new(), of_key: vec![0; keys] }
    }

    /// The place of a key.
    #[inline(always)]
    pub fn of(&mut self, key: u64) -> usize {
        let slot = &mut self.of_key[key as usize];
        if *slot == 0 {
            self.keys.push(key);
            *slot = self.keys.len() as u32;
        }
        *slot as usize - 1
    }

    /// The keys by their places.
    pub fn keys(&self) -> &[u64] {
        &self.keys
    }
}

/// The sums of each key over all ranks, on the rendezvous rank of the key, by ascending key. Collective.
pub fn sums_by_key<const N: usize>(
    keys: &[u64],
    sums: &FixedPointSums<N>,
    quanta: &Quanta<N>,
    ranks: &dyn Communicator,
) -> Vec<Keyed<N>> {
    let halves = |sum: i128| [sum as u64, (sum >> 64) as u64];
    let records = keys.iter().enumerate();
    let records = records.map(|(place, &key)| (key, sums.total(place).map(halves)));
    let records = sorted_by_key(send_keyed(records, ranks), |record| record.0);
    let of_key = |group: &[(u64, [[u64; 2]; N])]| {
        let mut total = [0_i128; N];
        for (_, halves) in group {
            for (total, &[low, high]) in total.iter_mut().zip(halves) {
                *total += (i128::from(high as i64) << 64) + i128::from(low);
            }
        }
        Keyed { key: group[0].0, values: quanta.values_of(&total) }
    };
    records.chunk_by(|a, b| a.0 == b.0).map(of_key).collect()
}

/// The largest magnitude of each quantity; infinite if a number is undefined.
#[inline(always)]
pub fn largest<const N: usize>(values: impl IntoIterator<Item = [f64; N]>) -> [f64; N] {
    // The bits of magnitudes are in the order of the numbers, with undefined ones last.
    let mut largest = [0_u64; N];
    for value in values {
        for (largest, x) in largest.iter_mut().zip(value) {
            *largest = x.abs().to_bits().max(*largest);
        }
    }
    largest.map(
        |bits| if f64::from_bits(bits).is_nan() { f64::INFINITY } else { f64::from_bits(bits) },
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::run_on_threads;
    use std::collections::BTreeMap;

    fn sums_of<const N: usize>(
        addends: impl Iterator<Item = (u64, [f64; N])> + Clone,
        ranks: &dyn Communicator,
    ) -> Vec<(u64, [f64; N])> {
        let quanta = Quanta::new(largest(addends.clone().map(|(_, values)| values)), ranks);
        let mut slots = Slots::new(20);
        let mut sums = FixedPointSums::zero(20);
        for (key, values) in addends {
            sums.add(slots.of(key), &quanta.counts_of(&values));
        }
        let found = sums_by_key(slots.keys(), &sums, &quanta, ranks);
        found.into_iter().map(|sums| (sums.key, sums.values)).collect()
    }

    #[test]
    fn sums_of_both_signs_meet_with_the_same_bits() {
        let values = |k: u64| [((k * 37 % 101) as f64 - 50.3) * 1e-7, 0.0, k as f64];
        let on = |n: usize| {
            let made = run_on_threads(n, |ranks| {
                let here = || (0..1000_u64).filter(|k| (k * k % 7) as usize % n == ranks.rank());
                sums_of(here().map(|k| (k % 13, values(k))), ranks)
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
            for (_, sums) in sums_of([(3, value)].into_iter(), ranks) {
                assert!(sums[0].is_nan());
                assert_eq!(sums[1], 2.0);
            }
        });
    }

    #[test]
    fn many_addends_are_carried() {
        // Both at the limit of 2^51 quanta, 5000 times: above 64 bits.
        run_on_threads(1, |ranks| {
            let addends = (0..10_000).map(|k| (7, [1.0, if k % 3 == 0 { 1.0 } else { -1.0 }]));
            assert_eq!(sums_of(addends, ranks), [(7, [10_000.0, -3_332.0])]);
        });
    }
}
