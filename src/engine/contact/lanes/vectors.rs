//! Vectors of pairs: those of a block, stored component by component, and those of four pairs in registers.

use crate::numbers::{F64x4, Quantum, four, four_mut};
use crate::particles::Lanes;
use nalgebra::Vector3;

/// The vectors of four pairs, component by component.
///
/// Operations are those of [`Vector3`], in the same order: the results for a pair have the same bits as in a loop over
/// lanes.
#[derive(Clone, Copy)]
pub(crate) struct FourVectors<Q>(pub(crate) [Q; 3]);

impl<Q: F64x4> FourVectors<Q> {
    /// Vectors that consist of the first three numbers of each row.
    #[inline(always)]
    pub(crate) fn of_rows(rows: [Q; 4]) -> Self {
        let [x, y, z, _] = Q::transposed(rows);
        Self([x, y, z])
    }

    /// One vector in all four lanes.
    #[inline(always)]
    pub(crate) fn of_vector(vector: &Vector3<f64>) -> Self {
        Self([Q::splat(vector.x), Q::splat(vector.y), Q::splat(vector.z)])
    }

    /// A row for each vector; its fourth number is zero.
    #[inline(always)]
    pub(crate) fn rows(self) -> [Q; 4] {
        let Self([x, y, z]) = self;
        Q::transposed([x, y, z, Q::splat(0.0)])
    }

    /// Loads the vectors of four pairs, from lane `from` on.
    #[inline(always)]
    pub(crate) fn load([x, y, z]: &[Lanes; 3], from: usize) -> Self {
        Self([Q::load(four(x, from)), Q::load(four(y, from)), Q::load(four(z, from))])
    }

    /// Stores the vectors of four pairs, from lane `from` on.
    #[inline(always)]
    pub(crate) fn store(self, components: &mut [Lanes; 3], from: usize) {
        for (lanes, component) in components.iter_mut().zip(self.0) {
            component.store(four_mut(lanes, from));
        }
    }

    #[inline(always)]
    pub(crate) fn plus(self, other: Self) -> Self {
        let (Self([x, y, z]), Self([u, v, w])) = (self, other);
        Self([x.plus(u), y.plus(v), z.plus(w)])
    }

    #[inline(always)]
    pub(crate) fn minus(self, other: Self) -> Self {
        let (Self([x, y, z]), Self([u, v, w])) = (self, other);
        Self([x.minus(u), y.minus(v), z.minus(w)])
    }

    #[inline(always)]
    pub(crate) fn times(self, factor: Q) -> Self {
        let Self([x, y, z]) = self;
        Self([x.times(factor), y.times(factor), z.times(factor)])
    }

    #[inline(always)]
    pub(crate) fn dot(self, other: Self) -> Q {
        let (Self([x, y, z]), Self([u, v, w])) = (self, other);
        x.times(u).plus(y.times(v)).plus(z.times(w))
    }

    #[inline(always)]
    pub(crate) fn cross(self, other: Self) -> Self {
        let (Self([x, y, z]), Self([u, v, w])) = (self, other);
        Self([
            y.times(w).minus(z.times(v)),
            z.times(u).minus(x.times(w)),
            x.times(v).minus(y.times(u)),
        ])
    }

    /// Rounds each component to a multiple of a quantum.
    #[inline(always)]
    pub(crate) fn rounded(self, quantum: Quantum) -> Self {
        let Self([x, y, z]) = self;
        Self([quantum.round_four(x), quantum.round_four(y), quantum.round_four(z)])
    }

    /// The first vector with a component whose magnitude exceeds a limit or is undefined, and its number.
    #[inline(always)]
    pub(crate) fn first_beyond(self, limit: f64) -> Option<(usize, Vector3<f64>)> {
        let (Self([x, y, z]), limit) = (self, Q::splat(limit));
        let (x, y, z) = (x.magnitude(), y.magnitude(), z.magnitude());
        let within = x.at_most(limit) & y.at_most(limit) & z.at_most(limit);
        if within == 0b1111 {
            return None;
        }
        let (mut components, row) = ([[0.0; 4]; 3], within.trailing_ones() as usize);
        for (numbers, component) in components.iter_mut().zip(self.0) {
            component.store(numbers);
        }
        Some((row, Vector3::from(components.map(|component| component[row]))))
    }
}

/// Overlap of two spheres, and the unit vector from the first to the second.
pub(crate) fn overlap_and_normal(
    branch_vector: Vector3<f64>,
    [radius_i, radius_j]: [f64; 2],
) -> (f64, Vector3<f64>) {
    let distance = branch_vector.dot(&branch_vector).sqrt();
    (radius_i + radius_j - distance, branch_vector * (1.0 / distance))
}

