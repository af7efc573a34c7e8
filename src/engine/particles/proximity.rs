//! Tests of whether particles are near each other, four pairs at a time.

use super::Body;
use crate::numbers::F64x4;

/// The branch vector, from the centre of one body to that of another, and the sum of their radii.
#[inline(always)]
pub(super) fn branch_vector<Q: F64x4>(one: &Body, other: &Body) -> Q {
    let but_the_last = Q::load(&[1.0, 1.0, 1.0, -1.0]);
    Q::load(&other.vectors()[0]).minus(Q::load(&one.vectors()[0]).times(but_the_last))
}

/// One to four pairs, with their distances and sizes.
pub(super) struct FourPairs<Q> {
    /// Squares of the distances of the centres.
    squared: Q,
    /// Sums of the radii.
    radii: Q,
    /// A bit for each pair.
    used: u32,
}

impl<Q: F64x4> FourPairs<Q> {
    /// The first `count` of the pairs with these branch vectors.
    #[inline(always)]
    pub(super) fn of(branch_vectors: [Q; 4], count: usize) -> Self {
        let [x, y, z, radii] = Q::transposed(branch_vectors);
        let squared = x.times(x).plus(y.times(y)).plus(z.times(z));
        Self { squared, radii, used: (1 << count) - 1 }
    }

    /// Pairs of a body with one to four others.
    #[inline(always)]
    pub(super) fn of_bodies(body: &Body, others: &[Body]) -> Self {
        let mut branch_vectors = [Q::splat(0.0); 4];
        for (to_other, other) in branch_vectors.iter_mut().zip(four_of(others)) {
            *to_other = branch_vector(body, other);
        }
        Self::of(branch_vectors, others.len())
    }

    /// Pairs of a body with one to four of the bodies.
    #[inline(always)]
    pub(super) fn of_partners(body: &Body, partners: &[u32], bodies: &[Body]) -> Self {
        let mut branch_vectors = [Q::splat(0.0); 4];
        for (to_partner, &partner) in branch_vectors.iter_mut().zip(four_of(partners)) {
            *to_partner = branch_vector(body, &bodies[partner as usize]);
        }
        Self::of(branch_vectors, partners.len())
    }

    /// Bit k is set if the surfaces of pair k are closer than `separation`.
    #[inline(always)]
    pub(super) fn closer_than(&self, separation: Q) -> u32 {
        let distance = self.radii.plus(separation);
        self.squared.below(distance.times(distance)) & self.used
    }
}

/// One to four items as four: the last one is repeated if there are fewer, since loops of a known length stay in
/// registers.
#[inline(always)]
pub(crate) fn four_of<T>(items: &[T]) -> [&T; 4] {
    match items.first_chunk::<4>() {
        Some(four) => four.each_ref(),
        None => std::array::from_fn(|k| &items[k.min(items.len() - 1)]),
    }
}

/// Whether the surfaces of two bodies are closer than `separation`.
#[inline(always)]
pub(super) fn is_close([one, other]: [&Body; 2], separation: f64) -> bool {
    let distance = one.radius + other.radius + separation;
    (other.position - one.position).norm_squared() < distance * distance
}

/// The numbers of the bits that are set, lowest first.
pub(super) struct SetBits(pub(super) u32);

impl Iterator for SetBits {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let bit = self.0.trailing_zeros() as usize;
        (self.0 != 0).then(|| {
            self.0 &= self.0 - 1;
            bit
        })
    }
}

/// The numbers of the bits that are set in 0 to 15, lowest first, then zeros, and the number of set bits.
static SET_BITS: [([u32; 4], usize); 16] = {
    let mut table = [([0; 4], 0); 16];
    let mut bits = 0;
    while bits < 16 {
        let mut bit = 0;
        while bit < 4 {
            if bits >> bit & 1 == 1 {
                table[bits].0[table[bits].1] = bit;
                table[bits].1 += 1;
            }
            bit += 1;
        }
        bits += 1;
    }
    table
};

/// Adds the item of each bit that is set in the lowest four, lowest first. Four items are always written at once, since
/// the processor cannot predict the end of a loop over so few items.
#[inline(always)]
pub(crate) fn push_set_bits<T: Copy>(items: &mut Vec<T>, bits: u32, item: impl Fn(u32) -> T) {
    let (numbers, count) = SET_BITS[bits as usize & 15];
    let end = items.len() + count;
    items.extend_from_slice(&numbers.map(item));
    items.truncate(end);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::{random_of, uniform, vectorised};
    use nalgebra::Vector3;

    vectorised!(
        fn near_the_first<Q: F64x4>(all_bodies: &[Body]) -> Vec<usize> {
            let mut found = Vec::new();
            let all: Vec<u32> = (0..all_bodies.len() as u32).collect();
            for (four, partners) in all.chunks(4).enumerate() {
                let pairs = FourPairs::of_partners(&all_bodies[0], partners, all_bodies);
                let close = pairs.closer_than(Q::splat(0.2));
                let bodies = &all_bodies[4 * four..][..partners.len()];
                let pairs = FourPairs::of_bodies(&all_bodies[0], bodies);
                assert_eq!(pairs.closer_than(Q::splat(0.2)), close);
                push_set_bits(&mut found, close, |bit| 4 * four + bit as usize);
            }
            found
        }
    );

    #[test]
    fn four_at_a_time_are_found_as_one_by_one() {
        let mut random = random_of(1, 0, "closeness");
        let mut number = || uniform(&mut random);
        let bodies: Vec<Body> = (0..203)
            .map(|_| {
                let position = Vector3::from_fn(|_, _| 3.0 * number());
                Body::new(position, Vector3::zeros(), 0.2 + 0.3 * number(), 1.0)
            })
            .collect();
        let close = |separation: f64| -> Vec<usize> {
            (0..203).filter(|&k| is_close([&bodies[0], &bodies[k]], separation)).collect()
        };
        assert_eq!(near_the_first(&bodies), close(0.2));
        assert!(close(0.2).len() > 5);
        assert_ne!(close(0.25), close(0.2)); // another separation is seen
    }
}
