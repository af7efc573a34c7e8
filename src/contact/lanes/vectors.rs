//! Vectors of the pairs of a block, stored component by component.

use super::Lanes;
use crate::numbers::{F64x4, four, four_mut};
use nalgebra::Vector3;

/// Overlap of two spheres, and the unit vector from the first to the second. A pair has the same bits in the loop over
/// contacts and in that over separated pairs.
#[inline(always)]
pub(crate) fn overlap_and_normal(
    branch_vector: Vector3<f64>,
    [radius_i, radius_j]: [f64; 2],
) -> (f64, Vector3<f64>) {
    let distance = branch_vector.dot(&branch_vector).sqrt();
    (radius_i + radius_j - distance, branch_vector * (1.0 / distance))
}

/// Stores the vectors of four pairs, from lane `from` on, component by component.
#[inline(always)]
pub(crate) fn store_vectors<Q: F64x4>(components: &mut [Lanes; 3], from: usize, vectors: [Q; 4]) {
    let columns = Q::transposed(vectors);
    for axis in 0..3 {
        columns[axis].store(four_mut(&mut components[axis], from));
    }
}

/// Loads the vectors of four pairs, from lane `from` on.
#[inline(always)]
pub(crate) fn load_vectors<Q: F64x4>(components: &[Lanes; 3], from: usize) -> [Q; 4] {
    let [x, y, z] = components;
    Q::transposed([
        Q::load(four(x, from)),
        Q::load(four(y, from)),
        Q::load(four(z, from)),
        Q::splat(0.0),
    ])
}

/// The vector in one lane.
#[inline(always)]
pub(crate) fn vector(components: &[Lanes; 3], lane: usize) -> Vector3<f64> {
    Vector3::new(components[0][lane], components[1][lane], components[2][lane])
}
