//! Sums over particles of all ranks, in total and by a key, with the same bits for any distribution of the particles
//! over the ranks: every sum is exact and rounded once.

use super::rendezvous::send_to_rendezvous;
use crate::numbers::{ExactSum, QuickSum};
use crate::parallel::Communicator;
use bytemuck::{Pod, Zeroable};

/// Exact sums over all ranks of the numbers given by this rank's items. Collective.
pub fn totals<const N: usize>(
    items: impl IntoIterator<Item = [f64; N]>,
    ranks: &dyn Communicator,
) -> [f64; N] {
    let mut sums = [(); N].map(|()| QuickSum::default());
    for item in items {
        sums.iter_mut().zip(item).for_each(|(sum, value)| sum.add(value));
    }
    let mut integers: Vec<i64> =
        sums.into_iter().flat_map(|sum| sum.exact().to_integers()).collect();
    ranks.sum_integers(&mut integers);
    let mut totals = integers.chunks(ExactSum::INTEGERS).map(ExactSum::from_integers);
    [(); N].map(|()| totals.next().map_or(0.0, |sum| sum.value()))
}

/// Numbers of one key: addends, or their sums.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keyed<const N: usize> {
    /// What the numbers belong to.
    pub key: u64,
    /// The numbers.
    pub values: [f64; N],
}

/// One integer of an exact sum. Most integers are zero and are not sent.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Term {
    key: u64,
    /// Number of the quantity times the integers of a sum, plus the number of the integer.
    place: u64,
    integer: i64,
}

/// The sums of the numbers of each key, on the rendezvous rank of the key, by ascending key. Collective.
pub fn totals_by_key<const N: usize>(
    mut items: Vec<Keyed<N>>,
    ranks: &dyn Communicator,
) -> Vec<Keyed<N>> {
    items.sort_unstable_by_key(|item| item.key);
    let mut terms = Vec::new();
    for group in items.chunk_by(|a, b| a.key == b.key) {
        terms_of(group, &mut terms);
    }
    drop(items);
    let mut terms = send_to_rendezvous(terms, |term| term.key, ranks);
    terms.sort_unstable_by_key(|term| (term.key, term.place));
    terms.chunk_by(|a, b| a.key == b.key).map(sum_of_terms).collect()
}

/// The non-zero integers of the sums of one key's numbers. Positive and negative numbers are summed separately, since
/// an exact sum below zero has non-zero integers in all higher places. Numbers that are not finite are added to the
/// positive ones.
fn terms_of<const N: usize>(group: &[Keyed<N>], terms: &mut Vec<Term>) {
    let first = terms.len();
    for quantity in 0..N {
        for sign in [1, -1] {
            let mut sum = ExactSum::default();
            let magnitudes = group.iter().map(|item| f64::from(sign) * item.values[quantity]);
            let counts = |x: &f64| if x.is_finite() { *x > 0.0 } else { sign == 1 };
            magnitudes.filter(counts).for_each(|magnitude| sum.add(magnitude));
            let integers = sum.to_integers().into_iter().enumerate();
            terms.extend(integers.filter(|&(_, integer)| integer != 0).map(|(place, integer)| {
                let place = (quantity * ExactSum::INTEGERS + place) as u64;
                Term { key: group[0].key, place, integer: i64::from(sign) * integer }
            }));
        }
    }
    if terms.len() == first {
        // All numbers are zero: the key must be known nevertheless.
        terms.push(Term { key: group[0].key, place: 0, integer: 0 });
    }
}

fn sum_of_terms<const N: usize>(terms: &[Term]) -> Keyed<N> {
    let mut integers = vec![0; N * ExactSum::INTEGERS];
    for term in terms {
        if let Some(integer) = integers.get_mut(term.place as usize) {
            *integer += term.integer;
        }
    }
    let mut sums = integers.chunks(ExactSum::INTEGERS).map(ExactSum::from_integers);
    Keyed { key: terms[0].key, values: [(); N].map(|()| sums.next().map_or(0.0, |s| s.value())) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::{normal, random_of};
    use crate::parallel::run_on_threads;

    /// 2000 numbers of 16 orders of magnitude and both signs, 37 keys.
    fn items() -> Vec<Keyed<2>> {
        let mut generator = random_of(1, 0, "exact sums");
        let mut draw = || {
            let magnitude = libm::exp(8.0 * normal(&mut generator));
            magnitude * normal(&mut generator)
        };
        (0..2000).map(|k| Keyed { key: k * k % 37, values: [draw(), draw() - 2.0] }).collect()
    }

    fn on_ranks(n: usize, scatter: u64) -> Vec<Keyed<2>> {
        let mut all: Vec<_> = run_on_threads(n, |ranks| {
            let all = items().into_iter().enumerate();
            let here = |(place, _): &(usize, _)| {
                (*place as u64 * scatter / 7 % n as u64) as usize == ranks.rank()
            };
            totals_by_key(all.filter(here).map(|(_, item)| item).collect(), ranks)
        })
        .into_iter()
        .flatten()
        .collect();
        all.sort_by_key(|item| item.key);
        all
    }

    #[test]
    fn sums_by_key_have_the_same_bits_on_any_ranks() {
        let expected = on_ranks(1, 1);
        for n in 1..=4 {
            for scatter in [3, 11] {
                let bits = |all: &[Keyed<2>]| -> Vec<_> {
                    all.iter().map(|item| (item.key, item.values.map(f64::to_bits))).collect()
                };
                assert_eq!(bits(&on_ranks(n, scatter)), bits(&expected));
            }
        }
        let items = items();
        for total in expected {
            let of_key = || items.iter().filter(|item| item.key == total.key);
            let mut exact = ExactSum::default();
            of_key().for_each(|item| exact.add(item.values[1]));
            assert_eq!(exact.value(), total.values[1]);
        }
    }

    #[test]
    fn ordinary_sums_depend_on_the_order() {
        // Control: otherwise the test above would show nothing.
        let items = items();
        let forwards: f64 = items.iter().map(|item| item.values[0]).sum();
        let backwards: f64 = items.iter().rev().map(|item| item.values[0]).sum();
        assert_ne!(forwards.to_bits(), backwards.to_bits());
    }

    #[test]
    fn keys_without_numbers_and_undefined_numbers_are_kept() {
        run_on_threads(2, |ranks| {
            let values = [[0.0], [f64::NAN]][ranks.rank()];
            let items = [(5, [0.0]), (6, values), (7, [f64::INFINITY]), (7, [-f64::INFINITY])];
            let items = items.map(|(key, values)| Keyed { key, values }).to_vec();
            for total in totals_by_key(items, ranks) {
                assert_eq!(total.values[0].is_nan(), total.key >= 6);
            }
            assert_eq!(totals([[1.5]], ranks), [3.0]);
        });
    }
}