/// Overlaps and unit vectors of four pairs, with the same bits as those of [`overlap_and_normal`].
#[inline(always)]
pub(crate) fn overlaps_and_normals<Q: F64x4>(
    branch_vector: FourVectors<Q>,
    [radius_i, radius_j]: [Q; 2],
) -> (Q, FourVectors<Q>) {
    let distance = branch_vector.dot(branch_vector).root();
    let normal = branch_vector.times(Q::splat(1.0).over(distance));
    (radius_i.plus(radius_j).minus(distance), normal)
}

/// The vector in one lane.
#[inline(always)]
pub(crate) fn vector(components: &[Lanes; 3], lane: usize) -> Vector3<f64> {
    Vector3::new(components[0][lane], components[1][lane], components[2][lane])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::vectorised;
    use proptest::prelude::*;

    vectorised!(
        /// Overlaps and normals of four pairs, and results of operations on their normals and other vectors.
        fn of_four_pairs<Q: F64x4>(
            branch_vectors: [[f64; 4]; 4],
            others: [[f64; 4]; 4],
            radii: [[f64; 4]; 2],
        ) -> ([f64; 4], [[[f64; 4]; 4]; 2]) {
            let [a, b, c, d] = &branch_vectors;
            let branch_vector =
                FourVectors::of_rows([Q::load(a), Q::load(b), Q::load(c), Q::load(d)]);
            let [a, b, c, d] = &others;
            let other = FourVectors::of_rows([Q::load(a), Q::load(b), Q::load(c), Q::load(d)]);
            let radii = [Q::load(&radii[0]), Q::load(&radii[1])];
            let (overlap, normal) = overlaps_and_normals(branch_vector, radii);
            let combined = other.minus(other.cross(normal)).plus(normal.times(other.dot(normal)));
            let (mut overlaps, mut vectors) = ([0.0; 4], [[[0.0; 4]; 4]; 2]);
            overlap.store(&mut overlaps);
            for (rows, of_four) in vectors.iter_mut().zip([normal.rows(), combined.rows()]) {
                for (numbers, row) in rows.iter_mut().zip(of_four) {
                    row.store(numbers);
                }
            }
            (overlaps, vectors)
        }
    );

    proptest! {
        #[test]
        fn four_pairs_have_the_bits_of_each(
            branch_vectors: [[f64; 4]; 4],
            others: [[f64; 4]; 4],
            radii: [[f64; 4]; 2],
        ) {
            let (overlaps, [normals, combined]) = of_four_pairs(branch_vectors, others, radii);
            for row in 0..4 {
                let [branch_vector, other] = [branch_vectors[row], others[row]]
                    .map(|[x, y, z, _]| Vector3::new(x, y, z));
                let radii = [radii[0][row], radii[1][row]];
                let (overlap, normal) = overlap_and_normal(branch_vector, radii);
                let expected = other - other.cross(&normal) + normal * other.dot(&normal);
                same_bits([overlap], [overlaps[row]])?;
                let [x, y, z, zero] = normals[row];
                same_bits([normal.x, normal.y, normal.z, 0.0], [x, y, z, zero])?;
                let [x, y, z, _] = combined[row];
                same_bits([expected.x, expected.y, expected.z], [x, y, z])?;
            }
        }
    }

    /// Compares bits; undefined numbers may have any.
    fn same_bits<const N: usize>(ones: [f64; N], others: [f64; N]) -> Result<(), TestCaseError> {
        let bits = |number: f64| if number.is_nan() { 0 } else { number.to_bits() };
        prop_assert_eq!(ones.map(bits), others.map(bits));
        Ok(())
    }

    vectorised!(
        fn beyond_two<Q: F64x4>(vectors: [[f64; 4]; 3]) -> Option<(usize, Vector3<f64>)> {
            let [x, y, z] = &vectors;
            FourVectors([Q::load(x), Q::load(y), Q::load(z)]).first_beyond(2.0)
        }
    );

    #[test]
    fn the_first_vector_beyond_a_limit_is_found() {
        let (x, y, z) = ([1.0, 2.0, 0.0, 3.0], [-2.0, 1.0, -2.5, 0.0], [0.0, -1.0, 1.0, 0.0]);
        assert_eq!(beyond_two([x, y, z]), Some((2, Vector3::new(0.0, -2.5, 1.0))));
        assert_eq!(beyond_two([[2.0; 4], [-2.0; 4], [0.0; 4]]), None);
        let undefined = [0.0, 0.0, 0.0, f64::NAN];
        assert_eq!(beyond_two([[0.0; 4], [0.0; 4], undefined]).map(|found| found.0), Some(3));
    }
}
