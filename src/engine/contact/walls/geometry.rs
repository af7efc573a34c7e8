//! A wall at one instant, and its distance and direction from four particles at a time.

use crate::contact::lanes::FourVectors;
use crate::domain::{Wall, WallPose, WallShape};
use crate::numbers::F64x4;

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
        }
    }

    /// Unit normals into the wall at the points of it nearest to four positions; zero on the axis of a cylinder.
    #[inline(always)]
    pub(super) fn normals_into_wall<Q: F64x4>(&self, positions: FourVectors<Q>) -> FourVectors<Q> {
        match &self.wall.shape {
            WallShape::Plane { normal, .. } => FourVectors::of_vector(&-normal),
            WallShape::Cylinder { .. } => self.normals_one_by_one(positions),
        }
    }

    #[inline(always)]
    fn normals_one_by_one<Q: F64x4>(&self, positions: FourVectors<Q>) -> FourVectors<Q> {
        let (mut numbers, mut normals) = ([[0.0; 4]; 4], [Q::splat(0.0); 4]);
        for (numbers, row) in numbers.iter_mut().zip(positions.rows()) {
            row.store(numbers);
        }
        for (normal, &[x, y, z, _]) in normals.iter_mut().zip(&numbers) {
            let into_bed = self.wall.normal_at(&[x, y, z].into(), self.pose);
            *normal = Q::load(&[-into_bed.x, -into_bed.y, -into_bed.z, 0.0]);
        }
        FourVectors::of_rows(normals)
    }
}
