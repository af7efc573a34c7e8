//! Which bodies are near each other, four pairs at a time.

use super::Body;
use crate::numbers::F64x4;

/// From one body to another, and the sum of their radii.
#[inline(always)]
pub(super) fn branch<Q: F64x4>(one: &Body, other: &Body) -> Q {
    let but_the_last = Q::load(&[1.0, 1.0, 1.0, -1.0]);
    Q::load(&other.vectors()[0]).minus(Q::load(&one.vectors()[0]).times(but_the_last))
}

/// Bit k says whether branch k is one of bodies whose surfaces are closer than `margin`.
#[inline(always)]
pub(super) fn near_branches<Q: F64x4>(branches: [Q; 4], margin: Q) -> u32 {
    let [x, y, z, radii] = Q::transposed(branches);
    let reach = radii.plus(margin);
    let squared = x.times(x).plus(y.times(y)).plus(z.times(z));
    squared.below(reach.times(reach))
}

/// Bit k says whether the surface of partner k, of one to four, is closer than `margin` to that of the body.
#[inline(always)]
pub(super) fn near_partners<Q: F64x4>(
    body: &Body,
    partners: &[u32],
    bodies: &[Body],
    margin: Q,
) -> u32 {
    let mut branches = [Q::splat(0.0); 4];
    for (place, to_partner) in branches.iter_mut().enumerate() {
        // The last one again where there are fewer: loops of a length that is known stay in registers.
        let partner = partners[place.min(partners.len() - 1)];
        *to_partner = branch(body, &bodies[partner as usize]);
    }
    near_branches(branches, margin) & ((1 << partners.len()) - 1)
}

/// Whether the surfaces of two bodies are closer than `margin`.
#[inline(always)]
pub(super) fn is_near([one, other]: [&Body; 2], margin: f64) -> bool {
    let reach = one.radius + other.radius + margin;
    (other.position - one.position).norm_squared() < reach * reach
}

/// The places of the bits that are set, lowest first.
pub(super) struct Places(pub(super) u32);

impl Iterator for Places {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let place = self.0.trailing_zeros() as usize;
        (self.0 != 0).then(|| {
            self.0 &= self.0 - 1;
            place
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
                let near = near_partners(&self.0[0], partners, self.0, Q::splat(0.2));
                found.extend(Places(near).map(|place| 4 * four + place));
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
        let near = |margin: f64| -> Vec<usize> {
            (0..203).filter(|&k| is_near([&bodies[0], &bodies[k]], margin)).collect()
        };
        assert_eq!(with_simd(Search(&bodies)), near(0.2));
        assert!(near(0.2).len() > 5);
        assert_ne!(near(0.25), near(0.2)); // another margin is seen
    }
}
