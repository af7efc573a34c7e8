//! How far particles have moved since a list of pairs was made.

use super::Body;
use crate::numbers::{Quad, QuadWork, in_quads};

/// Where bodies were, with their radii.
pub(super) type Reference = Vec<[f64; 4]>;

/// Where the bodies are.
pub(super) fn take_reference(reference: &mut Reference, bodies: &[Body]) {
    reference.clear();
    reference.extend(bodies.iter().map(|body| body.quads()[0]));
}

/// A bound of the squares of all displacements: the sum over axes of the largest square. Infinite if any is
/// undefined.
pub(super) fn largest_move_squared(bodies: &[Body], reference: &Reference) -> f64 {
    in_quads(LargestMove { bodies, reference })
}

struct LargestMove<'a> {
    bodies: &'a [Body],
    reference: &'a Reference,
}

impl QuadWork for LargestMove<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<Q: Quad>(self) -> f64 {
        let zero = Q::splat(0.0);
        let (mut largest, mut undefined) = (zero, zero);
        for (body, then) in self.bodies.iter().zip(self.reference) {
            let moved = Q::load(&body.quads()[0]).minus(Q::load(then));
            largest = largest.larger(moved.times(moved));
            undefined = undefined.plus(moved.times(zero)); // zero times an undefined number is undefined
        }
        let (mut squares, mut flags) = ([0.0; 4], [0.0; 4]);
        largest.store(&mut squares);
        undefined.store(&mut flags);
        let defined = flags == [0.0; 4];
        if defined { squares[0] + squares[1] + squares[2] } else { f64::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    #[test]
    fn the_bound_holds_and_sees_what_is_undefined() {
        let body = |x, y| Body::new(Vector3::new(x, y, 0.0), Vector3::zeros(), 0.5, 1.0);
        let mut bodies = [body(1.0, 2.0), body(3.0, 4.0), body(5.0, 6.0)];
        let mut reference = Reference::new();
        take_reference(&mut reference, &bodies);
        assert_eq!(largest_move_squared(&bodies, &reference), 0.0);
        bodies[0].position.x += 0.5;
        bodies[2].position.y -= 2.0;
        assert_eq!(largest_move_squared(&bodies, &reference), 0.25 + 4.0);
        bodies[1].position.z = f64::NAN;
        assert_eq!(largest_move_squared(&bodies, &reference), f64::INFINITY);
    }
}
