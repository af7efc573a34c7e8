//! Reproducible dot products: their bits do not depend on the order of their terms.
//!
//! Each product is split into a multiple of a coarse and a multiple of a fine quantum, and the multiples are added as
//! integers, which the compiler vectorises. The method is indexed summation with two bins \[Demmel2015\].
//!
//! * Demmel2015: J. Demmel, H. D. Nguyen, "Parallel reproducible summation", IEEE Trans. Comput. 64 (2015) 2060-2070.

use super::rows::rows;
use crate::grid::Field;
use crate::numbers::{Largest, vectorised};
use crate::parallel::Communicator;

/// Number of terms that are added as 64-bit integers, each below 2^51, before the sum is carried over to a wider
/// integer.
const TERMS_BETWEEN_CARRIES: usize = 1024;

/// Largest ratio of a term to the last value of a dot product before new quanta are chosen.
const HEADROOM: f64 = 4_294_967_296.0; // 2^32

/// The largest term that a sum may have.
const LARGEST_TERM: f64 = f64::MAX / 8.0;

/// Numbers in the owned cells of a rank, row by row.
pub(super) trait Values: Copy {
    /// The values of `length` cells from an index on, in double precision.
    fn row(self, start: usize, length: usize) -> impl Iterator<Item = f64>;
}

impl Values for &Field {
    #[inline(always)]
    fn row(self, start: usize, length: usize) -> impl Iterator<Item = f64> {
        self.values()[start..][..length].iter().copied()
    }
}

/// The two quanta of the terms of a sum: 2^-51 and 2^-103 times a bound of their magnitude.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TermQuanta {
    /// The bound, a power of two.
    limit: f64,
}

impl TermQuanta {
    /// Smallest bound: with a smaller one the fine quantum would underflow.
    const SMALLEST: f64 = 1.0e-270;

    fn spanning(largest: f64) -> Self {
        let mut limit = 1.0_f64;
        while limit < largest {
            limit *= 2.0;
        }
        while limit * 0.5 >= largest.max(Self::SMALLEST) {
            limit *= 0.5;
        }
        Self { limit }
    }

    /// Numbers that, added to a term, give a sum whose last bit represents one quantum: coarse, fine.
    #[inline(always)]
    fn shifts(self) -> [f64; 2] {
        [3.0 * self.limit, 3.0 * self.limit * 0.5_f64.powi(52)]
    }

    /// The coarse and the fine quantum.
    fn quanta(self) -> [f64; 2] {
        [self.limit * 0.5_f64.powi(51), self.limit * 0.5_f64.powi(103)]
    }
}

/// An exact sum of terms that are rounded to multiples of the fine quantum.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct FixedPointSum {
    multiples: [i128; 2],
    /// Number of terms beyond the bound or undefined (NaN). If it is not zero, the sum is meaningless.
    beyond: i64,
}

impl FixedPointSum {
    const INTEGERS: usize = 5;
    const SPLIT: i128 = 1 << 48;

    /// Adds a_i b_i for some i, at most as many as can be added before the sum is carried over.
    #[inline(always)]
    fn add_chunk(&mut self, quanta: TermQuanta, a: &[f64], b: impl Iterator<Item = f64>) {
        let [coarse, fine] = quanta.shifts();
        let (mut high, mut low, mut beyond) = (0_u64, 0_u64, 0_u64);
        for (a, b) in a.iter().zip(b) {
            let term = a * b;
            let shifted = term + coarse;
            let rest = term - (shifted - coarse);
            high = high.wrapping_add(shifted.to_bits());
            low = low.wrapping_add((rest + fine).to_bits());
            beyond += u64::from(term.abs() > quanta.limit || term.is_nan());
        }
        let multiples = |sum: u64, shift: f64| {
            i128::from(sum.wrapping_sub(shift.to_bits().wrapping_mul(a.len() as u64)) as i64)
        };
        self.multiples[0] += multiples(high, coarse);
        self.multiples[1] += multiples(low, fine);
        self.beyond += beyond as i64;
    }

    fn to_integers(self) -> [i64; Self::INTEGERS] {
        let [high, low] = self.multiples;
        let split =
            |sum: i128| [sum.div_euclid(Self::SPLIT) as i64, sum.rem_euclid(Self::SPLIT) as i64];
        let ([a, b], [c, d]) = (split(high), split(low));
        [a, b, c, d, self.beyond]
    }

    fn from_integers(integers: [i64; Self::INTEGERS]) -> Self {
        let [a, b, c, d, beyond] = integers;
        let join = |high: i64, low: i64| i128::from(high) * Self::SPLIT + i128::from(low);
        Self { multiples: [join(a, b), join(c, d)], beyond }
    }

