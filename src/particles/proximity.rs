//! Which particles are near each other, four pairs at a time.

use super::Body;
use crate::numbers::F64x4;

/// The branch vector, from the centre of one body to that of another, and the sum of their radii.
#[inline(always)]
pub(super) fn branch_vector<Q: F64x4>(one: &Body, other: &Body) -> Q {
    let but_the_last = Q::load(&[1.0, 1.0, 1.0, -1.0]);
    Q::load(&other.vectors()[0]).minus(Q::load(&one.vectors()[0]).times(but_the_last))
}

/// Bit k is set if the surfaces of pair k, of this branch vector, are closer than `separation`.
#[inline(always)]
pub(super) fn close_pairs<Q: F64x4>(branch_vectors: [Q; 4], separation: Q) -> u32 {
    let [x, y, z, radii] = Q::transposed(branch_vectors);
    let distance = radii.plus(separation);
    let squared = x.times(x).plus(y.times(y)).plus(z.times(z));
    squared.below(distance.times(distance))
}

/// One to four items as four: the last one is repeated if there are fewer, since loops of a known length stay in registers.
#[inline(always)]
pub(super) fn four_of<T>(items: &[T]) -> [&T; 4] {
    match items.first_chunk::<4>() {
        Some(four) => four.each_ref(),
        None => std::array::from_fn(|k| &items[k.min(items.len() - 1)]),
    }
}

/// Bit k is set if the surface of partner k, of one to four, is closer than `separation` to that of the body.
#[inline(always)]
pub(super) fn close_partners<Q: F64x4>(
    body: &Body,
    partners: &[u32],
    bodies: &[Body],
    separation: Q,
) -> u32 {
    let mut branch_vectors = [Q::splat(0.0); 4];
    for (to_partner, &partner) in branch_vectors.iter_mut().zip(four_of(partners)) {
        *to_partner = branch_vector(body, &bodies[partner as usize]);
    }
    close_pairs(branch_vectors, separation) & ((1 << partners.len()) - 1)
}

/// The same of one to four other bodies.
#[inline(always)]
pub(super) fn close_bodies<Q: F64x4>(body: &Body, others: &[Body], separation: Q) -> u32 {
    let mut branch_vectors = [Q::splat(0.0); 4];
    for (to_other, other) in branch_vectors.iter_mut().zip(four_of(others)) {
        *to_other = branch_vector(body, other);
    }
    close_pairs(branch_vectors, separation) & ((1 << others.len()) - 1)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::{SimdKernel, random_of, uniform, with_simd};
    use nalgebra::Vector3;

    struct Search<'a>(&'a [Body]);

    impl SimdKernel for Search<'_> {
        type Output = Vec<usize>;

        #[inline(always)]
        fn run<Q: F64x4>(self) -> Vec<usize> {
            let mut found = Vec::new();
            let all: Vec<u32> = (0..self.0.len() as u32).collect();
            for (four, partners) in all.chunks(4).enumerate() {
                let close = close_partners(&self.0[0], partners, self.0, Q::splat(0.2));
                let bodies = &self.0[4 * four..][..partners.len()];
                assert_eq!(close_bodies(&self.0[0], bodies, Q::splat(0.2)), close);
                found.extend(SetBits(close).map(|bit| 4 * four + bit));
            }
            found
        }
    }

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
        assert_eq!(with_simd(Search(&bodies)), close(0.2));
        assert!(close(0.2).len() > 5);
        assert_ne!(close(0.25), close(0.2)); // another separation is seen
    }
}
