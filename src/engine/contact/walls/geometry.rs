//! A wall at one instant, and its distance and direction from four particles at a time.

use crate::contact::lanes::FourVectors;
use crate::domain::{Wall, WallPose, WallShape};
use crate::numbers::F64x4;
use nalgebra::Vector3;

/// A wall at one instant.
///
/// Operations are those of [`Wall`], in the same order: the results for a particle have the same bits alone and among
/// four.
#[derive(Clone, Copy)]
pub(super) struct WallNow<'a> {
    pub(super) number: usize,
    pub(super) wall: &'a Wall,
    pub(super) pose: &'a WallPose,
}

impl WallNow<'_> {
    /// Distances of four points from the wall, negative behind it.
    #[inline(always)]
    pub(super) fn heights_of_four<Q: F64x4>(&self, positions: FourVectors<Q>) -> Q {
        let displacement = self.pose.displacement;
        match &self.wall.shape {
            WallShape::Plane { point, normal } => {
                let point = FourVectors::of_vector(&(point + displacement));
                FourVectors::of_vector(normal).dot(positions.minus(point))
            }
            WallShape::Cylinder { centre, radius } => {
                let centre = FourVectors::of_vector(&(centre + displacement));
                let FourVectors([x, y, _]) = positions.minus(centre);
                Q::splat(*radius).minus(x.times(x).plus(y.times(y)).root())
            }
            WallShape::Limited(_) => {
                let [height, ..] = one_by_one(positions, |position| {
                    [self.wall.height_at(position, self.pose), 0.0, 0.0, 0.0]
                });
                height
            }
        }
    }

    /// Distances of four points from the wall, and the unit normals into it there; for a mesh, from these facets of it.
    #[inline(always)]
    pub(super) fn heights_and_normals<Q: F64x4>(
        &self,
        positions: FourVectors<Q>,
        facets: [u32; 4],
    ) -> (Q, FourVectors<Q>) {
        match &self.wall.shape {
            WallShape::Plane { .. } | WallShape::Cylinder { .. } => {
                (self.heights_of_four(positions), self.normals_into_wall(positions))
            }
            WallShape::Limited(_) => {
                let mut facets = facets.into_iter();
                let [x, y, z, heights] = one_by_one(positions, |position| {
                    let facet = facets.next().unwrap_or_default();
                    let (height, into_bed) =
                        self.wall.height_and_normal(position, self.pose, facet);
                    row(-into_bed, height)
                });
                (heights, FourVectors([x, y, z]))
            }
        }
    }

    /// Unit normals into the wall at the points of it nearest to four positions; zero on the axis of a cylinder.
    #[inline(always)]
    fn normals_into_wall<Q: F64x4>(&self, positions: FourVectors<Q>) -> FourVectors<Q> {
        match &self.wall.shape {
            WallShape::Plane { normal, .. } => FourVectors::of_vector(&-normal),
            WallShape::Cylinder { .. } | WallShape::Limited(_) => {
                let into_wall = |position: &_| row(-self.wall.normal_at(position, self.pose), 0.0);
                let [x, y, z, _] = one_by_one(positions, into_wall);
                FourVectors([x, y, z])
            }
        }
    }

    /// Angular velocities of the wall less those of four particles.
    #[inline(always)]
    pub(super) fn spins_relative_to<Q: F64x4>(&self, spins: FourVectors<Q>) -> FourVectors<Q> {
        match &self.pose.turn {
            Some(turn) => FourVectors::of_vector(&turn.angular_velocity).minus(spins),
            None => spins.times(Q::splat(-1.0)),
        }
    }

    /// Velocities of the wall at the points of it that are nearest to four positions.
    #[inline(always)]
    pub(super) fn velocities<Q: F64x4>(
        &self,
        positions: FourVectors<Q>,
        heights: Q,
        normals: FourVectors<Q>,
    ) -> FourVectors<Q> {
        if self.pose.turn.is_none() {
            return FourVectors::of_vector(&self.pose.velocity);
        }
        let points = positions.plus(normals.times(heights));
        let [x, y, z, _] = one_by_one(points, |point| row(self.pose.velocity_at(point), 0.0));
        FourVectors([x, y, z])
    }
}

/// A vector and a number.
#[inline(always)]
fn row(vector: Vector3<f64>, last: f64) -> [f64; 4] {
    [vector.x, vector.y, vector.z, last]
}

/// Four numbers of each of four vectors, each number of all four together.
#[inline(always)]
fn one_by_one<Q: F64x4>(
    vectors: FourVectors<Q>,
    mut function: impl FnMut(&Vector3<f64>) -> [f64; 4],
) -> [Q; 4] {
    let (mut numbers, mut results) = ([[0.0; 4]; 4], [Q::splat(0.0); 4]);
    for (numbers, row) in numbers.iter_mut().zip(vectors.rows()) {
        row.store(numbers);
    }
    for (result, &[x, y, z, _]) in results.iter_mut().zip(&numbers) {
        *result = Q::load(&function(&Vector3::new(x, y, z)));
    }
    Q::transposed(results)
}