    /// The value, unless a term exceeded the bound.
    fn value(self, quanta: TermQuanta) -> Option<f64> {
        let [coarse, fine] = quanta.quanta();
        let [high, low] = self.multiples.map(|sum| sum as f64);
        (self.beyond == 0).then_some(high * coarse + low * fine)
    }
}

/// A dot product that is computed repeatedly; its quanta follow from its last value.
///
/// Each of N terms is rounded by at most 2^-104 of the bound, which is at most 2^33 times the last value. As long as
/// the value keeps its magnitude, the relative error is below N 2^-71 and no sum needs to be repeated. The result does
/// not depend on the order of the cells or the number of ranks.
#[derive(Clone, Copy, Debug)]
pub(super) struct DotProduct {
    quanta: TermQuanta,
}

impl Default for DotProduct {
    /// A dot product of unknown magnitude: the first evaluation chooses its quanta from the largest term.
    fn default() -> Self {
        Self { quanta: TermQuanta { limit: 0.0 } }
    }
}

impl DotProduct {
    /// A dot product whose terms are at most this large.
    pub(super) fn of_terms_up_to(largest: f64) -> Self {
        Self { quanta: TermQuanta::spanning(largest.min(LARGEST_TERM)) }
    }

    fn has_quanta(self) -> bool {
        self.quanta.limit > 0.0
    }

    /// Starts a sum, to which rows are added with [`RunningDot::add_row`].
    pub(super) fn begin(self) -> RunningDot {
        RunningDot { quanta: self.quanta, sum: FixedPointSum::default() }
    }

    /// The sum over all ranks. If there were no quanta, or terms exceeded the bound, it is computed from `a` and `b`.
    /// Undefined (NaN) if a term is infinite or undefined. This call is collective.
    pub(super) fn finish(
        &mut self,
        running: RunningDot,
        (a, b): (&Field, impl Values),
        ranks: &dyn Communicator,
    ) -> f64 {
        let value = self.has_quanta().then(|| total(running, ranks)).flatten();
        let Some(value) = value.or_else(|| self.with_new_quanta(a, b, ranks)) else {
            return f64::NAN;
        };
        if value != 0.0 {
            *self = Self::of_terms_up_to(HEADROOM * value.abs());
        }
        value
    }

    /// The dot product of the owned values of two fields with the same order in memory. This call is collective.
    pub(super) fn of(&mut self, a: &Field, b: impl Values, ranks: &dyn Communicator) -> f64 {
        let mut running = self.begin();
        if self.has_quanta() {
            running = add_rows(running, a, b);
        }
        self.finish(running, (a, b), ranks)
    }

    /// Chooses the quanta from the largest term. `None` if this term is infinite or undefined.
    fn with_new_quanta(
        &mut self,
        a: &Field,
        b: impl Values,
        ranks: &dyn Communicator,
    ) -> Option<f64> {
        let mut largest = [largest_term(a, b)];
        ranks.maximum(&mut largest);
        if largest[0] > LARGEST_TERM {
            return None;
        }
        *self = Self::of_terms_up_to(largest[0]);
        total(add_rows(self.begin(), a, b), ranks)
    }
}

vectorised!(
    /// The largest |a_i b_i| of this rank; infinity if one is infinite or undefined (NaN).
    pub(super) fn largest_term(a: &Field, b: impl Values) -> f64 {
        let length = a.row_length();
        let mut largest = Largest::default();
        for [start] in rows([a]) {
            let row = &a.values()[start..][..length];
            for (a, b) in row.iter().zip(b.row(start, length)) {
                largest.add((a * b).abs());
            }
        }
        largest.value()
    }
);

/// The sum over some rows of one rank.
#[derive(Clone, Copy, Debug)]
pub(super) struct RunningDot {
    quanta: TermQuanta,
    sum: FixedPointSum,
}

impl RunningDot {
    /// Adds a_i b_i for all cells of the row that begins with this index, in a and b alike.
    #[inline(always)]
    pub(super) fn add_row(&mut self, a: &Field, b: impl Values, start: usize) {
        let row = &a.values()[start..][..a.row_length()];
        for (number, a) in row.chunks(TERMS_BETWEEN_CARRIES).enumerate() {
            let b = b.row(start + number * TERMS_BETWEEN_CARRIES, a.len());
            self.sum.add_chunk(self.quanta, a, b);
        }
    }
}

fn total(running: RunningDot, ranks: &dyn Communicator) -> Option<f64> {
    let mut integers = running.sum.to_integers();
    ranks.sum_integers(&mut integers);
    FixedPointSum::from_integers(integers).value(running.quanta)
}

vectorised!(
    fn add_rows(running: RunningDot, a: &Field, b: impl Values) -> RunningDot {
        let mut running = running;
        for [start] in rows([a]) {
            running.add_row(a, b, start);
        }
        running
    }
);
